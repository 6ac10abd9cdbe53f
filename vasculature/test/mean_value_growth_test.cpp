#include "anthesis/vasculature/mean_value_growth.h"

#include <gtest/gtest.h>

#include "anthesis/base/parallel.h"
#include "anthesis/base/random.h"

namespace anthesis {
namespace {

/// A pear, and the same after each point has moved by `displacement(point)`.
template <class Displacement>
OutlineSequence pear(Displacement displacement) {
  OutlineSequence outlines;
  const std::vector<Vec2> young = {{0.0, 2.0}, {0.5, 1.9}, {0.9, 1.5}, {1.0, 1.1}, {0.8, 0.6}, {0.45, 0.3}, {0.4, 0.0}};
  outlines.points_per_frame = young.size();
  outlines.points = young;
  for (const Vec2 p : young) {
    outlines.points.push_back(p + displacement(p));
  }
  return outlines;
}

std::vector<Vec2> inner_points() {
  return {{0.0, 1.0}, {1e-9, 0.5}, {0.2, 0.1}, {0.3, 1.8}, {0.6, 1.2}, {0.85, 1.1}, {0.999, 1.1}, {0.1, 1e-7}};
}

TEST(MeanValueGrowth, CarriesEverythingAlongWithAShift) {
  const HeadGrowth growth = mean_value_growth(pear([](Vec2) { return Vec2{0.0, 0.25}; }));
  std::vector<Vec2> points = inner_points();
  growth.move(0, 1, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points[i].x, inner_points()[i].x, 1e-14);
    EXPECT_NEAR(points[i].y, inner_points()[i].y + 0.25, 1e-14);
  }
}

TEST(MeanValueGrowth, ReproducesAStretchAlongTheAxis) {  // linear data come out linear
  const HeadGrowth growth = mean_value_growth(pear([](Vec2 p) { return Vec2{0.0, 0.3 * p.y}; }));
  std::vector<Vec2> points = inner_points();
  growth.move(0, 1, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points[i].x, inner_points()[i].x, 1e-13);
    EXPECT_NEAR(points[i].y, 1.3 * inner_points()[i].y, 1e-13);
  }
}

TEST(MeanValueGrowth, KeepsPlacesOnTheOutline) {
  const OutlineSequence outlines = pear([](Vec2 p) { return Vec2{0.4 * p.x * p.y, 0.2 * p.y * p.y}; });
  const HeadGrowth growth = mean_value_growth(outlines);
  for (std::size_t i = 0; i + 1 < outlines.points_per_frame; ++i) {
    for (const double share : {0.0, 0.25, 0.6}) {
      Vec2 p = lerp(outlines.frame(0)[i], outlines.frame(0)[i + 1], share);
      growth.move(0, 1, {&p, 1});
      const Vec2 expected = lerp(outlines.frame(1)[i], outlines.frame(1)[i + 1], share);
      EXPECT_NEAR(p.x, expected.x, 1e-9) << i;
      EXPECT_NEAR(p.y, expected.y, 1e-9) << i;
    }
  }
  Vec2 on_base = {0.3, 0.0};  // three quarters of the way to the rim
  growth.move(0, 1, {&on_base, 1});
  EXPECT_NEAR(on_base.x, 0.75 * outlines.frame(1).back().x, 1e-12);
}

TEST(MeanValueGrowth, MovesAPointTheSameWhateverElseMoves) {
  const HeadGrowth growth = mean_value_growth(pear([](Vec2 p) { return Vec2{0.4 * p.x * p.y, 0.2 * p.y * p.y}; }));
  std::vector<Vec2> many;
  Rng rng(1, 1, RandomPurpose::kTest);
  for (int i = 0; i < 1003; ++i) {
    many.push_back({rng.uniform(0.0, 0.4), rng.uniform(0.0, 1.8)});
  }
  std::vector<Vec2> alone = many;
  growth.move(0, 1, many);
  for (Vec2& p : alone) {
    growth.move(0, 1, {&p, 1});
  }
  EXPECT_EQ(many, alone);
}

}  // namespace
}  // namespace anthesis
