#include "anthesis/corolla/hair_coat.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"
#include "anthesis/base/random.h"

namespace anthesis {
namespace {

constexpr int kSides = 3;       // a hair is thinner than a pixel: a prism will do
constexpr int kBentPieces = 4;  // along a hair that bends

/// The direction of growing v on a triangle, as weights of its edges from corner 0; zero where (u, v) does not span it.
std::array<double, 2> direction_of_v(Vec2 a, Vec2 b, Vec2 c) {
  const Vec2 ab = b - a;
  const Vec2 ac = c - a;
  const double det = cross(ab, ac);
  return det == 0.0 ? std::array<double, 2>{0.0, 0.0} : std::array<double, 2>{-ac.x / det, ab.x / det};
}

/// Part of a triangle between two values of v, as a polygon in weights of the corners.
std::vector<std::array<double, 3>> cut(Vec2 a, Vec2 b, Vec2 c, const Range& along) {
  std::vector<std::array<double, 3>> polygon = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto v_of = [&](const std::array<double, 3>& w) { return w[0] * a.y + w[1] * b.y + w[2] * c.y; };
  for (const double sign : {1.0, -1.0}) {
    const double limit = sign > 0.0 ? along[0] : along[1];
    std::vector<std::array<double, 3>> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const std::array<double, 3>& p = polygon[i];
      const std::array<double, 3>& q = polygon[(i + 1) % polygon.size()];
      const double inside_p = sign * (v_of(p) - limit);
      const double inside_q = sign * (v_of(q) - limit);
      if (inside_p >= 0.0) {
        kept.push_back(p);
      }
      if ((inside_p >= 0.0) != (inside_q >= 0.0)) {
        const double t = inside_p / (inside_p - inside_q);
        kept.push_back({lerp(p[0], q[0], t), lerp(p[1], q[1], t), lerp(p[2], q[2], t)});
      }
    }
    polygon = std::move(kept);
  }
  return polygon;
}

}  // namespace

double HairCoat::plant(const Hairs& hairs, std::span<const Triangle> triangles, std::span<const Vec2> uvs,
                       std::span<const Vec3> grown_mm, std::uint64_t seed, std::uint64_t key) {
  ANTHESIS_ASSERT(uvs.size() == grown_mm.size());
  // A triangle that hairs stand on, and the area up to its end.
  struct Patch {
    Triangle corners;
    std::array<std::array<double, 3>, 3> weights;  // of those corners, at the corners of the patch
    double until_mm2;
  };
  std::vector<Patch> patches;
  double area_mm2 = 0.0;
  for (const Triangle& t : triangles) {
    const auto polygon = cut(uvs[t[0]], uvs[t[1]], uvs[t[2]], hairs.along);
    const double whole_mm2 = 0.5 * length(cross(grown_mm[t[1]] - grown_mm[t[0]], grown_mm[t[2]] - grown_mm[t[0]]));
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      const auto& [p, q, r] = std::array{polygon[0], polygon[i], polygon[i + 1]};
      // Weights 1 and 2 are coordinates on the triangle, which has area 1/2 in them.
      const double share = std::abs(cross(Vec2{q[1] - p[1], q[2] - p[2]}, Vec2{r[1] - p[1], r[2] - p[2]}));
      area_mm2 += share * whole_mm2;
      patches.push_back({t, {p, q, r}, area_mm2});
    }
  }
  const std::size_t sides = (hairs.upper ? 1u : 0u) + (hairs.lower ? 1u : 0u);
  const std::size_t room = (kMaxHairs - roots_.size()) / sides;
  const double wanted = std::floor(area_mm2 * hairs.density_per_mm2 + 0.5);
  const std::size_t count = wanted < static_cast<double>(room) ? static_cast<std::size_t>(wanted) : room;
  groups_.push_back(
      {hairs.on, hairs.pigment, static_cast<std::uint32_t>(roots_.size()), static_cast<std::uint32_t>(count * sides)});
  const bool bends = hairs.bend_deg[0] != 0.0 || hairs.bend_deg[1] != 0.0;
  kinds_.push_back({hairs.radius_mm, bends ? kBentPieces : 1});
  for (std::size_t number = 0; number < count * sides; ++number) {
    Rng rng(seed, (key << 32) + number, RandomPurpose::kHair);
    Root root;
    root.lower = hairs.upper ? number >= count : true;
    // One hair for each of `count` equal shares of the area: rows of triangles get as many as they have room for.
    const double place_mm2 =
        (static_cast<double>(number % count) + rng.uniform()) / static_cast<double>(count) * area_mm2;
    const auto found = std::lower_bound(patches.begin(), patches.end() - 1, place_mm2,
                                        [](const Patch& patch, double at) { return patch.until_mm2 < at; });
    const double r = std::sqrt(rng.uniform());
    const double s = rng.uniform();
    root.triangle = found->corners;
    for (std::size_t k = 0; k < 3; ++k) {
      root.weight[k] =
          (1.0 - r) * found->weights[0][k] + r * (1.0 - s) * found->weights[1][k] + r * s * found->weights[2][k];
    }
    const Triangle& t = root.triangle;
    root.towards_tip = direction_of_v(uvs[t[0]], uvs[t[1]], uvs[t[2]]);
    root.length_mm = rng.uniform(hairs.length_mm[0], hairs.length_mm[1]);
    root.lean_rad = math::radians(rng.uniform(hairs.lean_deg[0], hairs.lean_deg[1]));
    root.swirl_rad = math::radians(rng.uniform(hairs.swirl_deg[0], hairs.swirl_deg[1]));
    root.bend_rad = math::radians(rng.uniform(hairs.bend_deg[0], hairs.bend_deg[1]));
    roots_.push_back(root);
  }
  return wanted * static_cast<double>(sides);
}

void HairCoat::append(std::size_t group, std::span<const Vec3> positions_mm, std::span<const Vec3> normals,
                      double scale, Mesh& mesh) const {
  const Kind& kind = kinds_[group];
  for (std::uint32_t i = 0; i < groups_[group].hair_count; ++i) {
    const Root& root = roots_[groups_[group].first_hair + i];
    const auto& [a, b, c] = root.triangle;
    const Vec3 at =
        root.weight[0] * positions_mm[a] + root.weight[1] * positions_mm[b] + root.weight[2] * positions_mm[c];
    Vec3 up = normalized(root.weight[0] * normals[a] + root.weight[1] * normals[b] + root.weight[2] * normals[c]);
    if (up == Vec3{}) {
      continue;  // no surface here
    }
    up = root.lower ? -up : up;
    Vec3 forward = root.towards_tip[0] * (positions_mm[b] - positions_mm[a]) +
                   root.towards_tip[1] * (positions_mm[c] - positions_mm[a]);
    forward = normalized(forward - dot(forward, up) * up);
    if (forward == Vec3{}) {
      forward = any_perpendicular(up);
    }
    const auto [swirl_sine, swirl_cosine] = math::sin_cos(root.swirl_rad);
    forward = swirl_cosine * forward + swirl_sine * cross(up, forward);
    const Vec3 side = cross(up, forward);
    const auto base = static_cast<std::uint32_t>(mesh.positions_mm.size());
    Vec3 centre = at;
    for (int piece = 0; piece <= kind.pieces; ++piece) {
      // The hair is an arc in the plane of `up` and `forward`; its ring here is perpendicular to it.
      const double share = static_cast<double>(piece) / kind.pieces;
      const auto [sine, cosine] = math::sin_cos(root.lean_rad + share * root.bend_rad);
      const Vec3 along = cosine * up + sine * forward;
      const Vec3 out = cosine * forward - sine * up;
      const bool tip = piece == kind.pieces;
      for (int k = 0; k < (tip ? 1 : kSides); ++k) {
        const auto [s, c_] = math::sin_cos(math::kTurnRad * k / kSides);
        const Vec3 radial = c_ * out + s * side;
        // The root is cut off along the surface: what leans would come out of its other side.
        const Vec3 spoke = piece == 0 ? c_ * forward + s * side : radial;
        mesh.positions_mm.push_back(tip ? centre : centre + (scale * kind.radius_mm * (1.0 - share)) * spoke);
        mesh.normals.push_back(tip ? along : radial);
        mesh.uvs.push_back({tip ? 0.5 : static_cast<double>(k) / kSides, share});
      }
      if (!tip) {
        const auto [middle_sine, middle_cosine] =
            math::sin_cos(root.lean_rad + (share + 0.5 / kind.pieces) * root.bend_rad);
        centre += (scale * root.length_mm / kind.pieces) * (middle_cosine * up + middle_sine * forward);
      }
    }
    for (int piece = 0; piece < kind.pieces; ++piece) {
      const std::uint32_t below = base + static_cast<std::uint32_t>(kSides * piece);
      const std::uint32_t above = below + kSides;
      for (std::uint32_t k = 0; k < kSides; ++k) {
        const std::uint32_t next = (k + 1) % kSides;
        if (piece + 1 == kind.pieces) {
          mesh.triangles.push_back({below + k, below + next, above});
        } else {
          mesh.triangles.push_back({below + k, below + next, above + next});
          mesh.triangles.push_back({below + k, above + next, above + k});
        }
      }
    }
  }
}

}  // namespace anthesis
