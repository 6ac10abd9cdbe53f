#include "../src/sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace anthesis {
namespace {

/// Every box of area 1/n whose sides are powers of two holds exactly one of the first n points, which is what makes few
/// samples spread evenly.
void expect_one_point_in_each_box(std::uint32_t pixel, int dimension, int bits) {
  const std::uint32_t count = 1U << bits;
  for (int across_bits = 0; across_bits <= bits; ++across_bits) {
    const auto across = static_cast<float>(1 << across_bits);
    const auto down = static_cast<float>(1 << (bits - across_bits));
    std::vector<bool> filled(count);
    for (std::uint32_t s = 0; s < count; ++s) {
      Sampler sampler(pixel, s);
      Sampler::Pair pair = sampler.next();
      for (int skip = 0; skip < dimension; ++skip) {
        pair = sampler.next();
      }
      filled[static_cast<std::size_t>(pair.x * across) * static_cast<std::size_t>(down) +
             static_cast<std::size_t>(pair.y * down)] = true;
    }
    EXPECT_EQ(std::ranges::count(filled, true), count) << pixel << ' ' << dimension << ' ' << across;
  }
}

TEST(Sampler, EveryElementaryBoxHoldsOnePoint) {
  for (const std::uint32_t pixel : {0U, 1U, 123456U}) {
    for (int dimension = 0; dimension < 6; ++dimension) {
      expect_one_point_in_each_box(pixel, dimension, 4);
      expect_one_point_in_each_box(pixel, dimension, 8);
    }
  }
  expect_one_point_in_each_box(7, 0, 16);  // the most samples a picture may have
}

TEST(Sampler, PairsOfOneSampleAndNeighbouringPixelsAreUnrelated) {
  double between_pairs = 0.0;
  double between_pixels = 0.0;
  constexpr int kCount = 4096;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    Sampler here(i, 5);
    Sampler there(i + 1, 5);
    const auto a = here.next();
    const auto b = here.next();
    const auto c = there.next();
    between_pairs += (a.x - 0.5) * (b.x - 0.5);
    between_pixels += (a.x - 0.5) * (c.x - 0.5);
  }
  EXPECT_NEAR(between_pairs / kCount, 0.0, 0.006);  // a correlation of one would be 1/12
  EXPECT_NEAR(between_pixels / kCount, 0.0, 0.006);
}

}  // namespace
}  // namespace anthesis
