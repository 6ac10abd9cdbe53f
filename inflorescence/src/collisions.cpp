#include "anthesis/inflorescence/collisions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/sha256.h"
#include "anthesis/base/version.h"
#include "checkpoint.h"

namespace anthesis {
namespace {

constexpr double kLattice_mm = 1.0 / 16384.0;  // 2^-14: single precision holds its multiples up to 1 m
constexpr double kMaxExtent_mm = 1024.0;
constexpr double kBodyThickness_mm = 0.04;
// Shares of its distance from the axis that a flat facet of the receptacle may cut off, and one of the sixteen-sided
// receptacles that organs carry.
constexpr double kSaggingShare = 0.003;
constexpr double kColumnSaggingShare = 0.02;

/// A template's vertices, each place once.
struct WeldedTemplate {
  std::vector<std::uint32_t> welded;    ///< by vertex of the template
  std::vector<std::uint32_t> original;  ///< by welded vertex: one vertex of the template
};

/// A body's sheet follows from its places: vertices at one place are one.
WeldedTemplate weld_places(std::span<const Vec3> places) {
  std::map<std::array<double, 3>, std::uint32_t> seen;
  WeldedTemplate weld;
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const auto [entry, fresh] =
        seen.insert({{places[i].x, places[i].y, places[i].z}, static_cast<std::uint32_t>(weld.original.size())});
    if (fresh) {
      weld.original.push_back(i);
    }
    weld.welded.push_back(entry->second);
  }
  return weld;
}

WeldedTemplate weld_twins(const OrganTemplate& shape) {
  WeldedTemplate weld;
  weld.welded.resize(shape.vertex_count());
  for (std::uint32_t i = 0; i < shape.vertex_count(); ++i) {
    if (shape.twins()[i] == i) {
      weld.welded[i] = static_cast<std::uint32_t>(weld.original.size());
      weld.original.push_back(i);
    } else {
      weld.welded[i] = weld.welded[shape.twins()[i]];
    }
  }
  return weld;
}

std::vector<Triangle> weld_triangles(std::span<const Triangle> triangles, const WeldedTemplate& weld) {
  std::vector<Triangle> result;
  for (const Triangle& t : triangles) {
    const Triangle w{weld.welded[t[0]], weld.welded[t[1]], weld.welded[t[2]]};
    if (w[0] != w[1] && w[1] != w[2] && w[2] != w[0]) {
      result.push_back(w);
    }
  }
  return result;
}

/// Vertices of the two rows nearest the base of each part: they hold its place and its direction.
void attach(Sheet& sheet, const OrganTemplate& shape, const WeldedTemplate& weld, const Tissue& tissue) {
  std::vector<double> hold(sheet.vertex_count, 0.0);
  for (const TemplateGroup& group : shape.groups()) {
    std::vector<double> rows;
    const auto uvs = shape.uvs().subspan(group.first_vertex, group.vertex_count);
    for (const Vec2 uv : uvs) {
      rows.push_back(uv.y);
    }
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (std::size_t i = 0; i < uvs.size(); ++i) {
      if (uvs[i].y <= rows[std::min<std::size_t>(1, rows.size() - 1)]) {
        hold[weld.welded[group.first_vertex + i]] = tissue.hold;
      }
    }
  }
  for (std::uint32_t i = 0; i < hold.size(); ++i) {
    if (hold[i] > 0.0) {
      sheet.attached.push_back(i);
      sheet.attachment_stiffness.push_back(hold[i]);
    }
  }
}

/// A midrib resists bending, the blade across it less: the stiffness of a fold goes by its direction in (u, v).
void stiffen(Sheet& sheet, const OrganTemplate& shape, const WeldedTemplate& weld, const Tissue& tissue) {
  sheet.edge_stiffness.assign(sheet.edges.size(), tissue.stretch);
  std::map<std::array<std::uint32_t, 2>, double> across;  ///< share of a fold that runs across the midrib
  for (const Triangle& t : shape.triangles()) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = weld.welded[t[k]];
      const std::uint32_t b = weld.welded[t[(k + 1) % 3]];
      const Vec2 d = shape.uvs()[t[(k + 1) % 3]] - shape.uvs()[t[k]];
      const double sum = dot(d, d);
      across[{std::min(a, b), std::max(a, b)}] = sum > 0.0 ? d.x * d.x / sum : 1.0;
    }
  }
  for (std::size_t h = 0; h < sheet.hinges.size(); ++h) {
    const auto [a, b, c, d] = sheet.hinges[h];
    sheet.hinge_stiffness[h] = lerp(tissue.roll, tissue.bend, across[{std::min(a, b), std::max(a, b)}]);
  }
}

/// A run: the plant, its sheets, and how far it has come.
class Run {
 public:
  Run(const Development& development, const CollisionOptions& options);

  std::optional<Error> follow(std::span<const double> times, const Progress& progress, AccommodatedDevelopment& result);

 private:
  Canopy targets_at(double time, std::vector<Vec3>& targets_mm) const;
  std::optional<Error> step_to(double time, const Progress& progress, CollisionReport& report);
  Expected<Canopy> show(double time, std::span<const Vec3> positions_mm) const;
  std::string key(std::span<const double> times) const;
  std::string name_of(std::size_t body) const;
  double clearance_below(const Canopy& canopy, const Organ& organ) const;

  const Development& development_;
  const CollisionOptions& options_;
  std::vector<WeldedTemplate> welds_;
  WeldedTemplate body_weld_;  ///< of all bodies' vertices, one after the other
  bool has_bodies_ = false;   ///< body 0 of the sheets is the receptacle with the peduncle
  std::unique_ptr<GrowingSheets> sheets_;
};

std::vector<Vec3> places_of(const std::vector<Body>& bodies) {
  std::vector<Vec3> places;
  for (const Body& body : bodies) {
    places.insert(places.end(), body.mesh.positions_mm.begin(), body.mesh.positions_mm.end());
  }
  return places;
}

Run::Run(const Development& development, const CollisionOptions& options)
    : development_(development), options_(options) {
  std::vector<Sheet> sheets;
  std::vector<std::uint32_t> kind_of(development.templates().size(), 0);
  for (const Organ& organ : development.organs()) {
    kind_of[organ.template_index] = organ.kind;
  }
  std::vector<Vec3> normals;
  for (std::size_t i = 0; i < development.templates().size(); ++i) {
    const OrganTemplate& shape = development.templates()[i];
    const Tissue& tissue = development.species().organs[kind_of[i]].tissue;
    welds_.push_back(weld_twins(shape));
    Sheet sheet = make_sheet(welds_[i].original.size(), weld_triangles(shape.triangles(), welds_[i]));
    stiffen(sheet, shape, welds_[i], tissue);
    attach(sheet, shape, welds_[i], tissue);
    std::vector<Vec3> places(shape.vertex_count());
    normals.resize(shape.vertex_count());
    shape.pose(1.0, places, normals);
    for (const std::uint32_t original : welds_[i].original) {
      sheet.shape_mm.push_back(places[original]);
    }
    sheets.push_back(std::move(sheet));
  }
  const std::vector<Body> bodies = development.at(1.0).bodies;
  has_bodies_ = !bodies.empty();
  if (has_bodies_) {
    const std::vector<Vec3> places = places_of(bodies);
    body_weld_ = weld_places(places);
    std::vector<Triangle> triangles;
    std::uint32_t first = 0;
    for (const Body& body : bodies) {
      for (const Triangle& t : body.mesh.triangles) {
        triangles.push_back({first + t[0], first + t[1], first + t[2]});
      }
      first += static_cast<std::uint32_t>(body.mesh.positions_mm.size());
    }
    Sheet sheet = make_sheet(body_weld_.original.size(), weld_triangles(triangles, body_weld_));
    for (const std::uint32_t original : body_weld_.original) {
      sheet.shape_mm.push_back(places[original]);
    }
    sheets.push_back(std::move(sheet));
  }
  sheets_ = std::make_unique<GrowingSheets>(std::move(sheets), options.growing);
}

std::string Run::name_of(std::size_t body) const {
  if (has_bodies_ && body == 0) {
    return "receptacle";
  }
  return organ_name(development_, development_.organs()[body - (has_bodies_ ? 1 : 0)].id);
}

/// How far an organ must keep from what it stands on: half of that one's thickness with a little more, and how far a
/// polygon's sides lie within its circle. 0 where there is nothing.
double Run::clearance_below(const Canopy& canopy, const Organ& organ) const {
  const OrganState& state = canopy.organs[organ.id.value - 1];
  if (organ.parent.value == 0) {
    return has_bodies_ ? 0.6 * kBodyThickness_mm + kSaggingShare * state.radius_mm : 0.0;
  }
  const OrganState& parent = canopy.organs[organ.parent.value - 1];
  const Organ& carrier = development_.organs()[organ.parent.value - 1];
  if (welds_[carrier.template_index].original.empty()) {
    return 0.0;
  }
  const Tissue& tissue = development_.species().organs[carrier.kind].tissue;
  return 0.6 * tissue.thickness_mm + kColumnSaggingShare * state.radius_mm * parent.world_from_organ.scale;
}

/// The plant without contact, organs set on the receptacle instead of into it; the target of every vertex.
Canopy Run::targets_at(double time, std::vector<Vec3>& targets_mm) const {
  Canopy canopy = development_.at(time);
  targets_mm.clear();
  std::vector<std::size_t> first;
  if (has_bodies_) {
    const std::vector<Vec3> places = places_of(canopy.bodies);
    for (const std::uint32_t original : body_weld_.original) {
      targets_mm.push_back(places[original]);
    }
  }
  for (OrganState& state : canopy.organs) {
    const Organ& organ = development_.organs()[state.id.value - 1];
    const OrganKind& kind = development_.species().organs[organ.kind];
    const double below = clearance_below(canopy, organ);
    if (below > 0.0) {
      const double clearance = below + 0.6 * kind.tissue.thickness_mm;
      state.world_from_organ.position_mm += (state.world_from_organ.scale * kind.sink_mm + clearance) * state.normal;
    }
    first.push_back(targets_mm.size());
    targets_mm.resize(targets_mm.size() + welds_[organ.template_index].original.size());
  }
  parallel_for(canopy.organs.size(), [&](std::size_t i) {
    const OrganState& state = canopy.organs[i];
    const std::uint32_t index = development_.organs()[state.id.value - 1].template_index;
    const OrganTemplate& shape = development_.templates()[index];
    std::vector<Vec3> positions(shape.vertex_count());
    std::vector<Vec3> normals(shape.vertex_count());
    shape.pose(state.stage, positions, normals);
    for (std::size_t k = 0; k < welds_[index].original.size(); ++k) {
      targets_mm[first[i] + k] = apply(state.world_from_organ, positions[welds_[index].original[k]]);
    }
  });
  return canopy;
}

std::optional<Error> Run::step_to(double time, const Progress& progress, CollisionReport& report) {
  std::vector<Vec3> targets;
  const Canopy canopy = targets_at(time, targets);
  std::size_t next = sheets_->positions_mm().size();
  const std::size_t offset = has_bodies_ ? 1 : 0;
  // Everything that finds no place is named, not only the first: so the bodies that did are remembered.
  std::vector<std::size_t> inside(sheets_->body_count());
  std::iota(inside.begin(), inside.end(), std::size_t{0});
  std::string stuck;
  for (std::size_t body = inside.size(); body < canopy.organs.size() + offset; ++body) {
    GrowingBody entering;
    Vec3 attachment{};
    if (body < offset) {
      entering = {static_cast<std::uint32_t>(welds_.size()), kBodyThickness_mm, true};
    } else {
      const OrganState& state = canopy.organs[body - offset];
      const Organ& organ = development_.organs()[state.id.value - 1];
      entering = {organ.template_index, development_.species().organs[organ.kind].tissue.thickness_mm, false};
      attachment = state.world_from_organ.position_mm;
    }
    const std::size_t count = sheets_->sheets()[entering.sheet].vertex_count;
    const GrowingSheets::Entry entry = sheets_->enter(entering, std::span(targets).subspan(next, count), attachment);
    next += count;
    if (entry.scale > 0.0) {
      inside.push_back(body);
      continue;
    }
    stuck += stuck.empty() ? "" : "; ";
    stuck += name_of(body);
    stuck += entry.crosses_itself ? " crosses itself" : " crosses";
    for (const std::uint32_t other : entry.in_place) {
      stuck += ' ';
      stuck += name_of(inside[other]);
    }
  }
  if (!stuck.empty()) {
    return Error{ErrorCode::kCrossing, "collisions",
                 "must find a place to start for each organ, found none at time " + to_text(time) + ": " + stuck};
  }
  for (std::size_t i = 0; i < canopy.organs.size(); ++i) {
    const OrganState& state = canopy.organs[i];
    const Organ& organ = development_.organs()[state.id.value - 1];
    const double thickness = development_.species().organs[organ.kind].tissue.thickness_mm;
    sheets_->set_thickness(i + offset, thickness * std::clamp(state.world_from_organ.scale, 0.05, 1.0));
  }
  const auto step = sheets_->advance(targets, progress);
  if (!step) {
    return step.error();
  }
  report.passes += static_cast<std::uint64_t>(step->passes);
  report.contacts += step->contacts;
  report.residual_mm = std::max(report.residual_mm, step->residual_mm);
  return std::nullopt;
}

/// The plant as it is, on the lattice, with its certificate.
Expected<Canopy> Run::show(double time, std::span<const Vec3> positions_mm) const {
  std::vector<Vec3> targets;
  Canopy canopy = targets_at(time, targets);
  bool too_large = false;
  const auto on_lattice = [&](Vec3 p) {
    const Vec3 q{std::nearbyint(p.x / kLattice_mm) * kLattice_mm, std::nearbyint(p.y / kLattice_mm) * kLattice_mm,
                 std::nearbyint(p.z / kLattice_mm) * kLattice_mm};
    too_large =
        too_large || !(std::abs(q.x) < kMaxExtent_mm && std::abs(q.y) < kMaxExtent_mm && std::abs(q.z) < kMaxExtent_mm);
    return q;
  };
  std::size_t first = 0;
  if (has_bodies_) {
    std::size_t vertex = 0;
    for (Body& each : canopy.bodies) {
      for (Vec3& p : each.mesh.positions_mm) {
        p = on_lattice(positions_mm[body_weld_.welded[vertex++]]);
      }
    }
    first = body_weld_.original.size();
  }
  for (OrganState& state : canopy.organs) {
    const WeldedTemplate& weld = welds_[development_.organs()[state.id.value - 1].template_index];
    for (const std::uint32_t welded : weld.welded) {
      const Vec3 p = on_lattice(positions_mm[first + welded]);
      state.deformed_mm.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    first += weld.original.size();
  }
  if (too_large) {
    return unexpected(Error{ErrorCode::kTooLarge, "collisions", "the plant must lie within 1 m of the origin"});
  }
  const CanopySurface surface = surface_of(development_, canopy);
  const auto audit = find_crossings(surface.positions_mm, surface.triangles, 20);
  if (!audit) {
    return unexpected(audit.error());
  }
  if (audit->count > 0) {
    std::string pairs;
    for (const Crossing& crossing : audit->crossings) {
      if (!pairs.empty()) {
        pairs += ", ";
      }
      pairs += owner_name(development_, canopy, surface.owner[crossing.first]);
      pairs += " and ";
      pairs += owner_name(development_, canopy, surface.owner[crossing.second]);
    }
    return unexpected(Error{ErrorCode::kCrossing, "collisions",
                            "the certificate failed at time " + to_text(time) + " with " +
                                std::to_string(audit->count) + " pairs of triangles: " + pairs});
  }
  return canopy;
}

/// What makes a run this run: everything that its frames depend on.
std::string Run::key(std::span<const double> times) const {
  std::string text = std::string(kVersion) + " " + development_.species().sha256;
  for (const double value :
       {static_cast<double>(development_.options().seed), development_.options().detail,
        static_cast<double>(options_.steps), static_cast<double>(options_.growing.sweeps), options_.growing.piece,
        static_cast<double>(options_.growing.settling_passes), options_.growing.residual_mm}) {
    text += ' ';
    text += to_text(value);
  }
  for (const double time : times) {
    text += ' ';
    text += to_text(time);
  }
  return sha256(text);
}

std::optional<Error> Run::follow(std::span<const double> times, const Progress& progress,
                                 AccommodatedDevelopment& result) {
  detail::Checkpoint now;
  const std::string run = key(times);
  if (options_.resume) {
    auto saved = detail::load_checkpoint(options_.checkpoint, run);
    if (!saved) {
      return saved.error();
    }
    now = std::move(*saved);
    if (now.next_step > 0) {
      sheets_->restore(now.snapshot);
    }
  }
  std::size_t saved_frames = now.seen_mm.size();
  const double last = times.empty() ? 0.0 : times.back();
  const auto see = [&] {
    const std::span<const Vec3> positions = sheets_->positions_mm();
    now.seen_mm.emplace_back(positions.begin(), positions.end());
  };
  while (now.seen_mm.size() < times.size()) {
    const double time = static_cast<double>(now.next_step) / options_.steps;
    const double before = now.next_step == 0 ? 0.0 : static_cast<double>(now.next_step - 1) / options_.steps;
    const Progress part = [&](std::string_view, double fraction) {
      return report(progress, "collisions", last > 0.0 ? std::min(1.0, lerp(before, time, fraction) / last) : fraction);
    };
    // Frames on the way to this step: go there, look, come back.
    while (now.seen_mm.size() < times.size() && times[now.seen_mm.size()] < time) {
      GrowingSheets::Snapshot here = sheets_->snapshot();
      CollisionReport aside;
      if (auto error = step_to(times[now.seen_mm.size()], part, aside)) {
        return error;
      }
      see();
      sheets_->restore(std::move(here));
    }
    if (now.seen_mm.size() == times.size()) {
      break;
    }
    if (auto error = step_to(time, part, now.report)) {
      return error;
    }
    while (now.seen_mm.size() < times.size() && times[now.seen_mm.size()] == time) {
      see();
    }
    now.report.steps = now.next_step++;
    if (!options_.checkpoint.empty()) {
      now.snapshot = sheets_->snapshot();
      if (auto error = detail::save_checkpoint(options_.checkpoint, run, now, saved_frames)) {
        return error;
      }
      saved_frames = now.seen_mm.size();
    }
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!report(progress, "certificate", static_cast<double>(i) / static_cast<double>(times.size()))) {
      return Error{ErrorCode::kCancelled, "", "cancelled"};
    }
    auto canopy = show(times[i], now.seen_mm[i]);
    if (!canopy) {
      return canopy.error();
    }
    now.seen_mm[i] = {};
    result.frames.push_back(std::move(*canopy));
  }
  result.report = now.report;
  if (!result.frames.empty()) {
    result.report.triangles = surface_of(development_, result.frames.back()).triangles.size();
  }
  return std::nullopt;
}

}  // namespace

Expected<AccommodatedDevelopment> resolve_collisions(const Development& development, std::span<const double> times,
                                                     const CollisionOptions& options, const Progress& progress) {
  if (options.steps < 1 || options.steps > 10000) {
    return unexpected(invalid_parameter("steps", "must be in [1, 10000]", options.steps));
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!(times[i] >= 0.0 && times[i] <= 1.0) || (i > 0 && times[i] < times[i - 1])) {
      return unexpected(invalid_parameter("times", "must be ascending and in [0, 1]", times[i]));
    }
  }
  if (options.resume && options.checkpoint.empty()) {
    return unexpected(Error{ErrorCode::kInvalidParameter, "resume", "must have a checkpoint folder to go on from"});
  }
  if (!options.resume && !options.checkpoint.empty() && detail::has_checkpoint(options.checkpoint)) {
    return unexpected(Error{ErrorCode::kInvalidParameter, "checkpoint",
                            "must be a folder without a run in it, or be resumed, got " + options.checkpoint});
  }
  Run run(development, options);
  AccommodatedDevelopment result;
  if (auto error = run.follow(times, progress, result)) {
    return unexpected(*error);
  }
  return result;
}

void remove_checkpoint(const std::string& folder) {
  detail::remove_checkpoint(folder);
}

CanopySurface surface_of(const Development& development, const Canopy& canopy) {
  CanopySurface surface;
  const auto add = [&](std::span<const Triangle> triangles, std::size_t first, std::size_t owner) {
    for (const Triangle& t : triangles) {
      const auto offset = static_cast<std::uint32_t>(first);
      surface.triangles.push_back({offset + t[0], offset + t[1], offset + t[2]});
      surface.owner.push_back(static_cast<std::uint32_t>(owner));
    }
  };
  for (std::size_t i = 0; i < canopy.organs.size(); ++i) {
    const OrganState& state = canopy.organs[i];
    const OrganTemplate& shape = development.templates()[development.organs()[state.id.value - 1].template_index];
    const std::size_t first = surface.positions_mm.size();
    if (state.deformed_mm.empty()) {
      std::vector<Vec3> positions(shape.vertex_count());
      std::vector<Vec3> normals(shape.vertex_count());
      shape.pose(state.stage, positions, normals);
      for (const Vec3 p : positions) {
        surface.positions_mm.push_back(apply(state.world_from_organ, p));
      }
    } else {
      for (const auto& p : state.deformed_mm) {
        surface.positions_mm.push_back({p[0], p[1], p[2]});
      }
    }
    add(shape.triangles(), first, i);
  }
  for (std::size_t j = 0; j < canopy.bodies.size(); ++j) {
    const Mesh& mesh = canopy.bodies[j].mesh;
    const std::size_t first = surface.positions_mm.size();
    surface.positions_mm.insert(surface.positions_mm.end(), mesh.positions_mm.begin(), mesh.positions_mm.end());
    add(mesh.triangles, first, canopy.organs.size() + j);
  }
  return surface;
}

std::string owner_name(const Development& development, const Canopy& canopy, std::uint32_t owner) {
  if (owner >= canopy.organs.size()) {
    return canopy.bodies[owner - canopy.organs.size()].name;
  }
  return organ_name(development, canopy.organs[owner].id);
}

}  // namespace anthesis
