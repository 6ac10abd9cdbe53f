#include "anthesis/geometry/delaunay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "anthesis/base/random.h"

namespace anthesis {
namespace {

double signed_area(const std::vector<Vec2>& p, const Triangle& t) {
  return 0.5 * cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
}

/// > 0 when d lies inside the circle through counter-clockwise a, b, c.
double in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const Vec2 p = a - d;
  const Vec2 q = b - d;
  const Vec2 r = c - d;
  return dot(p, p) * cross(q, r) - dot(q, q) * cross(p, r) + dot(r, r) * cross(p, q);
}

TEST(Delaunay, CirclesOfRandomPointsAreEmptyAndTheSquareIsCovered) {
  Rng rng(5, 0, RandomPurpose::kTest);
  std::vector<Vec2> points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int i = 0; i < 100; ++i) {
    points.push_back({rng.uniform(), rng.uniform()});
  }
  double area = 0.0;
  for (const Triangle& t : delaunay(points)) {
    EXPECT_GT(signed_area(points, t), 0.0);
    area += signed_area(points, t);
    for (const Vec2 p : points) {
      EXPECT_LE(in_circle(points[t[0]], points[t[1]], points[t[2]], p), 1e-8);
    }
  }
  EXPECT_NEAR(area, 1.0, 1e-12);
}

TEST(Delaunay, GridIsMirroredInItsMiddleLine) {
  // Every cell of a grid has four points on one circle: the choice of diagonal must respect the symmetry.
  std::vector<Vec2> points;
  for (int j = 0; j <= 4; ++j) {
    for (int i = 0; i <= 4; ++i) {
      points.push_back({i / 4.0, j / 4.0});
    }
  }
  const std::vector<Triangle> triangles = delaunay(points);
  EXPECT_EQ(triangles.size(), 32u);
  std::set<std::set<std::uint32_t>> here;
  std::set<std::set<std::uint32_t>> mirrored;
  for (const Triangle& t : triangles) {
    std::set<std::uint32_t> image;
    for (const std::uint32_t index : t) {
      image.insert(index / 5 * 5 + (4 - index % 5));
    }
    here.insert({t[0], t[1], t[2]});
    mirrored.insert(image);
  }
  EXPECT_EQ(here, mirrored);
}

TEST(Delaunay, TooFewOrCollinearPointsGiveNothing) {
  EXPECT_TRUE(delaunay(std::vector<Vec2>{}).empty());
  EXPECT_TRUE(delaunay(std::vector<Vec2>{{0, 0}, {1, 1}}).empty());
  EXPECT_TRUE(delaunay(std::vector<Vec2>{{0, 0}, {0.5, 0.5}, {1, 1}}).empty());
}

}  // namespace
}  // namespace anthesis
