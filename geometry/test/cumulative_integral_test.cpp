#include "anthesis/geometry/cumulative_integral.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

TEST(CumulativeIntegral, OfTheCosineIsTheSine) {
  const std::array<double, 2> breaks = {0.0, 0.5 * math::kPi};
  const CumulativeIntegral integral([](double x) { return math::cos(x); }, breaks);
  EXPECT_NEAR(integral.total(), 1.0, 1e-14);
  for (int i = 0; i <= 50; ++i) {
    const double x = breaks[1] * i / 50;
    EXPECT_NEAR(integral.at(x), math::sin(x), 1e-14);
    EXPECT_NEAR(integral.at(integral.inverse(i / 50.0)), i / 50.0, 1e-14);
  }
}

TEST(CumulativeIntegral, ShortStretchesAreAsAccurateAsLongOnes) {
  // A million steps of e^x: each must be right by itself, not only the sum.
  const std::array<double, 2> breaks = {0.0, 3.0};
  const CumulativeIntegral integral([](double x) { return math::exp(x); }, breaks);
  for (int i = 0; i < 1'000'000; i += 9973) {
    const double a = 3e-6 * i;
    const double exact = math::exp(a) * std::expm1(3e-6);
    EXPECT_NEAR((integral.at(a + 3e-6) - integral.at(a)) / exact, 1.0, 1e-9);
  }
}

TEST(CumulativeIntegral, CornersInsideAPieceAreFound) {
  const std::array<double, 2> breaks = {-1.0, 2.0};
  const CumulativeIntegral integral([](double x) { return std::abs(x - 0.3137); }, breaks);
  EXPECT_NEAR(integral.total(), 0.5 * (1.3137 * 1.3137 + 1.6863 * 1.6863), 1e-12);
}

TEST(CumulativeIntegral, InverseIsClampedToTheEnds) {
  const std::array<double, 3> breaks = {0.0, 1.0, 2.0};
  const CumulativeIntegral integral([](double) { return 2.0; }, breaks);
  EXPECT_EQ(integral.inverse(-1.0), 0.0);
  EXPECT_EQ(integral.inverse(5.0), 2.0);
  EXPECT_NEAR(integral.inverse(3.0), 1.5, 1e-15);
}

}  // namespace
}  // namespace anthesis
