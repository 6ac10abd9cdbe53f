#include "anthesis/corolla/surface_follower.h"

#include <gtest/gtest.h>

#include <cmath>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

/// Three pointed petals, their first `fused` boundary points in common, and a style that ends in a point.
OrganShape flower(int fused) {
  Petals petals;
  petals.name = "corolla";
  petals.count = 3;
  petals.fused = fused;
  petals.spacing = {{0, 0.2}, {1, 0.2}};
  petals.vertices = {{0, 3}, {0.8, 4}, {1, 1}};
  const auto pose = [](double stage, std::vector<Vec2> midrib) {
    PetalPose result;
    result.stage = stage;
    result.midrib_mm = std::move(midrib);
    result.half_width_mm = {0.6, 0.8, 1.2, 1.0, 0.0};
    result.sections = {{{0, 0, 0}, {0.5, 0.06, 0}, {1, 0.325, 0}}};
    return result;
  };
  petals.poses = {pose(0, {{1, 0}, {1, 2}, {1, 4}, {0.9, 6}, {0.5, 8}}),
                  pose(1, {{1, 0}, {1, 2}, {2, 4}, {4, 5}, {6, 5}})};
  Column style;
  style.name = "style";
  style.poses = {{.stage = 0.0, .profile_mm = {{0.2, 0}, {0.2, 2}, {0.3, 4}, {0, 5}}, .lean_deg = 10.0}};
  OrganShape shape;
  shape.petals = {petals};
  shape.columns = {style};
  return shape;
}

OrganTemplate flower_at(double detail, int fused = 3) {
  return *OrganTemplate::build(flower(fused), detail, 1, 0);
}

std::vector<Vec3> posed(const OrganTemplate& organ, double stage) {
  std::vector<Vec3> positions_mm(organ.vertex_count());
  std::vector<Vec3> normals(organ.vertex_count());
  organ.pose(stage, positions_mm, normals);
  return positions_mm;
}

TEST(SurfaceFollower, StaysExactlyWhereItIsIfNothingWasBent) {
  const OrganTemplate coarse = flower_at(1.0);
  for (const double detail : {0.5, 1.0, 2.0, 3.7}) {
    const OrganTemplate fine = flower_at(detail);
    const SurfaceFollower follower(coarse, fine);
    const std::vector<Vec3> rest_mm = posed(coarse, 0.6);
    std::vector<Vec3> fine_mm = posed(fine, 0.6);
    follower.follow(rest_mm, rest_mm, fine_mm);
    EXPECT_EQ(fine_mm, posed(fine, 0.6)) << detail;
  }
}

TEST(SurfaceFollower, MovesAsARigidBodyWithARigidBody) {
  const OrganTemplate coarse = flower_at(1.0);
  const OrganTemplate fine = flower_at(2.5);
  const SurfaceFollower follower(coarse, fine);
  for (const double angle_deg : {1.0, 90.0, 179.0}) {
    const Placement motion{
        {3.0, -20.0, 50.0}, rotation_about(normalized(Vec3{1.0, 2.0, -0.5}), math::radians(angle_deg)), 1.0};
    const std::vector<Vec3> rest_mm = posed(coarse, 0.6);
    std::vector<Vec3> bent_mm;
    for (const Vec3 p : rest_mm) {
      bent_mm.push_back(apply(motion, p));
    }
    const std::vector<Vec3> fine_rest_mm = posed(fine, 0.6);
    std::vector<Vec3> fine_mm = fine_rest_mm;
    follower.follow(rest_mm, bent_mm, fine_mm);
    for (std::size_t i = 0; i < fine_mm.size(); ++i) {
      ASSERT_LT(length(fine_mm[i] - apply(motion, fine_rest_mm[i])), 1e-9) << i << " at " << angle_deg;
    }
  }
}

TEST(SurfaceFollower, FollowsASmoothBendToAFewHundredthsOfIt) {
  // The whole flower bent along x: a plane z = const becomes a cylinder about the axis x = 0, z = 20.
  const double radius_mm = 20.0;
  const auto bend = [&](Vec3 p) {
    const auto [s, c] = math::sin_cos(p.x / radius_mm);
    return Vec3{(radius_mm - p.z) * s, p.y, radius_mm - (radius_mm - p.z) * c};
  };
  const OrganTemplate coarse = flower_at(1.0);
  const OrganTemplate fine = flower_at(4.0);
  const std::vector<Vec3> rest_mm = posed(coarse, 1.0);
  std::vector<Vec3> bent_mm;
  double largest_mm = 0.0;
  for (const Vec3 p : rest_mm) {
    bent_mm.push_back(bend(p));
    largest_mm = std::max(largest_mm, length(bent_mm.back() - p));
  }
  const std::vector<Vec3> fine_rest_mm = posed(fine, 1.0);
  std::vector<Vec3> fine_mm = fine_rest_mm;
  SurfaceFollower(coarse, fine).follow(rest_mm, bent_mm, fine_mm);
  double off_mm = 0.0;
  for (std::size_t i = 0; i < fine_mm.size(); ++i) {
    off_mm = std::max(off_mm, length(fine_mm[i] - bend(fine_rest_mm[i])));
  }
  EXPECT_GT(largest_mm, 1.0);
  EXPECT_LT(off_mm, 0.025 * largest_mm);
}

TEST(SurfaceFollower, RowsBentIntoAnArcStayAnArcBetweenThem) {
  // A flat strap 8 mm long, five rows of facets, rolled on a cylinder of 10 mm: chords cut the arc by h^2 / (8 r).
  Petals strap;
  strap.name = "strap";
  strap.spacing = {{0, 0.2}, {1, 0.2}};
  strap.poses.resize(1);
  strap.poses[0].midrib_mm = {{0, 0}, {2, 0}, {4, 0}, {6, 0}, {8, 0}};
  strap.poses[0].half_width_mm = {1, 1, 1, 1, 1};
  OrganShape shape;
  shape.petals = {strap};
  const OrganTemplate coarse = *OrganTemplate::build(shape, 1.0, 1, 0);
  const OrganTemplate fine = *OrganTemplate::build(shape, 6.0, 1, 0);
  constexpr double kRadius_mm = 10.0;
  const auto roll = [&](Vec3 p) {
    const auto [s, c] = math::sin_cos(p.x / kRadius_mm);
    return Vec3{kRadius_mm * s, p.y, kRadius_mm * (1.0 - c)};
  };
  const std::vector<Vec3> rest_mm = posed(coarse, 0.0);
  std::vector<Vec3> bent_mm;
  double chord_mm = 0.0;  // the longest
  for (const Vec3 p : rest_mm) {
    ASSERT_EQ(p.z, 0.0);
    bent_mm.push_back(roll(p));
  }
  for (const Triangle& t : coarse.triangles()) {
    chord_mm = std::max(chord_mm, std::abs(rest_mm[t[1]].x - rest_mm[t[0]].x));
  }
  std::vector<Vec3> fine_mm = posed(fine, 0.0);
  SurfaceFollower(coarse, fine).follow(rest_mm, bent_mm, fine_mm);
  const double cut_mm = chord_mm * chord_mm / (8.0 * kRadius_mm);
  EXPECT_GT(cut_mm, 0.02);
  for (std::size_t i = 0; i < fine_mm.size(); ++i) {
    // At the ends of the strap the surface turns on one side only, and part of the cut stays.
    const bool inner = fine.uvs()[i].y > 0.2 && fine.uvs()[i].y < 0.8;
    const double off_mm = std::abs(std::hypot(fine_mm[i].x, kRadius_mm - fine_mm[i].z) - kRadius_mm);
    EXPECT_LT(off_mm, (inner ? 0.2 : 0.9) * cut_mm) << fine.uvs()[i].x << " " << fine.uvs()[i].y;
  }
}

TEST(SurfaceFollower, KeepsFusedMarginsClosed) {
  const OrganTemplate coarse = flower_at(1.0, 4);
  const OrganTemplate fine = flower_at(3.0, 4);
  const std::vector<Vec3> rest_mm = posed(coarse, 0.6);
  std::vector<Vec3> bent_mm = rest_mm;
  for (Vec3& p : bent_mm) {
    p.x += 0.3 * math::sin_cos(3.0 * p.z + p.y).sin;
  }
  for (std::size_t i = 0; i < bent_mm.size(); ++i) {
    bent_mm[i] = bent_mm[coarse.twins()[i]];
  }
  std::vector<Vec3> fine_mm = posed(fine, 0.6);
  SurfaceFollower(coarse, fine).follow(rest_mm, bent_mm, fine_mm);
  int joined = 0;
  for (std::size_t i = 0; i < fine_mm.size(); ++i) {
    EXPECT_EQ(fine_mm[i], fine_mm[fine.twins()[i]]);
    joined += fine.twins()[i] != i ? 1 : 0;
  }
  EXPECT_GT(joined, 10);
}

}  // namespace
}  // namespace anthesis
