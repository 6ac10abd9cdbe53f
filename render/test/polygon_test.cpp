#include "../src/polygon.h"

#include <gtest/gtest.h>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

double area(std::span<const Vec2> polygon, const std::vector<Triangle>& triangles) {
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles) {
    sum += 0.5 * cross(polygon[b] - polygon[a], polygon[c] - polygon[a]);
  }
  return sum;
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
