#include "anthesis/geometry/mesh.h"

#include <algorithm>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"

namespace anthesis {

Vec3 area_vector(const std::vector<Vec3>& positions_mm, const Triangle& triangle) {
  const Vec3 a = positions_mm[triangle[0]];
  return cross(positions_mm[triangle[1]] - a, positions_mm[triangle[2]] - a);
}

void smooth_normals(std::span<const Vec3> positions_mm, std::span<const Triangle> triangles,
                    std::span<const std::uint32_t> twin, std::span<Vec3> normals) {
  ANTHESIS_ASSERT(normals.size() == positions_mm.size());
  std::fill(normals.begin(), normals.end(), Vec3{});
  const auto home = [&](std::uint32_t vertex) { return twin.empty() ? vertex : twin[vertex]; };
  for (const Triangle& triangle : triangles) {
    const Vec3 a = positions_mm[triangle[0]];
    const Vec3 b = positions_mm[triangle[1]];
    const Vec3 c = positions_mm[triangle[2]];
    const Vec3 normal = normalized(cross(b - a, c - a));
    const Vec3 ab = normalized(b - a);
    const Vec3 bc = normalized(c - b);
    const Vec3 ca = normalized(a - c);
    // An angle needs no more accuracy than its use as a weight: atan2 of the two products would cost three times this.
    const auto angle = [](Vec3 p, Vec3 q) { return math::acos(std::clamp(-dot(p, q), -1.0, 1.0)); };
    normals[home(triangle[0])] += angle(ca, ab) * normal;
    normals[home(triangle[1])] += angle(ab, bc) * normal;
    normals[home(triangle[2])] += angle(bc, ca) * normal;
  }
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    if (home(i) == i) {
      const Vec3 normal = normalized(normals[i]);
      normals[i] = normal == Vec3{} ? Vec3{0.0, 0.0, 1.0} : normal;
    } else {
      ANTHESIS_ASSERT(twin[i] < i);
      normals[i] = normals[twin[i]];
    }
  }
}

}  // namespace anthesis
