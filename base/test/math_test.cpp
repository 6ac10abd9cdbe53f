#include "anthesis/base/math.h"

#include <gtest/gtest.h>

#include <cmath>

namespace anthesis {
namespace {

TEST(Math, AgreesWithTheCLibraryToTheLastPlaces) {
  for (int i = -1000; i <= 1000; ++i) {
    const double x = 0.0137 * i;
    EXPECT_NEAR(math::sin(x), std::sin(x), 4e-16);
    EXPECT_NEAR(math::cos(x), std::cos(x), 4e-16);
    EXPECT_NEAR(math::sin_cos(x).sin, std::sin(x), 4e-16);
    EXPECT_NEAR(math::sin_cos(x).cos, std::cos(x), 4e-16);
    EXPECT_NEAR(math::exp(x), std::exp(x), 4e-16 * std::exp(x));
    EXPECT_NEAR(math::atan2(x, 1.7), std::atan2(x, 1.7), 4e-16);
    if (i > 0) {
      EXPECT_NEAR(math::log(x), std::log(x), 4e-16 * std::abs(std::log(x)) + 1e-18);
      EXPECT_NEAR(math::pow(x, 1.3), std::pow(x, 1.3), 1e-15 * std::pow(x, 1.3));
    }
  }
  EXPECT_NEAR(math::acos(0.3), std::acos(0.3), 4e-16);
  EXPECT_NEAR(math::asin(0.3), std::asin(0.3), 4e-16);
  EXPECT_NEAR(math::tan(0.3), std::tan(0.3), 4e-16);
}

/// Bits of this very function table, equal on every x86-64 processor: run it also with the processor's FMA hidden
/// (GLIBC_TUNABLES), as the end-to-end tests do.
TEST(Math, HasTheSameBitsEverywhere) {
  EXPECT_EQ(math::sin(1e5), 0x1.24daa9c527e96p-5);
  EXPECT_EQ(math::exp(1.0), 0x1.5bf0a8b14576ap+1);
  EXPECT_EQ(math::atan2(3.0, -7.0), 0x1.5e4c36ca0118ap+1);
}

TEST(Math, RoundsToOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(math::round_down_to_125(1.0), 1.0);
  EXPECT_DOUBLE_EQ(math::round_down_to_125(1.99), 1.0);
  EXPECT_DOUBLE_EQ(math::round_down_to_125(4.9), 2.0);
  EXPECT_DOUBLE_EQ(math::round_down_to_125(9.99), 5.0);
  EXPECT_DOUBLE_EQ(math::round_down_to_125(0.0041), 0.002);
  EXPECT_DOUBLE_EQ(math::round_down_to_125(7e8), 5e8);
  EXPECT_DOUBLE_EQ(math::round_up_to_125(1.0), 1.0);
  EXPECT_DOUBLE_EQ(math::round_up_to_125(1.01), 2.0);
  EXPECT_DOUBLE_EQ(math::round_up_to_125(2.1), 5.0);
  EXPECT_DOUBLE_EQ(math::round_up_to_125(5.1), 10.0);
  EXPECT_DOUBLE_EQ(math::round_up_to_125(0.0021), 0.005);
  EXPECT_DOUBLE_EQ(math::round_up_to_125(0.1 + 0.1 + 0.3), 0.5);
  for (double value = 1e-7; value < 1e7; value *= 1.37) {
    const double down = math::round_down_to_125(value);
    const double up = math::round_up_to_125(value);
    EXPECT_LE(down, value);
    EXPECT_LT(value, 2.5 * down * (1.0 + 1e-12));
    EXPECT_GE(up, value * (1.0 - 1e-9));
    EXPECT_DOUBLE_EQ(math::round_up_to_125(down), down);
  }
}

}  // namespace
}  // namespace anthesis
