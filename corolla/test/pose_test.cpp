#include "anthesis/corolla/pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/base/random.h"

namespace anthesis {
namespace {

/// A midrib of eight segments, 4 mm each, that heads up and has turned by `turn_deg` over its length.
std::vector<Vec3> midrib(double turn_deg, double scale = 1.0) {
  std::vector<Vec3> points = {{0, 0, 0}};
  for (int i = 0; i < 8; ++i) {
    const double angle = math::radians(turn_deg) * i / 7.0;
    points.push_back(points.back() + scale * 4.0 * Vec3{math::sin(angle), 0.0, math::cos(angle)});
  }
  return points;
}

TEST(Blend, APetalThatTurns170DegreesKeepsItsLengthWhereLinearBlendingLosesAThird) {
  // The whole petal swings over from its base: all segments turn by 170 degrees.
  std::vector<Vec3> closed = {{0, 0, 0}};
  std::vector<Vec3> open = {{0, 0, 0}};
  const double swing = math::radians(170.0);
  for (int i = 0; i < 8; ++i) {
    closed.push_back(closed.back() + Vec3{0, 0, 4.0});
    open.push_back(open.back() + 5.0 * Vec3{math::sin(swing), 0, math::cos(swing)});
  }
  const IntrinsicPolyline a = to_intrinsic(closed);
  const IntrinsicPolyline b = to_intrinsic(open);
  double worst_linear = 1.0;
  for (int step = 0; step <= 20; ++step) {
    const double share = step / 20.0;
    std::vector<Vec3> points(closed.size());
    from_intrinsic(blend(a, b, share), points);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const double wanted = lerp(4.0, 5.0, share);
      EXPECT_NEAR(length(points[i + 1] - points[i]) / wanted, 1.0, 0.01) << share;
      const Vec3 linear = lerp(closed[i + 1], open[i + 1], share) - lerp(closed[i], open[i], share);
      worst_linear = std::min(worst_linear, length(linear) / wanted);
    }
  }
  EXPECT_LT(worst_linear, 0.7);
}

TEST(Blend, HalfWayBetweenTwoArcsIsTheArcOfHalfTheTurn) {
  std::vector<Vec3> points(9);
  from_intrinsic(blend(to_intrinsic(midrib(0.0)), to_intrinsic(midrib(160.0)), 0.5), points);
  const std::vector<Vec3> expected = midrib(80.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(length(points[i] - expected[i]), 0.0, 1e-12);
  }
}

TEST(Intrinsic, RebuildsAnyPolyline) {
  Rng rng(9, 0, RandomPurpose::kTest);
  std::vector<Vec3> points(12);
  for (Vec3& p : points) {
    p = {rng.normal(), rng.normal(), rng.normal()};
  }
  points[5] = points[4];  // control points may coincide
  std::vector<Vec3> rebuilt(points.size());
  from_intrinsic(to_intrinsic(points), rebuilt);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(length(rebuilt[i] - points[i]), 0.0, 1e-12);
  }
}

TEST(PoseBlend, PosesAreReproducedExactlyAtTheirStagesAndHeldOutside) {
  std::vector<ControlMesh> meshes;
  for (const double turn : {0.0, 60.0, 170.0}) {
    ControlMesh mesh{1, 9, midrib(turn, 1.0 + turn / 100.0)};
    meshes.push_back(mesh);
  }
  const PoseBlend blend({0.1, 0.5, 0.9}, meshes);
  EXPECT_EQ(blend.at(0.1).points_mm, meshes[0].points_mm);
  EXPECT_EQ(blend.at(0.5).points_mm, meshes[1].points_mm);
  EXPECT_EQ(blend.at(0.9).points_mm, meshes[2].points_mm);
  EXPECT_EQ(blend.at(0.0).points_mm, meshes[0].points_mm);
  EXPECT_EQ(blend.at(1.0).points_mm, meshes[2].points_mm);
}

TEST(PoseBlend, DevelopmentIsContinuousThroughAPose) {
  const PoseBlend blend({0.0, 0.5, 1.0},
                        {ControlMesh{1, 9, midrib(0)}, ControlMesh{1, 9, midrib(70)}, ControlMesh{1, 9, midrib(170)}});
  const auto at = [&](double stage) { return blend.at(stage).points_mm.back(); };
  EXPECT_NEAR(length(at(0.5 - 1e-9) - at(0.5)), 0.0, 1e-6);
  EXPECT_NEAR(length(at(0.5 + 1e-9) - at(0.5)), 0.0, 1e-6);
}

}  // namespace
}  // namespace anthesis
