#include "sparse_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace anthesis {
namespace {

std::vector<UnknownPair> grid(std::uint32_t across, bool with_diagonals) {
  std::vector<UnknownPair> pairs;
  for (std::uint32_t j = 0; j < across; ++j) {
    for (std::uint32_t i = 0; i < across; ++i) {
      const std::uint32_t v = j * across + i;
      if (i + 1 < across) {
        pairs.push_back({v, v + 1});
      }
      if (j + 1 < across) {
        pairs.push_back({v, v + across});
      }
      if (with_diagonals && i + 1 < across && j + 1 < across) {
        pairs.push_back({v, v + across + 1});
      }
    }
  }
  return pairs;
}

/// Numbers of a matrix that dominates its rows, so that it is positive definite, and right-hand sides.
struct System {
  System(std::size_t size, std::span<const UnknownPair> given)
      : pairs(given.begin(), given.end()), diagonal(size, 0.5) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      below.push_back(-0.25 - static_cast<double>(k * k % 11) / 11.0);
      diagonal[pairs[k][0]] -= below[k];
      diagonal[pairs[k][1]] -= below[k];
    }
  }

  std::vector<double> times(const std::vector<double>& x) const {
    std::vector<double> y(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      y[i] = diagonal[i] * x[i];
    }
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      y[pairs[k][0]] += below[k] * x[pairs[k][1]];
      y[pairs[k][1]] += below[k] * x[pairs[k][0]];
    }
    return y;
  }

  std::vector<UnknownPair> pairs;
  std::vector<double> diagonal;
  std::vector<double> below;
};

void expect_solves(SparseFactor& factor, const System& system) {
  factor.factorise(system.diagonal, system.below);
  std::vector<double> x(system.diagonal.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = std::cos(static_cast<double>(i * i));
  }
  std::vector<double> found = system.times(x);
  std::vector<double> scratch(x.size());
  factor.solve<1>(found, scratch);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(found[i], x[i], 1e-12);
  }
}

TEST(MinimumDegreeOrder, GivesEveryUnknownItsPlace) {
  const std::vector<UnknownPair> pairs = grid(13, true);
  std::vector<std::uint32_t> place = minimum_degree_order(13 * 13 + 2, pairs);  // two stand alone
  std::sort(place.begin(), place.end());
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    EXPECT_EQ(place[i], i);
  }
}

TEST(MinimumDegreeOrder, LeavesATreeAsItIs) {
  std::vector<UnknownPair> pairs;
  for (std::uint32_t v = 1; v < 200; ++v) {
    pairs.push_back({v * v % 7 % v, v});  // to one before it
  }
  SparseFactor factor;
  factor.order(200, pairs);
  EXPECT_EQ(factor.entries(), pairs.size());
}

TEST(MinimumDegreeOrder, FillsAMeshLessThanHalfAsMuchAsRowByRow) {
  constexpr std::uint32_t kAcross = 40;
  SparseFactor factor;
  factor.order(kAcross * kAcross, grid(kAcross, true));
  EXPECT_LT(factor.entries(), kAcross * kAcross * kAcross / 2u);  // a band of kAcross
}

TEST(SparseFactor, SolvesWhatItFactorised) {
  for (const std::uint32_t across : {1u, 2u, 20u}) {
    const System system(across * across, grid(across, true));
    SparseFactor factor;
    factor.order(system.diagonal.size(), system.pairs);
    expect_solves(factor, system);
  }
}

TEST(SparseFactor, TakesAnotherPatternAndFindsANewOrderWhenItPays) {
  constexpr std::uint32_t kAcross = 16;
  const System open(kAcross * kAcross, grid(kAcross, false));
  SparseFactor factor;
  factor.order(open.diagonal.size(), open.pairs);
  expect_solves(factor, open);
  const System closed(kAcross * kAcross, grid(kAcross, true));
  factor.analyse(closed.pairs);
  expect_solves(factor, closed);
  // The numbers of the grid dealt out anew: the old order would be as bad as any.
  std::vector<std::uint32_t> number(kAcross * kAcross);
  std::iota(number.begin(), number.end(), 0u);
  for (std::uint32_t i = kAcross * kAcross; i-- > 1;) {
    std::swap(number[i], number[(i * i + 7919u) % (i + 1)]);
  }
  std::vector<UnknownPair> dealt = closed.pairs;
  for (UnknownPair& pair : dealt) {
    pair = {number[pair[0]], number[pair[1]]};
  }
  SparseFactor fresh;
  fresh.order(kAcross * kAcross, dealt);
  factor.analyse(dealt);
  EXPECT_LE(static_cast<double>(factor.entries()), 1.25 * static_cast<double>(fresh.entries()));
  expect_solves(factor, System(kAcross * kAcross, dealt));
}

TEST(SparseFactor, SolvesAColumnToTheSameBitsWhateverStandsBesideIt) {
  const System system(100, grid(10, true));
  SparseFactor factor;
  factor.order(100, system.pairs);
  factor.factorise(system.diagonal, system.below);
  std::vector<double> block(8 * 100);
  std::vector<double> alone(100);
  for (std::size_t i = 0; i < block.size(); ++i) {
    block[i] = std::sin(static_cast<double>(i));
  }
  for (std::size_t i = 0; i < 100; ++i) {
    alone[i] = block[8 * i + 5];
  }
  std::vector<double> scratch(8 * 100);
  factor.solve<8>(block, scratch);
  factor.solve<1>(alone, scratch);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(alone[i], block[8 * i + 5]);
  }
}

}  // namespace
}  // namespace anthesis
