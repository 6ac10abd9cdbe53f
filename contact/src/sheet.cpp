#include "anthesis/contact/sheet.h"

#include <algorithm>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"

namespace anthesis {

Sheet make_sheet(std::size_t vertex_count, std::span<const Triangle> triangles) {
  struct Side {
    std::array<std::uint32_t, 2> edge;  ///< smaller vertex first
    std::uint32_t apex;
    bool forward;  ///< the triangle runs from the smaller to the larger vertex
    std::uint32_t triangle;
  };
  Sheet sheet;
  sheet.vertex_count = vertex_count;
  sheet.triangles.assign(triangles.begin(), triangles.end());
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k];
      const std::uint32_t b = triangles[t][(k + 1) % 3];
      ANTHESIS_ASSERT(a != b && a < vertex_count && b < vertex_count);
      sides.push_back({{std::min(a, b), std::max(a, b)}, triangles[t][(k + 2) % 3], a < b, t});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle; });
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i == 0 || sides[i].edge != sides[i - 1].edge) {
      sheet.edges.push_back(sides[i].edge);
      continue;
    }
    const Side& one = sides[i - 1];
    const Side& other = sides[i];
    const auto [a, b] = one.edge;
    if (one.forward) {
      sheet.hinges.push_back({a, b, one.apex, other.apex});
    } else {
      sheet.hinges.push_back({b, a, one.apex, other.apex});
    }
  }
  sheet.edge_stiffness.assign(sheet.edges.size(), 1.0);
  sheet.hinge_stiffness.assign(sheet.hinges.size(), 1.0);
  return sheet;
}

double hinge_angle_rad(Vec3 edge_first, Vec3 edge_second, Vec3 apex, Vec3 other_apex) {
  const Vec3 edge = edge_second - edge_first;
  const Vec3 one = cross(edge, apex - edge_first);          // normal of the first triangle, times twice its area
  const Vec3 other = cross(other_apex - edge_first, edge);  // and of the second
  // atan2 keeps its precision where the triangles are almost flat, which acos of the normals' product loses.
  return math::atan2(dot(cross(one, other), normalized(edge)), dot(one, other));
}

}  // namespace anthesis
