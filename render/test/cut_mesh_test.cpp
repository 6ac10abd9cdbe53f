#include "../src/cut_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/render/scene.h"

namespace anthesis {
namespace {

LabelledMesh ball() {
  LabelledMesh ball{unit_sphere(), {}};
  ball.mesh.uvs.clear();
  ball.labels.assign(ball.mesh.positions_mm.size(), 1);
  return ball;
}

double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += dot(mesh.positions_mm[a], cross(mesh.positions_mm[b], mesh.positions_mm[c])) / 6.0;
  }
  return sum;
}

double area(std::span<const Vec2> polygon, const std::vector<Triangle>& triangles) {
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles) {
    sum += 0.5 * cross(polygon[b] - polygon[a], polygon[c] - polygon[a]);
  }
  return sum;
}

TEST(CutMesh, TheTwoPartsOfABallHaveItsVolume) {
  const LabelledMesh whole = ball();
  const Vec3 normal = normalized(Vec3{0.3, -0.5, 0.7});
  for (const double distance : {-0.7, 0.0, 0.31}) {
    const LabelledMesh kept = cut(whole, {normal, distance});
    const LabelledMesh gone = cut(whole, {-normal, -distance});
    EXPECT_NEAR(volume(kept.mesh) + volume(gone.mesh), volume(whole.mesh), 1e-12);
    const double height = 1.0 + distance;
    EXPECT_NEAR(volume(kept.mesh), math::kPi * height * height * (3.0 - height) / 3.0, 0.04);
  }
}

TEST(CutMesh, LeavesNothingBeyondThePlaneAndKeepsWhatIsBefore) {
  const LabelledMesh whole = ball();
  const LabelledMesh kept = cut(whole, {{1, 0, 0}, 0.2});
  ASSERT_EQ(kept.mesh.normals.size(), kept.mesh.positions_mm.size());
  ASSERT_EQ(kept.labels.size(), kept.mesh.positions_mm.size());
  std::size_t on_plane = 0;
  for (std::size_t i = 0; i < kept.mesh.positions_mm.size(); ++i) {
    EXPECT_LE(kept.mesh.positions_mm[i].x, 0.2 + 1e-12);
    EXPECT_NEAR(length(kept.mesh.normals[i]), 1.0, 1e-12);
    on_plane += std::abs(kept.mesh.positions_mm[i].x - 0.2) < 1e-12 ? 1 : 0;
  }
  EXPECT_GT(on_plane, 40U);
  EXPECT_EQ(cut(whole, {{1, 0, 0}, 2.0}).mesh.triangles.size(), whole.mesh.triangles.size());
  EXPECT_TRUE(cut(whole, {{1, 0, 0}, -2.0}).mesh.triangles.empty());
}

TEST(TriangulatePolygon, FillsAPolygonThatIsNotConvex) {
  std::vector<Vec2> star;
  for (int i = 0; i < 40; ++i) {
    const double angle = math::kTurnRad * i / 40.0;
    star.push_back((i % 2 == 0 ? 1.0 : 0.3) * Vec2{math::cos(angle), math::sin(angle)});
  }
  const std::vector<Triangle> triangles = triangulate_polygon(star);
  EXPECT_EQ(triangles.size(), star.size() - 2);
  EXPECT_NEAR(area(star, triangles), 20.0 * 1.0 * 0.3 * math::sin(math::kTurnRad / 40.0), 1e-12);
  for (const Triangle& t : triangles) {
    EXPECT_GE(area(star, {t}), 0.0);
  }
}

TEST(TriangulatePolygon, ComesToAnEndWithOnesThatCrossThemselves) {
  const std::vector<Vec2> bow = {{0, 0}, {2, 2}, {2, 0}, {0, 2}, {-1, 1}};
  EXPECT_EQ(triangulate_polygon(bow).size(), 3U);
  EXPECT_TRUE(triangulate_polygon(std::vector<Vec2>{{0, 0}, {1, 0}}).empty());
}

}  // namespace
}  // namespace anthesis
