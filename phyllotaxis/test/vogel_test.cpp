#include "anthesis/phyllotaxis/vogel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

/// Least distance among 500 florets at the given divergence angle, spacing 1.
double closest_pair(double divergence_rad) {
  std::vector<Vec2> centres(500);
  place_spiral({.spacing_mm = 1.0, .divergence_rad = divergence_rad}, centres);
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < centres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      closest = std::min(closest, length(centres[i] - centres[j]));
    }
  }
  return closest;
}

TEST(PlaceSpiral, DiscOfRadiusSqrtNHoldsTheFirstNFlorets) {
  const SpiralParams params{.spacing_mm = 0.75};
  std::vector<Vec2> centres(500);
  place_spiral(params, centres);
  for (const std::ptrdiff_t n : {1, 2, 89, 144, 499}) {
    const double rim_mm = params.spacing_mm * std::sqrt(static_cast<double>(n));
    EXPECT_EQ(std::ranges::count_if(centres, [&](Vec2 c) { return length(c) < rim_mm; }), n);
  }
}

TEST(PlaceSpiral, GoldenAngleKeepsNeighboursApartAndATenthOfADegreeSpoilsIt) {
  EXPECT_GT(closest_pair(kGoldenAngleRad), 1.5);
  EXPECT_LT(closest_pair(math::radians(137.6)), 1.0);
}

TEST(CheckSpiral, NamesTheFieldAndTheValue) {
  const std::optional<Error> error = check(SpiralParams{.spacing_mm = -0.4});
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->where, "spacing_mm");
  EXPECT_EQ(error->message, "must be finite and > 0, got -0.4");
}

}  // namespace
}  // namespace anthesis
