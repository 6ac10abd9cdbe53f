#include "anthesis/geometry/mesh.h"

#include <gtest/gtest.h>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

TEST(SmoothNormals, OfAClosedTubeAreRadialAcrossItsSeam) {
  constexpr int kSides = 12;
  Mesh tube;
  std::vector<std::uint32_t> twin;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i <= kSides; ++i) {
      const double angle = math::kTurnRad * (i % kSides) / kSides;
      tube.positions_mm.push_back({math::cos(angle), math::sin(angle), static_cast<double>(j)});
      twin.push_back(static_cast<std::uint32_t>(j * (kSides + 1) + i % kSides));
    }
  }
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t above = kSides + 1 + i;
    tube.triangles.push_back({i, i + 1, above + 1});
    tube.triangles.push_back({i, above + 1, above});
  }
  tube.normals.resize(tube.positions_mm.size());
  smooth_normals(tube.positions_mm, tube.triangles, twin, tube.normals);
  for (std::size_t i = 0; i < tube.normals.size(); ++i) {
    const Vec3 p = tube.positions_mm[i];
    EXPECT_NEAR(length(tube.normals[i] - Vec3{p.x, p.y, 0.0}), 0.0, 1e-7)
        << i;  // acos near 0 and 1 costs half the digits
  }
}

TEST(SmoothNormals, WithoutTwinsTheSeamShows) {
  // The property above must not hold by accident: a lone quadrilateral's normal is its own.
  const std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
  std::vector<Vec3> normals(positions.size());
  smooth_normals(positions, triangles, {}, normals);
  EXPECT_NEAR(normals[0].z, 1.0, 1e-15);
  EXPECT_NEAR(normals[4].x, 1.0, 1e-15);
}

}  // namespace
}  // namespace anthesis
