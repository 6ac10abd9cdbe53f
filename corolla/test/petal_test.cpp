#include "anthesis/corolla/petal.h"

#include <gtest/gtest.h>

#include "anthesis/base/math.h"
#include "anthesis/geometry/bspline.h"

namespace anthesis {
namespace {

PetalPose upright_petal() {
  PetalPose pose;
  pose.stage = 1.0;
  pose.midrib_mm = {{1, 0}, {1.2, 3}, {2, 6}, {4, 8}, {7, 9}};
  pose.half_width_mm = {0.5, 1.0, 2.0, 1.5, 0.2};
  pose.sections = {{{0, 0, 0}, {0.5, 0.1, 0}, {1, 0.4, 0.1}}};
  return pose;
}

TEST(ControlMesh, IsBilaterallySymmetric) {
  const ControlMesh mesh = control_mesh(upright_petal(), 3);
  EXPECT_EQ(mesh.along, 5);
  EXPECT_EQ(mesh.across, 5);
  for (int j = 0; j < mesh.along; ++j) {
    EXPECT_EQ(mesh.at(j, 2).y, 0.0);
    for (int i = 0; i < mesh.across; ++i) {
      const Vec3 left = mesh.at(j, i);
      const Vec3 right = mesh.at(j, mesh.across - 1 - i);
      EXPECT_EQ(left, (Vec3{right.x, -right.y, right.z}));
    }
    EXPECT_GT(mesh.at(j, 0).y, 0.0);  // u = 0 is the left margin
  }
}

TEST(ControlMesh, SurfaceNormalIsOnTheUpperSide) {
  // An upright petal's upper side faces the axis of the flower, -x.
  const ControlMesh mesh = control_mesh(upright_petal(), 3);
  const Vec3 du = mesh.at(1, 3) - mesh.at(1, 1);
  const Vec3 dv = mesh.at(2, 2) - mesh.at(0, 2);
  EXPECT_LT(cross(du, dv).x, 0.0);
}

TEST(ControlMesh, DeviationsKeepTheLengthOfTheMidribAndSpareTheBud) {
  const ShapeDeviation deviation{.curl_rad = 0.5, .twist_rad = 0.6, .sway_rad = -0.3, .width = 1.2};
  PetalPose pose = upright_petal();
  const ControlMesh plain = control_mesh(pose, 3);
  const ControlMesh bent = control_mesh(pose, 3, deviation);
  EXPECT_GT(length(bent.at(4, 2) - plain.at(4, 2)), 1.0);
  for (int j = 0; j + 1 < plain.along; ++j) {
    EXPECT_NEAR(length(bent.at(j + 1, 2) - bent.at(j, 2)), length(plain.at(j + 1, 2) - plain.at(j, 2)), 1e-12);
  }
  EXPECT_LT(bent.at(4, 2).z, plain.at(4, 2).z);  // curled back: the tip is lower
  pose.stage = 0.0;
  EXPECT_EQ(control_mesh(pose, 3, deviation).points_mm, plain.points_mm);
}

TEST(HoldInSymmetryPlanes, NeighboursShareTheirMargin) {
  constexpr int kCount = 5;
  ControlMesh petal = control_mesh(upright_petal(), 3);
  const ControlMesh free = petal;
  hold_in_symmetry_planes(petal, kCount, 3);
  const auto [sine, cosine] = math::sin_cos(math::kTurnRad / kCount);
  for (int j = 0; j < petal.along; ++j) {
    const Vec3 right = petal.at(j, petal.across - 1);
    const Vec3 right_of_next{cosine * right.x - sine * right.y, sine * right.x + cosine * right.y, right.z};
    const double gap = length(right_of_next - petal.at(j, 0));
    if (j < 3) {
      EXPECT_NEAR(gap, 0.0, 1e-14);
      EXPECT_NEAR(std::atan2(petal.at(j, 0).y, petal.at(j, 0).x), math::kPi / kCount, 1e-14);
      EXPECT_EQ(petal.at(j, 0).z, free.at(j, 0).z);
    } else {
      EXPECT_GT(gap, 0.1);
      EXPECT_EQ(petal.at(j, 0), free.at(j, 0));
    }
  }
}

TEST(FusedUntil, IsWhereTheMarginStopsDependingOnFusedPointsAlone) {
  constexpr int kAlong = 7;
  constexpr int kDegree = 2;
  for (int fused = 0; fused <= kAlong; ++fused) {
    const double until = fused_until(kAlong, kDegree, fused);
    for (int i = 0; i <= 100; ++i) {
      const double v = i / 100.0;
      const BasisFunctions basis = clamped_basis(kAlong, kDegree, v);
      bool only_fused = true;
      for (int k = 0; k < basis.count; ++k) {
        only_fused = only_fused && (basis.first + k < fused || basis.weight[k] == 0.0);
      }
      EXPECT_EQ(v <= until, only_fused) << fused << " points, v = " << v;
    }
  }
}

}  // namespace
}  // namespace anthesis
