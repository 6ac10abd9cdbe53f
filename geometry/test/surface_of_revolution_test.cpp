#include "anthesis/geometry/surface_of_revolution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

TEST(SurfaceOfRevolution, DiskHasTheAreaOfADisk) {
  const SurfaceOfRevolution disk({{0.0, 2.0}, {3.0, 2.0}}, 1);
  EXPECT_NEAR(disk.area_mm2(), math::kPi * 9.0, 1e-12);
  EXPECT_NEAR(disk.length_mm(), 3.0, 1e-14);
  EXPECT_NEAR(disk.area_from_apex_mm2(0.5), math::kPi * 2.25, 1e-12);
  EXPECT_NEAR(disk.radius_mm(disk.t_from_area_mm2(math::kPi)), 1.0, 1e-12);
  EXPECT_NEAR(length(disk.frame(0.5, 1.0).normal - Vec3{0, 0, 1}), 0.0, 1e-15);
}

TEST(SurfaceOfRevolution, ConeHasItsSlantArea) {
  const SurfaceOfRevolution cone({{0.0, 4.0}, {3.0, 0.0}}, 1);
  EXPECT_NEAR(cone.area_mm2(), math::kPi * 3.0 * 5.0, 1e-11);
  EXPECT_NEAR(dot(cone.frame(0.3, 0.4).normal, cone.frame(0.3, 0.4).meridian), 0.0, 1e-15);
  EXPECT_NEAR(cone.frame(0.3, 0.4).normal.z, 0.6, 1e-15);
}

TEST(SurfaceOfRevolution, FrameIsRightHandedAndFollowsTheSurface) {
  const SurfaceOfRevolution surface({{0, 3}, {2, 3}, {3, 2}, {2.5, 0}, {1, -1}}, 3);
  for (const double t : {0.1, 0.4, 0.8}) {
    const SurfaceFrame frame = surface.frame(t, 2.0);
    EXPECT_NEAR(length(cross(frame.meridian, frame.parallel) - frame.normal), 0.0, 1e-14);
    const double h = 1e-6;
    const Vec3 along = surface.frame(t + h, 2.0).position_mm - surface.frame(t - h, 2.0).position_mm;
    const Vec3 around = surface.frame(t, 2.0 + h).position_mm - surface.frame(t, 2.0 - h).position_mm;
    EXPECT_NEAR(length(normalized(along) - frame.meridian), 0.0, 1e-8);
    EXPECT_NEAR(length(normalized(around) - frame.parallel), 0.0, 1e-8);
  }
}

TEST(SurfaceOfRevolution, ArcLengthParameterMeetsAnIndependentSum) {
  const SurfaceOfRevolution surface({{0, 3}, {2, 3}, {3, 2}, {2.5, 0}, {1, -1}}, 3);
  const double t = surface.t_from_s(0.37);
  double chord_sum = 0.0;
  Vec2 before = surface.profile_mm().at(0.0);
  constexpr int kSteps = 200'000;
  for (int i = 1; i <= kSteps; ++i) {
    const Vec2 point = surface.profile_mm().at(t * i / kSteps);
    chord_sum += length(point - before);
    before = point;
  }
  EXPECT_NEAR(chord_sum / surface.length_mm(), 0.37, 1e-9);
}

TEST(SurfaceOfRevolution, CoincidentControlPointsStillHaveANormal) {
  const SurfaceOfRevolution surface({{0, 1}, {0, 1}, {0, 1}, {0, 1}, {2, 1}, {3, 0}}, 3);
  const SurfaceFrame frame = surface.frame(0.0, 0.0);
  EXPECT_NEAR(length(frame.normal), 1.0, 1e-12);
}

TEST(SurfaceOfRevolution, ChainOfBezierCurvesMayHaveCorners) {
  // A cylinder with a flat lid, in one profile.
  const SurfaceOfRevolution tin(bezier_chain<Vec2>({{0, 5}, {2, 5}, {2, 0}}, 1));
  EXPECT_NEAR(tin.area_mm2(), math::kPi * (4.0 + 2.0 * 2.0 * 5.0), 1e-11);
  EXPECT_NEAR(tin.length_mm(), 7.0, 1e-13);
  EXPECT_NEAR(tin.s_from_t(0.5), 2.0 / 7.0, 1e-14);
  EXPECT_NEAR(length(tin.frame(0.25, 1.0).normal - Vec3{0, 0, 1}), 0.0, 1e-15);
  EXPECT_NEAR(tin.frame(0.75, 1.0).normal.z, 0.0, 1e-15);
}

TEST(SurfaceOfRevolution, QuarterCirclesMakeASphere) {
  const double k = 0.5522847498;
  const SurfaceOfRevolution sphere(bezier_chain<Vec2>({{0, 1}, {k, 1}, {1, k}, {1, 0}, {1, -k}, {k, -1}, {0, -1}}, 3));
  EXPECT_NEAR(sphere.area_mm2(), 4.0 * math::kPi, 0.01);
  EXPECT_NEAR(sphere.s_from_t(0.5), 0.5, 1e-12);
}

TEST(CheckProfile, NamesTheRuleThatKnotsBreak) {
  const BSplineCurve<Vec2> good = bezier_chain<Vec2>({{0, 1}, {1, 1}, {1, 0}, {2, 0}, {2, -1}}, 2);
  EXPECT_FALSE(check_profile("p", good));
  const auto message = [](BSplineCurve<Vec2> curve) {
    const auto error = check_profile("p", curve);
    return error ? error->message : std::string();
  };
  BSplineCurve<Vec2> bad = good;
  bad.inner_knots = {0.5};
  EXPECT_EQ(message(bad), "must have as many interior knots as points less its degree less 1, got 1");
  bad.inner_knots = {0.5, 1.0};
  EXPECT_EQ(message(bad), "must have interior knots between 0 and 1, got 1");
  bad.inner_knots = {0.5, 0.4};
  EXPECT_EQ(message(bad), "must have ascending knots, got 0.4");
  bad = {1, {{0, 1}, {1, 1}, {1, 0}, {2, 0}}, {0.5, 0.5}};
  EXPECT_EQ(message(bad), "must repeat no interior knot more often than its degree, got 0.5");
  bad = good;
  bad.degree = 5;
  EXPECT_EQ(message(bad), "must have more points than its degree, got 5");
}

TEST(CheckProfile, NamesTheRuleThatIsBroken) {
  EXPECT_FALSE(check_profile("p", std::vector<Vec2>{{0, 1}, {1, 0}}));
  EXPECT_NE(check_profile("p", std::vector<Vec2>{{0, 1}, {-1, 0}})->message.find("radii >= 0"), std::string::npos);
  EXPECT_TRUE(check_profile("p", std::vector<Vec2>{{0, 1}, {0, 0}}));
  EXPECT_TRUE(check_profile("p", std::vector<Vec2>{{1, 1}, {1, 1}}));
  EXPECT_TRUE(check_profile("p", std::vector<Vec2>{{1, 1}, {1, std::numeric_limits<double>::infinity()}}));
}

}  // namespace
}  // namespace anthesis
