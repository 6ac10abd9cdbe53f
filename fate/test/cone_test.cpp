#include "anthesis/fate/cone.h"

#include <gtest/gtest.h>

#include <map>

#include "anthesis/base/math.h"
#include "anthesis/base/random.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {
namespace {

std::vector<Vec2> vogel_disc(std::size_t florets) {
  std::vector<Vec2> centres(florets);
  place_spiral({}, centres);
  return centres;
}

/// Equations 4 and 5 over all pairs, with the inequality the right way round.
double nearest_by_all_pairs(const std::vector<Vec2>& florets, std::size_t i, Vec2 centre, double cone_rad) {
  double nearest = std::numeric_limits<double>::infinity();
  const Vec2 outward = normalized(florets[i] - centre);
  for (std::size_t j = 0; j < florets.size(); ++j) {
    const Vec2 to = florets[j] - florets[i];
    if (j != i && dot(normalized(to), outward) > math::cos(cone_rad)) {
      nearest = std::min(nearest, length(to));
    }
  }
  return nearest;
}

TEST(NearestInCone, IsWhatAllPairsGive) {
  Rng rng(8, 0, RandomPurpose::kTest);
  std::vector<Vec2> florets(400);
  for (Vec2& p : florets) {
    p = {rng.normal(), rng.normal()};
  }
  const Vec2 centre{0.2, -0.1};
  for (const double cone_deg : {5.0, 45.0, 89.0, 90.0, 120.0, 175.0}) {
    const auto found = nearest_in_cone_mm(florets, centre, math::radians(cone_deg));
    for (std::size_t i = 0; i < florets.size(); ++i) {
      EXPECT_EQ(found[i], nearest_by_all_pairs(florets, i, centre, math::radians(cone_deg))) << cone_deg << " " << i;
    }
  }
}

TEST(CountWithRoom, WidthOfTheConeCanalizesToFibonacciNumbers) {
  // O16 fig. 16: n = 82. Plateaus of 34, 21 and 13 rays over wide ranges of the angle.
  const std::vector<Vec2> florets = vogel_disc(82);
  const auto rays = [&](double cone_deg) { return count_with_room(florets, {}, math::radians(cone_deg)); };
  for (double cone_deg = 20.0; cone_deg <= 38.0; cone_deg += 0.5) {
    EXPECT_EQ(rays(cone_deg), 34u) << cone_deg;
  }
  for (double cone_deg = 47.0; cone_deg <= 71.0; cone_deg += 0.5) {
    EXPECT_EQ(rays(cone_deg), 21u) << cone_deg;
  }
  for (double cone_deg = 77.0; cone_deg <= 89.0; cone_deg += 0.5) {
    EXPECT_EQ(rays(cone_deg), 13u) << cone_deg;
  }
}

TEST(CountWithRoom, SizeOfTheHeadCanalizesToFibonacciNumbers) {
  // O16 fig. 15: alpha = 75 degrees. Most head sizes have 13, 21 or 34 rays, in that order.
  std::map<std::size_t, int> sizes;
  std::size_t before = 0;
  for (std::size_t n = 20; n <= 400; ++n) {
    const std::size_t rays = count_with_room(vogel_disc(n), {}, math::radians(75.0));
    EXPECT_GE(rays, before) << n;
    before = rays;
    ++sizes[rays];
  }
  EXPECT_GE(sizes[13], 50);
  EXPECT_GE(sizes[21], 140);
  EXPECT_GE(sizes[34], 140);
  EXPECT_GE(sizes[13] + sizes[21] + sizes[34], 345);  // nine in ten of the 381 sizes
}

TEST(CountWithRoom, TheLucasAngleCanalizesToLucasNumbers) {
  // 99.502 degrees belongs to 1, 3, 4, 7, 11, 18, 29: the plateaus are the pattern's doing, not the counter's.
  std::vector<Vec2> florets(82);
  place_spiral({.spacing_mm = 1.0, .divergence_rad = math::radians(99.502)}, florets);
  for (double cone_deg = 30.0; cone_deg <= 50.0; cone_deg += 0.5) {
    EXPECT_EQ(count_with_room(florets, {}, math::radians(cone_deg)), 29u) << cone_deg;
  }
  for (double cone_deg = 58.0; cone_deg <= 80.0; cone_deg += 0.5) {
    EXPECT_EQ(count_with_room(florets, {}, math::radians(cone_deg)), 18u) << cone_deg;
  }
  for (double cone_deg = 83.0; cone_deg <= 88.0; cone_deg += 0.5) {
    EXPECT_EQ(count_with_room(florets, {}, math::radians(cone_deg)), 11u) << cone_deg;
  }
}

TEST(NearestInCone, AFloretOnTheCentreSeesEveryDirection) {
  const std::vector<Vec2> florets = {{0, 0}, {-3, 0}, {0, 5}};
  EXPECT_EQ(nearest_in_cone_mm(florets, {}, 0.1)[0], 3.0);
}

}  // namespace
}  // namespace anthesis
