#include "section_laplacian.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace anthesis {
namespace {

/// A square net of points, those of its first row given, with weights on its edges.
struct Net {
  explicit Net(std::uint32_t points_across, bool with_diagonals) : across(points_across) {
    for (std::uint32_t j = 0; j < across; ++j) {
      for (std::uint32_t i = 0; i < across; ++i) {
        const std::uint32_t v = j * across + i;
        if (i + 1 < across) {
          edges.edges.push_back({v, v + 1});
        }
        if (j + 1 < across) {
          edges.edges.push_back({v, v + across});
        }
        if (with_diagonals && i + 1 < across && j + 1 < across) {
          edges.edges.push_back({v, v + across + 1});
        }
      }
    }
    for (std::size_t e = 0; e < edges.edges.size(); ++e) {
      weights.push_back(0.25 + static_cast<double>(e * e % 11) / 11.0);
    }
  }

  std::size_t points() const { return std::size_t{across} * across; }

  /// The numbers of the free points dealt out anew: an order of before is as bad as any.
  void deal() {
    std::vector<std::uint32_t> number(points());
    std::iota(number.begin(), number.end(), 0u);
    for (std::uint32_t i = across * across; i-- > across + 1;) {
      std::swap(number[i], number[across + (i * i + 7919u) % (i + 1 - across)]);
    }
    for (MeshEdge& edge : edges.edges) {
      const std::uint32_t a = number[edge.a];
      const std::uint32_t b = number[edge.b];
      edge = {std::min(a, b), std::max(a, b)};
    }
  }

  std::uint32_t across;
  MeshEdges edges;
  std::vector<double> weights;
};

std::vector<double> extended(const LaplaceFactor& factor, const Net& net) {
  std::vector<double> values(net.points(), 99.0);
  for (std::uint32_t i = 0; i < net.across; ++i) {
    values[i] = std::cos(static_cast<double>(i * i));
  }
  factor.extend<1>(net.edges, net.weights, values);
  return values;
}

/// In equilibrium every free point is the weighted mean of its neighbours.
void expect_equilibrium(const LaplaceFactor& factor, const Net& net) {
  const std::vector<double> values = extended(factor, net);
  std::vector<double> pull(net.points(), 0.0);
  for (std::size_t e = 0; e < net.edges.edges.size(); ++e) {
    const MeshEdge& edge = net.edges.edges[e];
    pull[edge.a] += net.weights[e] * (values[edge.b] - values[edge.a]);
    pull[edge.b] += net.weights[e] * (values[edge.a] - values[edge.b]);
  }
  for (std::size_t v = net.across; v < pull.size(); ++v) {
    EXPECT_NEAR(pull[v], 0.0, 1e-13);
  }
}

TEST(LaplaceFactor, BringsEveryFreePointIntoEquilibrium) {
  for (const std::uint32_t across : {1u, 2u, 20u}) {
    const Net net(across, true);
    LaplaceFactor factor;
    factor.assign(net.edges, net.points(), across);
    factor.factorise(net.edges, net.weights);
    expect_equilibrium(factor, net);
  }
}

TEST(LaplaceFactor, FillsANetLessThanHalfAsMuchAsRowByRow) {
  constexpr std::uint32_t kAcross = 40;
  const Net net(kAcross, true);
  LaplaceFactor factor;
  factor.assign(net.edges, net.points(), kAcross);
  factor.factorise(net.edges, net.weights);
  EXPECT_LT(factor.entries(), kAcross * kAcross * kAcross / 2);  // a band of kAcross
}

TEST(LaplaceFactor, TakesOtherEdgesAndFindsANewOrderWhenItPays) {
  constexpr std::uint32_t kAcross = 16;
  const Net open(kAcross, false);
  LaplaceFactor factor;
  factor.assign(open.edges, open.points(), kAcross);
  factor.factorise(open.edges, open.weights);
  expect_equilibrium(factor, open);
  Net net(kAcross, true);
  for (const bool is_dealt : {false, true}) {
    if (is_dealt) {
      net.deal();
    }
    LaplaceFactor fresh;
    fresh.assign(net.edges, net.points(), kAcross);
    fresh.factorise(net.edges, net.weights);
    factor.arrange(net.edges);
    factor.factorise(net.edges, net.weights);
    EXPECT_LE(static_cast<double>(factor.entries()), 1.25 * static_cast<double>(fresh.entries()));
    expect_equilibrium(factor, net);
  }
}

TEST(LaplaceFactor, SolvesAColumnToTheSameBitsWhateverStandsBesideIt) {
  const Net net(10, true);
  LaplaceFactor factor;
  factor.assign(net.edges, net.points(), net.across);
  factor.factorise(net.edges, net.weights);
  const std::vector<double> alone = extended(factor, net);
  std::vector<double> block(8 * net.points(), 0.0);
  for (std::size_t i = 0; i < net.across; ++i) {
    for (std::size_t k = 0; k < 8; ++k) {
      block[8 * i + k] = k == 5 ? alone[i] : std::sin(static_cast<double>(8 * i + k));
    }
  }
  factor.extend<8>(net.edges, net.weights, block);
  for (std::size_t i = 0; i < net.points(); ++i) {
    EXPECT_EQ(alone[i], block[8 * i + 5]);
  }
}

TEST(LaplaceFactor, LeavesACopyWhatItHadWhenItFactorisesAnew) {
  Net net(10, true);
  LaplaceFactor factor;
  factor.assign(net.edges, net.points(), net.across);
  factor.factorise(net.edges, net.weights);
  const LaplaceFactor copy = factor;
  const Net before = net;
  const std::vector<double> expected = extended(factor, net);
  for (std::size_t e = 0; e < net.weights.size(); ++e) {
    net.weights[e] += static_cast<double>(e % 3);
  }
  factor.factorise(net.edges, net.weights);
  EXPECT_EQ(extended(copy, before), expected);
  expect_equilibrium(factor, net);
}

}  // namespace
}  // namespace anthesis
