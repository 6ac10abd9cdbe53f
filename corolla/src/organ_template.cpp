#include "anthesis/corolla/organ_template.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"
#include "anthesis/base/random.h"
#include "anthesis/corolla/polygonization.h"
#include "anthesis/corolla/pose.h"
#include "anthesis/geometry/bspline.h"
#include "anthesis/geometry/function_graph.h"

namespace anthesis {
namespace {

constexpr std::uint64_t kMaxKindsOfHairs = 1024;  // of one organ: keeps the keys of variants apart

/// One copy of a petal: first mirrored in y = 0, then turned about the axis.
struct Copy {
  double azimuth_rad = 0.0;
  bool mirrored = false;
  std::uint32_t first_vertex = 0;
};

/// A set of petals: its poses and where its vertices are.
struct PetalSurface {
  std::vector<PoseBlend> poses;  ///< of plain copies; then, if there are any, of mirrored ones before they are mirrored
  int ring = 1;                  ///< petals around the axis, for fused margins
  int fused = 0;
  int fused_with = -1;  ///< index of an earlier surface, or -1
  int degree_across = 3;
  int degree_along = 3;
  std::vector<Vec2> uvs;          ///< of one copy
  std::vector<BasisFunctions> u;  ///< by vertex of one copy
  std::vector<BasisFunctions> v;
  std::vector<Copy> copies;
};

struct ColumnSurface {
  std::vector<double> stages;
  std::vector<std::vector<Vec2>> profiles_mm;
  std::vector<double> leans_rad;
  double ring_radius_mm = 0.0;
  double base_mm = 0.0;
  std::vector<BasisFunctions> basis;              ///< by ring of vertices
  std::vector<std::vector<math::SinCos>> around;  ///< by ring, by vertex in it
  std::vector<Copy> copies;
};

Vec3 turn(Vec3 p, math::SinCos azimuth) {
  return {azimuth.cos * p.x - azimuth.sin * p.y, azimuth.sin * p.x + azimuth.cos * p.y, p.z};
}

/// The set of petals that says where the rows of vertices are: margins meet vertex by vertex only on the same rows.
const Petals& rows_of(const Petals& set, const OrganShape& shape) {
  const auto other = std::find_if(shape.petals.begin(), shape.petals.end(),
                                  [&](const Petals& petals) { return petals.name == set.fused_with; });
  return set.fused_with.empty() || other == shape.petals.end() ? set : *other;
}

/// The rings of vertices of a column.
struct Rings {
  int sides = 3;
  int count = 2;
};

Rings rings_of(const Column& column, double detail) {
  return {std::max(3, static_cast<int>(std::lround(column.sides * detail))),
          std::max(2, 1 + static_cast<int>(std::lround((column.rings - 1) * detail)))};
}

ShapeDeviation draw(const ShapeVariation& variation, std::uint64_t seed, std::uint32_t variant) {
  if (variant == 0) {
    return {};
  }
  const auto within = [&](const Range& range, RandomPurpose purpose) {
    return Rng(seed, variant, purpose).uniform(range[0], range[1]);
  };
  ShapeDeviation deviation;
  deviation.curl_rad = math::radians(within(variation.curl_deg, RandomPurpose::kCurl));
  deviation.twist_rad = math::radians(within(variation.twist_deg, RandomPurpose::kTwist));
  deviation.sway_rad = math::radians(within(variation.sway_deg, RandomPurpose::kYaw));
  deviation.width = within(variation.width, RandomPurpose::kWidth);
  return deviation;
}

}  // namespace

struct OrganTemplate::State {
  std::vector<Triangle> triangles;
  std::vector<Vec2> uvs;
  std::vector<std::uint32_t> twins;
  std::vector<TemplateGroup> groups;
  std::vector<PetalSurface> petals;
  std::vector<ColumnSurface> columns;
  HairCoat hairs;

  void add(const Petals& petals, const OrganShape& shape, double detail, const ShapeDeviation& deviation);
  void add(const Column& column, double detail);
  void begin_group(const std::string& name, const std::string& pigment);
  void end_group();
  std::uint32_t append(const FlatMesh& flat, bool mirrored);
  void join(std::uint32_t a, std::uint32_t b);
  ControlMesh controls(std::size_t surface, double stage, bool mirrored,
                       std::vector<std::optional<ControlMesh>>& known) const;
};

std::span<const Triangle> OrganTemplate::triangles() const {
  return state_->triangles;
}
std::span<const Vec2> OrganTemplate::uvs() const {
  return state_->uvs;
}
std::span<const TemplateGroup> OrganTemplate::groups() const {
  return state_->groups;
}
std::size_t OrganTemplate::vertex_count() const {
  return state_->uvs.size();
}
std::span<const std::uint32_t> OrganTemplate::twins() const {
  return state_->twins;
}

const HairCoat& OrganTemplate::hairs() const {
  return state_->hairs;
}

std::size_t OrganTemplate::count_vertices(const OrganShape& shape, double detail) {
  std::size_t count = 0;
  for (const Petals& set : shape.petals) {
    const FunctionGraph spacing(rows_of(set, shape).spacing);
    count += anthesis::count_vertices(spacing, FunctionGraph(set.vertices), detail) *
             static_cast<std::size_t>(set.count * (set.mirrored ? 2 : 1));
  }
  for (const Column& column : shape.columns) {
    const Rings rings = rings_of(column, detail);
    count += static_cast<std::size_t>(rings.sides + 1) * rings.count * column.count;
  }
  return count;
}

Expected<OrganTemplate> OrganTemplate::build(const OrganShape& shape, double detail, std::uint64_t seed,
                                             std::uint32_t variant) {
  if (count_vertices(shape, detail) > kMaxVertices) {
    return unexpected(Error{ErrorCode::kTooLarge, "",
                            "must have at most " + std::to_string(kMaxVertices) +
                                " vertices, got more: lower the detail or the numbers of vertices"});
  }
  auto state = std::make_shared<State>();
  const ShapeDeviation deviation = draw(shape.variation, seed, variant);
  for (const Petals& petals : shape.petals) {
    state->add(petals, shape, detail, deviation);
  }
  for (const Column& column : shape.columns) {
    state->add(column, detail);
  }
  // Chains of twins are shortened so that each names the smallest of its place.
  for (std::uint32_t i = 0; i < state->twins.size(); ++i) {
    state->twins[i] = state->twins[state->twins[i]];
  }
  const OrganTemplate organ(state);
  if (!shape.hairs.empty()) {
    std::vector<Vec3> grown_mm(organ.vertex_count());
    std::vector<Vec3> normals(organ.vertex_count());
    organ.pose(1.0, grown_mm, normals);
    double wanted = 0.0;
    for (std::size_t i = 0; i < shape.hairs.size(); ++i) {
      const Hairs& hairs = shape.hairs[i];
      const auto group = std::find_if(state->groups.begin(), state->groups.end(),
                                      [&](const TemplateGroup& g) { return g.name == hairs.on; });
      ANTHESIS_ASSERT(group != state->groups.end());
      wanted += state->hairs.plant(hairs, organ.triangles().subspan(group->first_triangle, group->triangle_count),
                                   organ.uvs(), grown_mm, seed, variant * kMaxKindsOfHairs + i);
    }
    if (wanted > static_cast<double>(HairCoat::kMaxHairs)) {
      return unexpected(Error{ErrorCode::kTooLarge, "",
                              "must have at most " + std::to_string(HairCoat::kMaxHairs) + " hairs, got " +
                                  to_text(wanted) + ": lower their density_per_mm2"});
    }
  }
  return organ;
}

void OrganTemplate::State::begin_group(const std::string& name, const std::string& pigment) {
  TemplateGroup group;
  group.name = name;
  group.pigment = pigment;
  group.first_vertex = static_cast<std::uint32_t>(uvs.size());
  group.first_triangle = static_cast<std::uint32_t>(triangles.size());
  groups.push_back(group);
}

void OrganTemplate::State::end_group() {
  groups.back().vertex_count = static_cast<std::uint32_t>(uvs.size()) - groups.back().first_vertex;
  groups.back().triangle_count = static_cast<std::uint32_t>(triangles.size()) - groups.back().first_triangle;
}

std::uint32_t OrganTemplate::State::append(const FlatMesh& flat, bool mirrored) {
  const auto first = static_cast<std::uint32_t>(uvs.size());
  uvs.insert(uvs.end(), flat.uvs.begin(), flat.uvs.end());
  for (std::uint32_t i = 0; i < flat.uvs.size(); ++i) {
    twins.push_back(first + i);
  }
  for (const Triangle& t : flat.triangles) {
    triangles.push_back(mirrored ? Triangle{first + t[0], first + t[2], first + t[1]}
                                 : Triangle{first + t[0], first + t[1], first + t[2]});
  }
  return first;
}

void OrganTemplate::State::join(std::uint32_t a, std::uint32_t b) {
  // Union by the smaller index; the sets are tiny.
  while (twins[a] != a) {
    a = twins[a];
  }
  while (twins[b] != b) {
    b = twins[b];
  }
  twins[std::max(a, b)] = std::min(a, b);
}

void OrganTemplate::State::add(const Petals& set, const OrganShape& shape, double detail,
                               const ShapeDeviation& deviation) {
  const auto poses_with = [&](const ShapeDeviation& own) {
    std::vector<double> stages;
    std::vector<ControlMesh> meshes;
    for (const PetalPose& pose : set.poses) {
      stages.push_back(pose.stage);
      meshes.push_back(control_mesh(pose, set.degree_across, own));
    }
    return PoseBlend(std::move(stages), std::move(meshes));
  };
  PetalSurface surface;
  surface.poses.push_back(poses_with(deviation));
  if (set.mirrored) {
    // Only the form is mirrored, not what befell the floret: its twist and sway take the other half along.
    ShapeDeviation reflected = deviation;
    reflected.twist_rad = -deviation.twist_rad;
    reflected.sway_rad = -deviation.sway_rad;
    surface.poses.push_back(poses_with(reflected));
  }
  surface.ring = set.count;
  surface.fused = set.fused;
  surface.degree_across = set.degree_across;
  surface.degree_along = set.degree_along;
  if (!set.fused_with.empty()) {
    surface.fused_with = static_cast<int>(&rows_of(set, shape) - shape.petals.data());
  }
  const FlatMesh flat = polygonize(FunctionGraph(rows_of(set, shape).spacing), FunctionGraph(set.vertices), detail);
  surface.uvs = flat.uvs;
  for (const Vec2 uv : flat.uvs) {
    surface.u.push_back(clamped_basis(surface.poses[0].across(), set.degree_across, uv.x));
    surface.v.push_back(clamped_basis(surface.poses[0].along(), set.degree_along, uv.y));
  }
  begin_group(set.name, set.pigment);
  for (int side = 0; side < (set.mirrored ? 2 : 1); ++side) {
    for (int i = 0; i < set.count; ++i) {
      Copy copy;
      const double azimuth = math::radians(set.azimuth_deg);
      copy.mirrored = side == 1;
      copy.azimuth_rad = (copy.mirrored ? -azimuth : azimuth) + math::kTurnRad * i / set.count;
      copy.first_vertex = append(flat, copy.mirrored);
      surface.copies.push_back(copy);
    }
  }
  end_group();

  // Vertices on shared margins are twins: the left margin of one petal, the right margin of the next.
  const double until = fused_until(surface.poses[0].along(), set.degree_along, set.fused);
  const auto margin = [](const std::vector<Vec2>& points, double u) {
    std::map<double, std::uint32_t> by_v;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (points[i].x == u || points[i].x == 0.5) {  // a row of one vertex is both margins at once
        const bool lone = points[i].x == 0.5 && (i == 0 || points[i - 1].y != points[i].y) &&
                          (i + 1 == points.size() || points[i + 1].y != points[i].y);
        if (points[i].x == u || lone) {
          by_v[points[i].y] = i;
        }
      }
    }
    return by_v;
  };
  const auto right = margin(surface.uvs, 1.0);
  if (surface.fused_with >= 0) {
    const PetalSurface& median = petals[surface.fused_with];
    const auto left = margin(median.uvs, 0.0);
    const auto median_right = margin(median.uvs, 1.0);
    for (const auto& [v, index] : right) {
      if (v <= until) {
        for (const Copy& copy : surface.copies) {
          const auto& theirs = copy.mirrored ? median_right : left;
          if (const auto found = theirs.find(v); found != theirs.end()) {
            join(median.copies[0].first_vertex + found->second, copy.first_vertex + index);
          }
        }
      }
    }
  } else if (set.fused > 0 && set.count > 1) {
    const auto left = margin(surface.uvs, 0.0);
    for (std::size_t i = 0; i < surface.copies.size(); ++i) {
      const Copy& here = surface.copies[i];
      const Copy& next = surface.copies[(i + 1) % surface.copies.size()];
      for (const auto& [v, index] : left) {
        if (v <= until) {
          join(here.first_vertex + index, next.first_vertex + right.at(v));
        }
      }
    }
  }
  petals.push_back(std::move(surface));
}

void OrganTemplate::State::add(const Column& column, double detail) {
  ColumnSurface surface;
  surface.ring_radius_mm = column.ring_radius_mm;
  surface.base_mm = column.base_mm;
  bool point_below = true;
  bool point_above = true;
  for (const ColumnPose& pose : column.poses) {
    surface.stages.push_back(pose.stage);
    surface.profiles_mm.push_back(pose.profile_mm);
    surface.leans_rad.push_back(math::radians(pose.lean_deg));
    point_below = point_below && pose.profile_mm.front().x == 0.0;
    point_above = point_above && pose.profile_mm.back().x == 0.0;
  }
  const auto [sides, rings] = rings_of(column, detail);
  FlatMesh flat;
  std::vector<std::uint32_t> first_of_ring;
  for (int j = 0; j < rings; ++j) {
    const double v = static_cast<double>(j) / (rings - 1);
    const bool lone = (j == 0 && point_below) || (j + 1 == rings && point_above);
    first_of_ring.push_back(static_cast<std::uint32_t>(flat.uvs.size()));
    surface.basis.push_back(clamped_basis(static_cast<int>(surface.profiles_mm[0].size()), column.degree, v));
    std::vector<math::SinCos>& around = surface.around.emplace_back();
    for (int i = 0; i <= (lone ? 0 : sides); ++i) {
      flat.uvs.push_back({lone ? 0.5 : static_cast<double>(i) / sides, v});
      around.push_back(math::sin_cos(math::kTurnRad * (i % sides) / sides));
    }
  }
  for (int j = 0; j + 1 < rings; ++j) {
    const std::uint32_t below = first_of_ring[j];
    const std::uint32_t above = first_of_ring[j + 1];
    const bool lone_below = surface.around[j].size() == 1;
    const bool lone_above = surface.around[j + 1].size() == 1;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i) {
      if (!lone_below) {
        flat.triangles.push_back({below + i, below + i + 1, above + (lone_above ? 0 : i + 1)});
      }
      if (!lone_above) {
        flat.triangles.push_back({below + (lone_below ? 0 : i), above + i + 1, above + i});
      }
    }
  }
  begin_group(column.name, column.pigment);
  for (int k = 0; k < column.count; ++k) {
    Copy copy;
    copy.azimuth_rad = math::radians(column.azimuth_deg) + math::kTurnRad * k / column.count;
    copy.first_vertex = append(flat, false);
    for (int j = 0; j < rings; ++j) {
      if (surface.around[j].size() > 1) {
        join(copy.first_vertex + first_of_ring[j], copy.first_vertex + first_of_ring[j] + sides);
      }
    }
    surface.copies.push_back(copy);
  }
  end_group();
  columns.push_back(std::move(surface));
}

/// The control mesh of a set at a stage with its fused margins in place; `known` holds those of earlier sets.
ControlMesh OrganTemplate::State::controls(std::size_t index, double stage, bool mirrored,
                                           std::vector<std::optional<ControlMesh>>& known) const {
  const PetalSurface& surface = petals[index];
  ControlMesh mesh = surface.poses[mirrored ? 1 : 0].at(stage);
  if (surface.fused_with >= 0) {
    const ControlMesh& median = *known[surface.fused_with];
    share_margin(mesh, mirrored ? reflected(median) : median, surface.fused);
  } else if (surface.fused > 0 && surface.ring > 1) {
    hold_in_symmetry_planes(mesh, surface.ring, surface.fused);
  }
  if (!mirrored) {
    known[index] = mesh;
  }
  return mesh;
}

void OrganTemplate::pose(double stage, std::span<Vec3> positions_mm, std::span<Vec3> normals) const {
  const State& state = *state_;
  ANTHESIS_ASSERT(positions_mm.size() == vertex_count() && normals.size() == vertex_count());
  std::vector<std::optional<ControlMesh>> known(state.petals.size());
  std::vector<Vec3> one;
  for (std::size_t index = 0; index < state.petals.size(); ++index) {
    const PetalSurface& surface = state.petals[index];
    one.resize(surface.uvs.size());
    const Copy* before = nullptr;
    for (const Copy& copy : surface.copies) {
      if (before == nullptr || before->mirrored != copy.mirrored) {
        const ControlMesh mesh = state.controls(index, stage, copy.mirrored, known);
        for (std::size_t i = 0; i < one.size(); ++i) {
          one[i] = surface_at(std::span<const Vec3>(mesh.points_mm), surface.u[i], surface.v[i], mesh.across);
        }
      }
      before = &copy;
      const math::SinCos azimuth = math::sin_cos(copy.azimuth_rad);
      for (std::size_t i = 0; i < one.size(); ++i) {
        const Vec3 p = copy.mirrored ? Vec3{one[i].x, -one[i].y, one[i].z} : one[i];
        positions_mm[copy.first_vertex + i] = copy.azimuth_rad == 0.0 ? p : turn(p, azimuth);
      }
    }
  }
  for (const ColumnSurface& surface : state.columns) {
    const auto later = std::upper_bound(surface.stages.begin(), surface.stages.end(), stage);
    const std::size_t after =
        std::min(static_cast<std::size_t>(later - surface.stages.begin()), surface.stages.size() - 1);
    const std::size_t before =
        later == surface.stages.begin() ? 0 : static_cast<std::size_t>(later - surface.stages.begin()) - 1;
    const double gap = surface.stages[after] - surface.stages[before];
    const double share = gap > 0.0 ? (stage - surface.stages[before]) / gap : 0.0;
    const auto [lean_sine, lean_cosine] =
        math::sin_cos(lerp(surface.leans_rad[before], surface.leans_rad[after], share));
    one.clear();
    for (std::size_t j = 0; j < surface.basis.size(); ++j) {
      const BasisFunctions& basis = surface.basis[j];
      Vec2 point{};
      for (int k = 0; k < basis.count; ++k) {
        point += basis.weight[k] *
                 lerp(surface.profiles_mm[before][basis.first + k], surface.profiles_mm[after][basis.first + k], share);
      }
      for (const math::SinCos& around : surface.around[j]) {
        const Vec3 upright{point.x * around.cos, point.x * around.sin, point.y};
        one.push_back({surface.ring_radius_mm + lean_cosine * upright.x + lean_sine * upright.z, upright.y,
                       surface.base_mm + lean_cosine * upright.z - lean_sine * upright.x});
      }
    }
    for (const Copy& copy : surface.copies) {
      const math::SinCos azimuth = math::sin_cos(copy.azimuth_rad);
      for (std::size_t i = 0; i < one.size(); ++i) {
        positions_mm[copy.first_vertex + i] = turn(one[i], azimuth);
      }
    }
  }
  for (std::size_t i = 0; i < positions_mm.size(); ++i) {
    positions_mm[i] = positions_mm[state.twins[i]];  // shared margins agree to the last bit
  }
  smooth_normals(positions_mm, state.triangles, state.twins, normals);
}

}  // namespace anthesis
