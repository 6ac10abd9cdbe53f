#include "anthesis/geometry/vec.h"

#include <gtest/gtest.h>

#include "anthesis/base/math.h"
#include "anthesis/base/random.h"

namespace anthesis {
namespace {

Vec3 random_direction(Rng& rng) {
  return normalized(Vec3{rng.normal(), rng.normal(), rng.normal()});
}

TEST(Quaternion, RotationAboutAnAxisIsCounterClockwise) {
  const Vec3 y = rotate(rotation_about({0, 0, 1}, 0.5 * math::kPi), {1, 0, 0});
  EXPECT_NEAR(length(y - Vec3{0, 1, 0}), 0.0, 1e-15);
}

TEST(Quaternion, RotationBetweenTurnsOneVectorIntoTheOtherEvenWhenOpposite) {
  Rng rng(1, 1, RandomPurpose::kTest);
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = random_direction(rng);
    const Vec3 b = i % 10 == 0 ? -a : random_direction(rng);
    const Quaternion q = rotation_between(a, b, any_perpendicular(a));
    EXPECT_NEAR(length(rotate(q, a) - b), 0.0, 1e-13);
    // Smallest: its axis is perpendicular to both.
    EXPECT_NEAR(dot(Vec3{q.x, q.y, q.z}, a), 0.0, 1e-13);
  }
}

TEST(Quaternion, AxesGoWhereTheyAreSaidTo) {
  Rng rng(2, 1, RandomPurpose::kTest);
  for (int i = 0; i < 200; ++i) {
    const Vec3 x = random_direction(rng);
    const Vec3 y = normalized(cross(random_direction(rng), x));
    const Vec3 z = cross(x, y);
    const Quaternion q = rotation_from_axes(x, y, z);
    EXPECT_NEAR(length(rotate(q, {1, 0, 0}) - x), 0.0, 1e-14);
    EXPECT_NEAR(length(rotate(q, {0, 1, 0}) - y), 0.0, 1e-14);
    EXPECT_NEAR(length(rotate(q, {0, 0, 1}) - z), 0.0, 1e-14);
  }
}

TEST(Slerp, TurnsAtConstantSpeedAndMeetsItsEndsExactly) {
  const Vec3 axis = normalized(Vec3{1, 2, 3});
  const Quaternion a = rotation_about(axis, 0.2);
  const Quaternion b = rotation_about(axis, 2.9);
  EXPECT_EQ(slerp(a, b, 0.0), a);
  EXPECT_EQ(slerp(a, b, 1.0), b);
  for (const double t : {0.1, 0.25, 0.5, 0.9}) {
    const Quaternion expected = rotation_about(axis, 0.2 + t * 2.7);
    EXPECT_NEAR(std::abs(slerp(a, b, t).w - expected.w), 0.0, 1e-15);
  }
}

TEST(Placement, ProductAppliesTheInnerFirst) {
  const Placement outer{{1, 2, 3}, rotation_about({0, 0, 1}, 0.7), 2.0};
  const Placement inner{{-1, 0, 4}, rotation_about({1, 0, 0}, -0.3), 0.5};
  const Vec3 p{0.3, -0.8, 2.0};
  EXPECT_NEAR(length(apply(outer * inner, p) - apply(outer, apply(inner, p))), 0.0, 1e-14);
}

}  // namespace
}  // namespace anthesis
