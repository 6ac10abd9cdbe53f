#include "anthesis/base/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace anthesis {
namespace {

/// The published test vector of Philox 4x32-10: all zeros in.
TEST(Rng, IsPhilox) {
  Rng rng(0, 0, RandomPurpose{0});
  EXPECT_EQ(rng.bits(), 0x6627e8d5u);
  EXPECT_EQ(rng.bits(), 0xe169c58du);
  EXPECT_EQ(rng.bits(), 0xbc57ac4cu);
  EXPECT_EQ(rng.bits(), 0x9b00dbd8u);
}

TEST(Rng, AnotherSeedOrganOrPurposeIsAnotherStream) {
  const double base = Rng(1, 2, RandomPurpose::kTest).uniform();
  EXPECT_NE(base, Rng(2, 2, RandomPurpose::kTest).uniform());
  EXPECT_NE(base, Rng(1, 3, RandomPurpose::kTest).uniform());
  EXPECT_NE(base, Rng(1, 2, RandomPurpose::kCurl).uniform());
  EXPECT_EQ(base, Rng(1, 2, RandomPurpose::kTest).uniform());
}

TEST(Rng, NumbersHaveTheMomentsTheyShould) {
  Rng rng(7, 1, RandomPurpose::kTest);
  constexpr int kCount = 200'000;
  double sum = 0.0;
  double normal_sum = 0.0;
  double normal_squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double u = rng.uniform(2.0, 4.0);
    ASSERT_GE(u, 2.0);
    ASSERT_LT(u, 4.0);
    sum += u;
    const double n = rng.normal();
    normal_sum += n;
    normal_squares += n * n;
  }
  EXPECT_NEAR(sum / kCount, 3.0, 5.0 * 0.577 / std::sqrt(kCount));
  EXPECT_NEAR(normal_sum / kCount, 0.0, 5.0 / std::sqrt(kCount));
  EXPECT_NEAR(normal_squares / kCount, 1.0, 5.0 * std::sqrt(2.0 / kCount));
}

}  // namespace
}  // namespace anthesis
