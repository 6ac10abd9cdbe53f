#include "../src/morph.h"

#include <gtest/gtest.h>

#include <cmath>

namespace anthesis::detail {
namespace {

/// A rod of length 1 that turns by `angle_rad` over places 0 to 1.
struct Turning {
  std::vector<std::vector<Vec3>> samples;
  std::vector<double> places;

  explicit Turning(double angle_rad, std::size_t count = 33) {
    for (std::size_t i = 0; i < count; ++i) {
      places.push_back(static_cast<double>(i) / static_cast<double>(count - 1));
      const double angle = angle_rad * places.back();
      std::vector<Vec3> rod;
      for (int j = 0; j <= 10; ++j) {
        rod.push_back(0.1 * j * Vec3{std::cos(angle), std::sin(angle), 0.0});
      }
      samples.push_back(std::move(rod));
    }
  }
};

TEST(MorphChain, WhatDoesNotMoveNeedsNoTargets) {
  const Turning still(0.0);
  const MorphChain chain = choose_morph_keys(still.samples, still.places, 0.005, 7);
  EXPECT_EQ(chain.target_count(), 0u);
  EXPECT_EQ(chain.coordinate_at(0.7), 0.0);
}

TEST(MorphChain, StraightMotionNeedsOneTargetHoweverItsSpeedChanges) {
  std::vector<std::vector<Vec3>> samples;
  std::vector<double> places;
  for (int i = 0; i <= 20; ++i) {
    places.push_back(i / 20.0);
    const double way = places.back() * places.back();  // slow, then fast
    samples.push_back({{way, 0.0, 0.0}, {way, 1.0 + way, 0.0}});
  }
  const MorphChain chain = choose_morph_keys(samples, places, 0.005, 7);
  EXPECT_EQ(chain.target_count(), 1u);
  EXPECT_LT(chain.deviation_mm, 1e-12);
  EXPECT_NEAR(chain.coordinate_at(0.5), 0.25, 1e-12);
}

TEST(MorphChain, ATurnIsWithinToleranceOfItsChainAndMoreTargetsBringItNearer) {
  const Turning turn(1.4);
  double before = 1e9;
  for (const int targets : {1, 2, 4, 7}) {
    const MorphChain chain = choose_morph_keys(turn.samples, turn.places, 1e-9, targets);
    EXPECT_EQ(chain.target_count(), static_cast<std::size_t>(targets));
    EXPECT_LT(chain.deviation_mm, before);
    before = chain.deviation_mm;
    // Chord and arc: with keys evenly apart the tip strays by 1 - cos(half the step). Samples allow no better than
    // even.
    const double step = 1.4 / targets;
    EXPECT_LE(chain.deviation_mm, 1.6 * (1.0 - std::cos(0.5 * step)));
  }
  const MorphChain enough = choose_morph_keys(turn.samples, turn.places, 0.01, 7);
  EXPECT_LE(enough.deviation_mm, 0.01 * enough.size_mm);
  EXPECT_LT(enough.target_count(), 7u);
}

TEST(MorphChain, FirstAndLastKeyAreTheSamplesThemselves) {
  const Turning turn(1.4);
  const MorphChain chain = choose_morph_keys(turn.samples, turn.places, 1e-9, 4);
  KeyFit fit(chain, turn.samples.front().size());
  for (std::size_t i = 0; i < turn.samples.size(); ++i) {
    fit.add(i, turn.samples[i]);
  }
  const std::vector<std::vector<Vec3>> keys = fit.solve();
  ASSERT_EQ(keys.size(), 5u);
  EXPECT_EQ(keys.front(), turn.samples.front());
  EXPECT_EQ(keys.back(), turn.samples.back());
  // The inner ones stand a little outside the arc.
  EXPECT_GT(length(keys[2].back()), 1.0);
  EXPECT_LT(length(keys[2].back()), 1.0 + chain.deviation_mm);
}

TEST(MorphChain, WeightsSumToOneBeyondTheFirstKeyAndRestoreEachKey) {
  MorphChain chain;
  chain.keys = {0, 4, 9, 12};
  std::vector<float> weights(3);
  chain.weights_at(0.0, weights);
  EXPECT_EQ(weights, (std::vector<float>{0, 0, 0}));
  chain.weights_at(0.25, weights);
  EXPECT_EQ(weights, (std::vector<float>{0.25f, 0, 0}));
  chain.weights_at(2.0, weights);
  EXPECT_EQ(weights, (std::vector<float>{0, 1, 0}));
  chain.weights_at(2.75, weights);
  EXPECT_EQ(weights, (std::vector<float>{0, 0.25f, 0.75f}));
  chain.weights_at(3.0, weights);
  EXPECT_EQ(weights, (std::vector<float>{0, 0, 1}));
}

}  // namespace
}  // namespace anthesis::detail
