#include "anthesis/base/check.h"

#include <gtest/gtest.h>

#include <limits>

namespace anthesis {
namespace {

TEST(Check, RangesIncludeTheirEndsAndNothingThatIsNoNumber) {
  EXPECT_FALSE(check_number("x", 0.0, 0.0, 1.0));
  EXPECT_FALSE(check_number("x", 1.0, 0.0, 1.0));
  EXPECT_EQ(to_string(*check_number("x", 1.5, 0.0, 1.0)), "x must be in [0, 1], got 1.5");
  EXPECT_TRUE(check_number("x", std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0));
  EXPECT_TRUE(check_number("x", std::numeric_limits<double>::infinity(), 0.0, 1.0));
  EXPECT_TRUE(check_whole("n", 0, 1, 64));
}

TEST(Check, RangesOfIndividualsRunUpwards) {
  EXPECT_FALSE(check_range("r", {0.5, 0.5}, 0.0, 1.0));
  EXPECT_EQ(to_string(*check_range("r", {0.9, 0.1}, 0.0, 1.0)), "r must run from low to high, got 0.9 to 0.1");
  EXPECT_TRUE(check_range("r", {0.1, 1.1}, 0.0, 1.0));
}

}  // namespace
}  // namespace anthesis
