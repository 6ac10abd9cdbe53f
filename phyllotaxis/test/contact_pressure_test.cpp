#include "anthesis/phyllotaxis/contact_pressure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

/// Least distance in the lattice, found by trying all organs.
double least_distance(double divergence_rad, double rise) {
  double least = 1.0;
  for (int k = 1; k * rise <= 1.0; ++k) {
    const double turns = k * (divergence_rad / math::kTurnRad);
    least = std::min(least, std::hypot(turns - std::floor(turns + 0.5), k * rise));
  }
  return least;
}

TEST(Press, EndsOnAMaximumOfTheLeastDistanceReachedUphill) {
  for (const double rise : {0.3, 0.1, 0.03, 0.01, 0.001}) {
    for (int i = 1; i < 40; ++i) {
      const double from = math::kTurnRad * i / 83.0;
      const PressedLattice pressed = press(from, rise);
      EXPECT_NEAR(least_distance(pressed.divergence_rad, rise), pressed.distance, 1e-12);
      EXPECT_LT(least_distance(pressed.divergence_rad + 1e-7, rise), pressed.distance);
      EXPECT_LT(least_distance(pressed.divergence_rad - 1e-7, rise), pressed.distance);
      double before = least_distance(from, rise);
      for (int step = 1; step <= 50; ++step) {
        const double here = least_distance(from + (pressed.divergence_rad - from) * step / 50.0, rise);
        EXPECT_GE(here, before - 1e-12) << rise << " " << i;
        before = here;
      }
    }
  }
}

TEST(Press, AMaximumIsATouchingLatticeOfVanIterson) {
  for (const double rise : {0.2, 0.05, 0.004}) {
    for (int i = 1; i < 30; ++i) {
      const PressedLattice pressed = press(math::kPi * i / 31.0, rise);
      const TouchingLattice lattice = touching_lattice(pressed.m, pressed.n, 0.5 * pressed.distance);
      EXPECT_NEAR(lattice.rise, rise, 1e-11);
      EXPECT_NEAR(lattice.divergence_rad, pressed.divergence_rad, 1e-9);
      EXPECT_TRUE(lattice.opposed);
    }
  }
}

TEST(Press, NothingIsPressedWhereOrgansOnlyTouchThemselves) {
  const PressedLattice free = press(1.0, 1.5);
  EXPECT_EQ(free.divergence_rad, 1.0);
  EXPECT_EQ(free.m, 0);
  EXPECT_EQ(free.n, 0);
  const PressedLattice held = press(math::radians(10.0), 0.98);  // moves only until the ring is as near
  EXPECT_EQ(held.m, 0);
  EXPECT_EQ(held.n, 1);
  EXPECT_NEAR(held.distance, 1.0, 1e-12);
  EXPECT_NEAR(least_distance(held.divergence_rad, 0.98), 1.0, 1e-12);
}

// Adler's theorem: pressure that begins early and goes on leads to the golden angle, whatever the divergence was. Here
// early means above the rise sqrt(3) / 14 at which (1, 2) bifurcates.
TEST(ContactPressure, BegunEarlyItEndsAtTheGoldenAngleFromAnyDivergence) {
  for (int i = 0; i <= 36; ++i) {
    ContactPressureParams params;
    params.first_divergence_rad = math::radians(5.0 * i + 0.1);
    params.first_rise = 0.125;
    params.last_rise = 1e-6;
    params.steps = 300;
    const Expected<std::vector<PressedLattice>> history = contact_pressure(params);
    ASSERT_TRUE(history.has_value());
    const double last = history->back().divergence_rad;
    EXPECT_NEAR(std::min(last, math::kTurnRad - last), kGoldenAngleRad, 1e-5) << i;
  }
}

TEST(ContactPressure, DivergenceStaysInNestedFareyIntervalsAndThePairsAreFibonacci) {
  const Expected<std::vector<PressedLattice>> history =
      contact_pressure({.first_divergence_rad = 1.3, .first_rise = 0.5, .last_rise = 1e-5, .steps = 400});
  std::array<double, 2> interval = {0.0, 1.0};
  int m = 1;
  int n = 1;
  for (const PressedLattice& pressed : *history) {
    if (pressed.n != n || pressed.m != m) {
      EXPECT_EQ(pressed.m, n);
      EXPECT_EQ(pressed.n, m + n);
      m = std::exchange(n, m + n);
      const auto [low, high] = opposed_interval(m, n);
      EXPECT_GE(low.value(), interval[0]);
      EXPECT_LE(high.value(), interval[1]);
      interval = {low.value(), high.value()};
    }
    const double turns = pressed.divergence_rad / math::kTurnRad;
    EXPECT_GE(turns, interval[0]);
    EXPECT_LE(turns, interval[1]);
  }
  EXPECT_EQ(n, 233);
  // As F(n) / F(n + 1) and F(n + 1) / F(n + 2) do, the ends close in on the golden angle from both sides.
  EXPECT_LT(interval[0], kGoldenAngleRad / math::kTurnRad);
  EXPECT_GT(interval[1], kGoldenAngleRad / math::kTurnRad);
}

TEST(ContactPressure, BegunLateItMayEndOnLucasNumbers) {
  const Expected<std::vector<PressedLattice>> history = contact_pressure(
      {.first_divergence_rad = math::radians(100.0), .first_rise = 0.08, .last_rise = 1e-6, .steps = 300});
  const PressedLattice& last = history->back();
  // 1, 3, 4, 7, 11, 18 ... and 360 degrees / (3 + 1 / phi)
  EXPECT_EQ(last.m, 521);
  EXPECT_EQ(last.n, 843);
  EXPECT_NEAR(last.divergence_rad, math::kTurnRad / (3.0 + 1.0 / std::numbers::phi), 1e-5);
}

TEST(ContactPressure, AMirroredStartGivesTheMirroredHistory) {
  ContactPressureParams params{.first_divergence_rad = 2.0, .first_rise = 1.2, .last_rise = 1e-4, .steps = 100};
  const Expected<std::vector<PressedLattice>> one = contact_pressure(params);
  params.first_divergence_rad = math::kTurnRad - 2.0;
  const Expected<std::vector<PressedLattice>> other = contact_pressure(params);
  for (std::size_t i = 0; i < one->size(); ++i) {
    EXPECT_NEAR((*one)[i].divergence_rad + (*other)[i].divergence_rad, math::kTurnRad, 1e-10) << i;
  }
}

TEST(ContactPressure, SaysWhatIsWrongAndStopsWhenAsked) {
  EXPECT_EQ(contact_pressure({.first_rise = 0.0}).error().where, "first_rise");
  EXPECT_EQ(contact_pressure({.first_rise = 0.1, .last_rise = 0.2}).error().where, "last_rise");
  EXPECT_EQ(contact_pressure({.steps = 0}).error().where, "steps");
  EXPECT_EQ(contact_pressure({.first_divergence_rad = NAN}).error().where, "first_divergence_rad");
  EXPECT_EQ(contact_pressure({}, [](std::string_view, double done) { return done < 0.5; }).error().code,
            ErrorCode::kCancelled);
}

}  // namespace
}  // namespace anthesis
