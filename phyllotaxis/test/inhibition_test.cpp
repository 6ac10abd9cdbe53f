#include "anthesis/phyllotaxis/inhibition.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/cylinder_lattice.h"

namespace anthesis {
namespace {

constexpr double kGoldenDeg = 360.0 * (2.0 - std::numbers::phi);

/// Inhibition at an angle of the ring when organ `born` appears, by the definition.
double inhibition_at(const InhibitionParams& params, const std::vector<RingBirth>& births, std::size_t born,
                     double angle_rad) {
  const double range = params.range[1];
  double sum = 0.0;
  for (std::size_t i = 0; i < born; ++i) {
    const RingPlace place = RingTrack(params).at(births[born].time - births[i].time);
    const double x = place.radius * std::cos(births[i].azimuth_rad) - std::cos(angle_rad);
    const double y = place.radius * std::sin(births[i].azimuth_rad) - std::sin(angle_rad);
    const double d = std::sqrt(x * x + y * y + place.depth * place.depth);
    if (std::max(place.radius, place.depth) <= params.horizon) {
      sum += params.law == InhibitionLaw::kPower ? std::pow(range / d, params.exponent) : std::exp(1.0 - d / range);
    }
  }
  return sum;
}

double last_divergence_deg(const InhibitionParams& params) {
  const Expected<std::vector<RingBirth>> births = grow_by_inhibition(params);
  return births ? math::degrees(births->back().divergence_rad) : -1.0;
}

TEST(Inhibition, EachOrganIsBornAtTheLeastInhibitedPlaceOfTheRing) {
  for (const RingTransport transport :
       {RingTransport::kExponentialDisc, RingTransport::kSteadyDisc, RingTransport::kCylinder}) {
    for (const InhibitionLaw law : {InhibitionLaw::kPower, InhibitionLaw::kExponential}) {
      const InhibitionParams params{.transport = transport,
                                    .law = law,
                                    .period = {0.13, 0.13},
                                    .range = {0.4, 0.4},
                                    .count = 40,
                                    .horizon = 20.0};
      const Expected<std::vector<RingBirth>> births = grow_by_inhibition(params);
      ASSERT_TRUE(births.has_value());
      for (std::size_t born = 2; born < births->size(); ++born) {
        const RingBirth& birth = (*births)[born];
        const double here = inhibition_at(params, *births, born, birth.azimuth_rad);
        EXPECT_NEAR(birth.inhibition / here, 1.0, 1e-12);
        double least = here;
        for (int i = 0; i < 3000; ++i) {
          least = std::min(least, inhibition_at(params, *births, born, math::kTurnRad * i / 3000.0));
        }
        EXPECT_GE(least, here * (1.0 - 1e-12)) << born;
        // The place itself: the derivative vanishes to rounding.
        const double slope = inhibition_at(params, *births, born, birth.azimuth_rad + 1e-5) -
                             inhibition_at(params, *births, born, birth.azimuth_rad - 1e-5);
        EXPECT_LT(std::abs(slope), 1e-11 * here) << born;
      }
    }
  }
}

TEST(Inhibition, LongPeriodsGiveTwoRows) {
  EXPECT_NEAR(last_divergence_deg({.period = {1.0, 1.0}, .count = 60}), 180.0, 1e-9);
  EXPECT_NEAR(last_divergence_deg({.transport = RingTransport::kCylinder, .period = {2.0, 2.0}, .count = 60}), 180.0,
              1e-9);
}

TEST(Inhibition, TwoRowsBreakWhereASlowTurnIsNoLongerResisted) {
  // Two rows, organ k back at the radius exp(k G): odd ones are opposite the new organ, even ones behind it. If all
  // have been turned by k times a small angle, the torque on the new organ is the sum of k times the second
  // derivatives.
  const auto torque = [](double period) {
    double sum = 0.0;
    for (int k = 1; k <= 40; ++k) {
      const double radius = std::exp(k * period);
      sum += k * (k % 2 == 1 ? radius / std::pow(radius + 1.0, 5.0) : -radius / std::pow(radius - 1.0, 5.0));
    }
    return sum;
  };
  double low = 0.5;
  double high = 1.5;
  while (high - low > 1e-12) {
    const double middle = 0.5 * (low + high);
    (torque(middle) < 0.0 ? low : high) = middle;
  }
  EXPECT_NEAR(low, 0.859, 0.001);
  InhibitionParams params{.period = {low + 0.002, low + 0.002}, .count = 4000};
  EXPECT_NEAR(last_divergence_deg(params), 180.0, 1e-3);
  params.period = {low - 0.002, low - 0.002};
  EXPECT_GT(std::abs(last_divergence_deg(params) - 180.0), 1.0);
}

TEST(Inhibition, AFallingPeriodLeadsToTheGoldenAngleThroughFibonacciPairs) {
  for (const RingTransport transport : {RingTransport::kExponentialDisc, RingTransport::kCylinder}) {
    InhibitionParams params{.transport = transport, .period = {1.5, 0.01}, .ramp = 500, .count = 560, .horizon = 10.0};
    const Expected<std::vector<RingBirth>> births = grow_by_inhibition(params);
    ASSERT_TRUE(births.has_value());
    const std::vector<Vec2> all = unrolled_births(RingTrack(params), *births);
    const PatternMeasure last = measure_pattern(all, 530, 560);
    EXPECT_NEAR(std::min(math::degrees(last.divergence_rad), 360.0 - math::degrees(last.divergence_rad)), kGoldenDeg,
                0.5);
    EXPECT_LT(math::degrees(last.deviation_rad), 0.5);
    std::vector<std::array<int, 2>> pairs;
    for (std::size_t end = 120; end <= 560; end += 20) {
      const PatternMeasure measure = measure_pattern(std::span(all).first(end), end - 20, end);
      EXPECT_THAT(measure.m, testing::AnyOf(1, 2, 3, 5, 8, 13)) << end;
      EXPECT_THAT(measure.n, testing::AnyOf(2, 3, 5, 8, 13, 21)) << end;
      pairs.push_back({measure.m, measure.n});
    }
    EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
    EXPECT_EQ(pairs.back(), (std::array{13, 21}));
  }
}

TEST(Inhibition, TheMirroredNudgeGivesTheMirroredPattern) {
  InhibitionParams params{.period = {1.2, 0.05}, .ramp = 100, .count = 140};
  const Expected<std::vector<RingBirth>> one = grow_by_inhibition(params);
  params.nudge_rad = -params.nudge_rad;
  const Expected<std::vector<RingBirth>> other = grow_by_inhibition(params);
  bool turned = false;
  for (std::size_t i = 1; i < one->size(); ++i) {
    const double sum = (*one)[i].divergence_rad + (*other)[i].divergence_rad;
    EXPECT_NEAR(sum, math::kTurnRad, 1e-6) << i;
    turned = turned || std::abs((*one)[i].divergence_rad - math::kPi) > 0.1;
  }
  EXPECT_TRUE(turned);
}

TEST(Inhibition, ATieIsDecidedByTheSignOfTheNudgeAlone) {
  // Too small a nudge to favour a side: the third organ finds two equal places.
  InhibitionParams params{.period = {0.5, 0.5}, .count = 30, .nudge_rad = 1e-15};
  const Expected<std::vector<RingBirth>> one = grow_by_inhibition(params);
  params.nudge_rad = -1e-15;
  const Expected<std::vector<RingBirth>> other = grow_by_inhibition(params);
  EXPECT_LT((*one)[2].divergence_rad, math::kPi);  // the first one met counter-clockwise of the last organ
  for (std::size_t i = 1; i < one->size(); ++i) {
    EXPECT_NEAR((*one)[i].divergence_rad + (*other)[i].divergence_rad, math::kTurnRad, 1e-9) << i;
  }
}

TEST(Inhibition, WithoutAPeriodOrgansComeWhenTheInhibitionHasFallenToOne) {
  InhibitionParams params{.rule = BirthRule::kThreshold, .exponent = 8, .range = {1.5, 1.5}, .count = 120};
  const Expected<std::vector<RingBirth>> births = grow_by_inhibition(params);
  ASSERT_TRUE(births.has_value());
  for (std::size_t i = 2; i < births->size(); ++i) {
    EXPECT_NEAR((*births)[i].inhibition, 1.0, 1e-10);
    EXPECT_GT((*births)[i].time, (*births)[i - 1].time);
  }
  // The rhythm comes of itself: equal periods, and the divergence of the (3, 5) arc.
  const auto period = [&](std::size_t i) { return (*births)[i].time - (*births)[i - 1].time; };
  EXPECT_NEAR(period(119), period(118), 1e-3);
  EXPECT_NEAR(math::degrees(births->back().divergence_rad), 140.5, 0.1);
}

TEST(Inhibition, WithoutAPeriodWhorlsMayCome) {
  const InhibitionParams params{
      .rule = BirthRule::kThreshold, .exponent = 8, .range = {1.0, 1.0}, .count = 240, .nudge_rad = 0.0};
  const Expected<std::vector<RingBirth>> births = grow_by_inhibition(params);
  ASSERT_TRUE(births.has_value());
  // Pairs: the second of each comes almost at once, opposite to the first.
  std::size_t pairs = 0;
  for (std::size_t i = 201; i < births->size(); ++i) {
    const double wait = (*births)[i].time - (*births)[i - 1].time;
    const double off_deg = std::abs(math::degrees((*births)[i].divergence_rad) - 180.0);
    pairs += wait < 0.02 && off_deg < 2.0 ? 1 : 0;
  }
  EXPECT_GE(pairs, 18u);
}

TEST(Inhibition, OnASurfaceThatIsADiscOrACylinderAllIsAsOnThatOne) {
  InhibitionParams params{
      .transport = RingTransport::kExponentialDisc, .period = {1.2, 0.1}, .ramp = 60, .count = 90, .horizon = 8.0};
  const auto compare = [&](std::vector<Vec2> profile, double ring_s) {
    const Expected<std::vector<RingBirth>> plain = grow_by_inhibition(params);
    InhibitionParams other = params;
    other.transport = RingTransport::kSurface;
    other.profile = std::move(profile);
    other.ring_s = ring_s;
    const Expected<std::vector<RingBirth>> surface = grow_by_inhibition(other);
    ASSERT_TRUE(surface.has_value());
    for (std::size_t i = 0; i < plain->size(); ++i) {
      EXPECT_NEAR((*plain)[i].divergence_rad, (*surface)[i].divergence_rad, 2e-3) << i;
    }
  };
  compare({{0.0, 1.0}, {100.0, 1.0}}, 0.1);  // ten times the ring's radius: beyond the horizon
  params.transport = RingTransport::kCylinder;
  compare({{7.0, 90.0}, {7.0, 0.0}}, 0.0);
}

TEST(Inhibition, SaysWhatIsWrongAndStopsWhenAsked) {
  EXPECT_EQ(grow_by_inhibition({.exponent = 0}).error().where, "exponent");
  EXPECT_EQ(grow_by_inhibition({.transport = RingTransport::kSurface}).error().where, "profile");
  EXPECT_EQ(
      grow_by_inhibition({.transport = RingTransport::kSurface, .profile = {{0.0, 1.0}, {1.0, 0.0}}, .ring_s = 0.0})
          .error()
          .where,
      "ring_s");
  EXPECT_EQ(grow_by_inhibition({.period = {1.0, 0.0}}).error().where, "period");
  EXPECT_EQ(grow_by_inhibition({.range = {1.0, NAN}}).error().where, "range");
  EXPECT_EQ(grow_by_inhibition({.count = 0}).error().where, "count");
  EXPECT_EQ(grow_by_inhibition({.nudge_rad = 4.0}).error().where, "nudge_rad");
  EXPECT_EQ(grow_by_inhibition({.horizon = 1.0}).error().where, "horizon");
  EXPECT_EQ(grow_by_inhibition({}, [](std::string_view, double done) { return done < 0.5; }).error().code,
            ErrorCode::kCancelled);
}

}  // namespace
}  // namespace anthesis
