#include "anthesis/geometry/function_graph.h"

#include <gtest/gtest.h>

#include <limits>

namespace anthesis {
namespace {

TEST(FunctionGraph, TwoPointsAreALine) {
  const FunctionGraph line({{1.0, 3.0}, {2.0, 7.0}});
  EXPECT_NEAR(line(1.25), 4.0, 1e-14);
  EXPECT_EQ(line(0.0), 3.0);
  EXPECT_EQ(line(9.0), 7.0);
}

TEST(FunctionGraph, LiesOnItsCurve) {
  const std::vector<Vec2> points = {{0.0, 0.0}, {0.1, 2.0}, {0.1, 2.5}, {0.7, -1.0}, {1.0, 1.0}};
  const FunctionGraph graph(points);
  const BSplineCurve<Vec2> curve{3, points};
  for (int i = 0; i <= 200; ++i) {
    const Vec2 p = curve.at(i / 200.0);
    EXPECT_NEAR(graph(p.x), p.y, 1e-11);
  }
}

TEST(CheckFunction, RefusesWhatIsNoFunction) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(check_function("f", std::vector<Vec2>{{0, 0}, {1, 1}}));
  EXPECT_TRUE(check_function("f", std::vector<Vec2>{{0, 0}}));
  EXPECT_TRUE(check_function("f", std::vector<Vec2>{{0, 0}, {0, 1}}));
  EXPECT_TRUE(check_function("f", std::vector<Vec2>{{0, 0}, {2, 1}, {1, 1}}));
  EXPECT_TRUE(check_function("f", std::vector<Vec2>{{0, nan}, {1, 1}}));
}

}  // namespace
}  // namespace anthesis
