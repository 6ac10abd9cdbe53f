#include "anthesis/corolla/surface_follower.h"

#include <algorithm>

#include "anthesis/base/assert.h"

namespace anthesis {
namespace {

/// Vertices of equal v, from u = 0 to u = 1, or one alone that stands for all u: the tip of a pointed petal.
struct Row {
  double v = 0.0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// The rows of each copy of a petal or column in a group. Copies follow one another, each from base to tip.
std::vector<std::vector<Row>> rows_of_copies(const OrganTemplate& organ, const TemplateGroup& group) {
  std::vector<std::vector<Row>> copies;
  const std::span<const Vec2> uvs = organ.uvs();
  for (std::uint32_t i = group.first_vertex; i < group.first_vertex + group.vertex_count; ++i) {
    if (copies.empty() || uvs[i].y < copies.back().back().v) {
      copies.emplace_back();
    }
    std::vector<Row>& rows = copies.back();
    if (rows.empty() || rows.back().v != uvs[i].y) {
      rows.push_back({uvs[i].y, i, 0});
    }
    ++rows.back().count;
  }
  return copies;
}

/// Where `value` lies among ascending values: between which two, and its share of the way from the first to the second.
struct Between {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  double share = 0.0;
};

template <class ValueAt>
Between locate(std::uint32_t count, const ValueAt& value_at, double value) {
  std::uint32_t after = 0;
  while (after < count && value_at(after) <= value) {
    ++after;
  }
  if (after == 0 || after == count) {
    const std::uint32_t nearest = after == 0 ? 0 : count - 1;
    return {nearest, nearest, 0.0};
  }
  const double before = value_at(after - 1);
  return {after - 1, after, (value - before) / (value_at(after) - before)};
}

/// The axes of a triangle: one of its edges, and its normal.
Quaternion frame_of(Vec3 edge, Vec3 area) {
  const Vec3 x = normalized(edge);
  const Vec3 z = normalized(area);
  return rotation_from_axes(x, cross(z, x), z);
}

/// Adds a rotation to a sum of rotations, as large as `weight` and not of length 1. q and -q are one rotation: the one
/// on the side of the sum is taken.
void add(Quaternion& sum, Quaternion q, double weight) {
  const double side = sum.w * q.w + sum.x * q.x + sum.y * q.y + sum.z * q.z < 0.0 ? -weight : weight;
  sum = {sum.w + side * q.w, sum.x + side * q.x, sum.y + side * q.y, sum.z + side * q.z};
}

/// How a triangle has turned: the mean over its edges, since one edge alone also turns when the triangle is stretched.
/// Not of length 1. No turn at all is exact.
Quaternion turn_of(const std::array<Vec3, 3>& rest, const std::array<Vec3, 3>& bent, Vec3 rest_area, Vec3 bent_area) {
  Quaternion sum{0.0, 0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < 3; ++k) {
    add(sum, rest == bent ? Quaternion{} : frame_of(bent[k], bent_area) * conjugate(frame_of(rest[k], rest_area)), 1.0);
  }
  return sum;
}

/// How the surroundings of each vertex have turned; twins have turned alike.
std::vector<Quaternion> turns(const OrganTemplate& organ, std::span<const Vec3> rest_mm,
                              std::span<const Vec3> bent_mm) {
  const std::span<const std::uint32_t> twins = organ.twins();
  std::vector<Quaternion> sums(organ.vertex_count(), Quaternion{0.0, 0.0, 0.0, 0.0});
  for (const Triangle& t : organ.triangles()) {
    const auto edges = [&t](std::span<const Vec3> p) {
      return std::array<Vec3, 3>{p[t[1]] - p[t[0]], p[t[2]] - p[t[1]], p[t[0]] - p[t[2]]};
    };
    const std::array<Vec3, 3> rest = edges(rest_mm);
    const std::array<Vec3, 3> bent = edges(bent_mm);
    const Vec3 rest_area = cross(rest[0], rest[1]);
    const Vec3 bent_area = cross(bent[0], bent[1]);
    // A sliver's normal says little.
    const double weight = std::min(length(rest_area), length(bent_area));
    if (weight > 0.0) {
      const Quaternion turn = turn_of(rest, bent, rest_area, bent_area);
      for (const std::uint32_t vertex : t) {
        add(sums[twins[vertex]], turn, weight);
      }
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (twins[i] != i) {
      sums[i] = sums[twins[i]];  // which comes before
      continue;
    }
    const Quaternion q = sums[i];
    const bool turned = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z > 0.0;
    sums[i] = turned ? normalized(q) : Quaternion{};
  }
  return sums;
}

}  // namespace

SurfaceFollower::SurfaceFollower(const OrganTemplate& coarse, const OrganTemplate& fine)
    : coarse_(coarse), fine_(fine), neighbours_(fine.vertex_count()) {
  ANTHESIS_ASSERT(coarse.groups().size() == fine.groups().size());
  const std::span<const Vec2> uvs = coarse.uvs();
  for (std::size_t g = 0; g < fine.groups().size(); ++g) {
    const std::vector<std::vector<Row>> coarse_copies = rows_of_copies(coarse, coarse.groups()[g]);
    const std::vector<std::vector<Row>> fine_copies = rows_of_copies(fine, fine.groups()[g]);
    ANTHESIS_ASSERT(coarse_copies.size() == fine_copies.size());
    for (std::size_t copy = 0; copy < fine_copies.size(); ++copy) {
      const std::vector<Row>& rows = coarse_copies[copy];
      for (const Row& row : fine_copies[copy]) {
        const Between along = locate(
            static_cast<std::uint32_t>(rows.size()), [&](std::uint32_t j) { return rows[j].v; }, row.v);
        for (std::uint32_t i = row.first; i < row.first + row.count; ++i) {
          const auto across = [&](const Row& in) {
            return locate(
                in.count, [&](std::uint32_t k) { return uvs[in.first + k].x; }, fine.uvs()[i].x);
          };
          const Row& below = rows[along.first];
          const Row& above = rows[along.second];
          const Between in_below = across(below);
          const Between in_above = across(above);
          neighbours_[i] = {{{below.first + in_below.first, (1.0 - along.share) * (1.0 - in_below.share)},
                             {below.first + in_below.second, (1.0 - along.share) * in_below.share},
                             {above.first + in_above.first, along.share * (1.0 - in_above.share)},
                             {above.first + in_above.second, along.share * in_above.share}}};
        }
      }
    }
  }
}

void SurfaceFollower::follow(std::span<const Vec3> rest_mm, std::span<const Vec3> bent_mm,
                             std::span<Vec3> fine_mm) const {
  ANTHESIS_ASSERT(rest_mm.size() == coarse_.vertex_count() && bent_mm.size() == coarse_.vertex_count() &&
                  fine_mm.size() == fine_.vertex_count());
  const std::vector<Quaternion> turned = turns(coarse_, rest_mm, bent_mm);
  for (std::size_t i = 0; i < fine_mm.size(); ++i) {
    Vec3 between;  // the place on the coarse surface
    for (const Neighbour& neighbour : neighbours_[i]) {
      between += neighbour.weight * rest_mm[neighbour.vertex];
    }
    // As a displacement, so that a surface at rest stays where it is to the last bit. Half the arm along the surface:
    // between two vertices that have turned apart the mean of whole arms would bulge twice as far as the arc that has
    // their directions at its ends, and half is that arc.
    Vec3 displacement;
    for (const Neighbour& neighbour : neighbours_[i]) {
      if (neighbour.weight > 0.0) {
        const Vec3 arm = fine_mm[i] - between + 0.5 * (between - rest_mm[neighbour.vertex]);
        const Vec3 moved = bent_mm[neighbour.vertex] - rest_mm[neighbour.vertex];
        displacement += neighbour.weight * (moved + (rotate(turned[neighbour.vertex], arm) - arm));
      }
    }
    fine_mm[i] = fine_mm[i] + displacement;
  }
  // Where a fused margin ends between two coarse rows, its two sides follow different vertices.
  for (std::size_t i = 0; i < fine_mm.size(); ++i) {
    fine_mm[i] = fine_mm[fine_.twins()[i]];
  }
}

}  // namespace anthesis
