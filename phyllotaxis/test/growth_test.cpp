#include "anthesis/phyllotaxis/growth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

TEST(GrowthFunction, ConstantRateIsExponential) {
  const auto growth = GrowthFunction::from_rate(FunctionGraph({{0.0, 7.0}, {1.0, 7.0}}));
  for (const double x : {-0.5, 0.0, 0.3, 1.0, 1.7}) {
    EXPECT_NEAR(growth(x) / math::exp(7.0 * x), 1.0, 1e-13);
    EXPECT_NEAR(growth.ratio(0.2, x) / math::exp(7.0 * (x - 0.2)), 1.0, 1e-13);
  }
}

TEST(GrowthFunction, RateIsTheDerivativeOfTheLogarithm) {
  const FunctionGraph rate({{0.1, 2.0}, {0.4, 9.0}, {0.6, 0.0}, {0.9, 4.0}});
  const auto growth = GrowthFunction::from_rate(rate);
  EXPECT_NEAR(growth(0.0), 1.0, 1e-15);
  for (const double x : {-0.2, 0.2, 0.5, 0.77, 1.3}) {
    EXPECT_NEAR(math::log(growth.ratio(x - 1e-4, x + 1e-4)) / 2e-4, rate(x), 1e-5);
  }
}

TEST(GrowthFunction, RatioDoesNotOverflowWhereTheFactorDoes) {
  const auto growth = GrowthFunction::from_rate(FunctionGraph({{0.0, 4000.0}, {1.0, 4000.0}}));
  EXPECT_TRUE(std::isinf(growth(1.0)));
  EXPECT_NEAR(growth.ratio(0.999, 1.0) / math::exp(4.0), 1.0, 1e-12);
}

TEST(GrowthFunction, WhenIsTheFirstTimeAtWhichAFactorIsReached) {
  const FunctionGraph graph({{0.0, 0.1}, {0.2, 0.1}, {0.4, 0.9}, {0.7, 2.0}, {1.0, 4.0}});
  for (const GrowthFunction& growth : {GrowthFunction(graph), GrowthFunction::from_rate(graph)}) {
    for (const double from : {0.0, 0.15, 0.6, 0.93}) {
      for (const double share : {0.01, 0.4, 1.0}) {
        const double factor = 1.0 + share * (growth.ratio(from, 1.0) - 1.0);
        const double when = growth.when(from, factor);
        EXPECT_GE(when, from);
        EXPECT_LE(when, 1.0);
        EXPECT_NEAR(growth.ratio(from, when) / factor, 1.0, 1e-14);
        EXPECT_LT(growth.ratio(from, when - 1e-9), factor);
      }
    }
  }
}

TEST(GrowthFunction, WhenAnswersForFactorsThatAreThereOrNeverCome) {
  const GrowthFunction factor(FunctionGraph({{0.0, 1.0}, {1.0, 3.0}}));
  EXPECT_EQ(factor.when(0.25, 1.0), 0.25);
  EXPECT_EQ(factor.when(0.25, 0.5), 0.25);
  EXPECT_EQ(factor.when(0.0, 3.0), 1.0);
  EXPECT_EQ(factor.when(0.0, 3.0 + 1e-9), kNever);
  EXPECT_EQ(factor.when(1.5, 1.1), kNever);
  const auto stopping = GrowthFunction::from_rate(FunctionGraph({{0.0, 2.0}, {1.0, 0.0}}));
  EXPECT_EQ(stopping.when(0.0, 2.8), kNever);  // it reaches e only
  const auto going_on = GrowthFunction::from_rate(FunctionGraph({{0.5, 2.0}, {1.0, 2.0}}));
  EXPECT_NEAR(going_on.when(0.0, math::exp(6.0)), 3.0, 1e-14);
  EXPECT_NEAR(going_on.when(-1.0, math::exp(1.0)), -0.5, 1e-14);
}

}  // namespace
}  // namespace anthesis
