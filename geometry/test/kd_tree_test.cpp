#include "anthesis/geometry/kd_tree.h"

#include <gtest/gtest.h>

#include "anthesis/base/random.h"

namespace anthesis {
namespace {

TEST(KdTree2, FindsTheNearestAcceptablePointAsAllPairsDo) {
  Rng rng(4, 0, RandomPurpose::kTest);
  std::vector<Vec2> points(500);
  for (Vec2& p : points) {
    p = {rng.uniform(), rng.uniform()};
  }
  points[17] = points[3];  // coincident points must not confuse it
  const KdTree2 tree(points);
  for (int query = 0; query < 300; ++query) {
    const Vec2 from{rng.uniform(-0.5, 1.5), rng.uniform(-0.5, 1.5)};
    const double edge = rng.uniform();
    const auto accept = [&](std::uint32_t i) { return points[i].x > edge; };
    std::optional<std::uint32_t> best;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (accept(i) && (!best || length(points[i] - from) < length(points[*best] - from))) {
        best = i;
      }
    }
    const auto found = tree.nearest(from, accept, [&](const Box2& box) { return box.high.x > edge; });
    ASSERT_EQ(found.has_value(), best.has_value());
    if (best) {
      EXPECT_EQ(found->index, *best);
      EXPECT_EQ(found->distance, length(points[*best] - from));
    }
  }
}

TEST(KdTree2, NoPointsNoNeighbour) {
  const KdTree2 tree({});
  EXPECT_FALSE(tree.nearest(
      {}, [](std::uint32_t) { return true; }, [](const Box2&) { return true; }));
}

TEST(KdTree2, VisitsFewPointsOfMany) {
  std::vector<Vec2> points;
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) {
      points.push_back({static_cast<double>(i), static_cast<double>(j)});
    }
  }
  const KdTree2 tree(points);
  int looked_at = 0;
  const auto accept = [&](std::uint32_t) {
    ++looked_at;
    return true;
  };
  tree.nearest({41.2, 57.9}, accept, [](const Box2&) { return true; });
  EXPECT_LT(looked_at, 100);
}

}  // namespace
}  // namespace anthesis
