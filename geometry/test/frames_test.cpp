#include "anthesis/geometry/frames.h"

#include <gtest/gtest.h>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

TEST(RotationMinimisingFrames, FollowTheSegmentsWithoutTwisting) {
  // A planar curve keeps the normal of its plane.
  std::vector<Vec3> arc;
  for (int i = 0; i < 20; ++i) {
    arc.push_back({math::cos(0.2 * i), 0.0, math::sin(0.2 * i)});
  }
  const auto frames = rotation_minimising_frames(arc, {0, 1, 0});
  ASSERT_EQ(frames.size(), arc.size() - 1);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_NEAR(length(rotate(frames[i], {1, 0, 0}) - normalized(arc[i + 1] - arc[i])), 0.0, 1e-13);
    EXPECT_NEAR(length(rotate(frames[i], {0, 1, 0}) - Vec3{0, 1, 0}), 0.0, 1e-13);
  }
}

TEST(RotationMinimisingFrames, TurnOnlyAboutAxesPerpendicularToBothSegments) {
  std::vector<Vec3> helix;
  for (int i = 0; i < 60; ++i) {
    helix.push_back({math::cos(0.3 * i), math::sin(0.3 * i), 0.05 * i});
  }
  const auto frames = rotation_minimising_frames(helix, {0, 0, 1});
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Quaternion turn = conjugate(frames[i - 1]) * frames[i];
    EXPECT_NEAR(turn.x, 0.0, 1e-13);  // no part about the segment itself
  }
}

TEST(RotationMinimisingFrames, DegenerateSegmentsKeepTheDirection) {
  const std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 0, 1}, {1, 0, 1}};
  const auto frames = rotation_minimising_frames(points, {0, 0, 1});
  EXPECT_NEAR(length(rotate(frames[0], {1, 0, 0}) - Vec3{0, 0, 1}), 0.0, 1e-14);
  EXPECT_NEAR(length(rotate(frames[2], {1, 0, 0}) - Vec3{0, 0, 1}), 0.0, 1e-14);
  EXPECT_NEAR(length(rotate(frames[3], {1, 0, 0}) - Vec3{1, 0, 0}), 0.0, 1e-14);
}

}  // namespace
}  // namespace anthesis
