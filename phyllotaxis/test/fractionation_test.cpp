#include "anthesis/phyllotaxis/fractionation.h"

#include <gtest/gtest.h>

#include <numeric>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

FractionationParams growing_head() {
  FractionationParams params;
  params.profiles = {{0.0, {{0, 3}, {2, 3}, {3, 1}, {3, 0}}}, {1.0, {{0, 1}, {3, 1}, {5, 0.5}, {5, 0}}}};
  params.interval = 0.002;
  params.meristem_area_mm2 = 30.0;
  params.meristem_growth = FunctionGraph({{0.0, 1.0}, {0.5, 2.0}, {1.0, 2.0}});
  params.area_mm2 = FunctionGraph({{0.0, 0.6}, {1.0, 1.0}});
  params.area_growth = FunctionGraph({{0.0, 0.25}, {0.3, 0.8}, {1.0, 1.0}});
  return params;
}

TEST(Fractionation, PrimordiaComeAtFixedIntervalsFromTheRimInwards) {
  const auto pattern = Fractionation::run(growing_head(), 10'000);
  ASSERT_TRUE(pattern);
  ASSERT_GT(pattern->primordia().size(), 100u);
  const auto primordia = pattern->primordia();
  EXPECT_EQ(primordia[0].s_at_birth, 1.0);
  for (std::size_t i = 1; i < primordia.size(); ++i) {
    EXPECT_NEAR(primordia[i].birth - primordia[i - 1].birth, 0.002, 1e-12);
    EXPECT_LT(primordia[i].s_at_birth, primordia[i - 1].s_at_birth);
    const double turn = primordia[i].azimuth_rad - primordia[i - 1].azimuth_rad;
    EXPECT_NEAR(turn < 0.0 ? turn + math::kTurnRad : turn, kGoldenAngleRad, 1e-9);
  }
}

TEST(Fractionation, EndsWhenLessThanOnePrimordiumIsLeft) {
  const FractionationParams params = growing_head();
  const auto pattern = Fractionation::run(params, 10'000);
  const Primordium last = pattern->primordia().back();
  ASSERT_LT(last.birth + params.interval, 1.0);  // it ended for want of room, not of time
  const double newborn = params.area_growth(0.0) * params.area_mm2(0.0);
  EXPECT_LT(pattern->naked_area_mm2(last.birth + params.interval), newborn);
  EXPECT_GE(pattern->naked_area_mm2(last.birth), 0.0);
}

TEST(Fractionation, SurfaceHasTheAreaOfItsRegions) {
  const auto pattern = Fractionation::run(growing_head(), 10'000);
  for (const double time : {0.0, 0.03, 0.1234, 0.5, 1.0}) {
    const SurfaceOfRevolution surface = pattern->surface(time);
    double sum = pattern->naked_area_mm2(time);
    const auto places = pattern->places(time, surface);
    for (const PrimordiumPlace& place : places) {
      sum += place.area_mm2;
    }
    EXPECT_NEAR(surface.area_mm2() / sum, 1.0, 1e-12);
    // The innermost primordium borders on the naked region.
    const PrimordiumPlace& innermost = places.back();
    EXPECT_NEAR(surface.area_from_apex_mm2(innermost.t) - 0.5 * innermost.area_mm2, pattern->naked_area_mm2(time),
                1e-9 * sum);
  }
}

TEST(Fractionation, NothingDependsOnWhichTimesAreAskedFor) {
  const auto pattern = Fractionation::run(growing_head(), 10'000);
  const auto places_at = [&](double time) { return pattern->places(time, pattern->surface(time)); };
  const auto direct = places_at(0.4);
  for (int frame = 0; frame < 40; ++frame) {
    places_at(frame / 100.0);
  }
  const auto after_others = places_at(0.4);
  ASSERT_EQ(direct.size(), after_others.size());
  for (std::size_t i = 0; i < direct.size(); ++i) {
    EXPECT_EQ(direct[i].t, after_others[i].t);
  }
}

TEST(Fractionation, PrimordiaMoveWithoutJumpsWhileOthersAreBorn) {
  // A birth takes its area from the naked region and gives it to the primordium: nothing else may notice.
  const auto pattern = Fractionation::run(growing_head(), 10'000);
  const double birth = pattern->primordia()[60].birth;
  const double just_before = birth - 1e-9;
  const SurfaceOfRevolution before = pattern->surface(just_before);
  const SurfaceOfRevolution after = pattern->surface(birth);
  EXPECT_EQ(pattern->born(just_before) + 1, pattern->born(birth));
  EXPECT_NEAR(before.area_mm2() / after.area_mm2(), 1.0, 1e-7);
  const auto places_before = pattern->places(just_before, before);
  const auto places_after = pattern->places(birth, after);
  for (std::size_t i = 0; i < places_before.size(); ++i) {
    EXPECT_NEAR(places_before[i].t, places_after[i].t, 1e-7);
  }
}

TEST(Fractionation, RefusesMoreThanTheLimit) {
  const auto pattern = Fractionation::run(growing_head(), 50);
  ASSERT_FALSE(pattern);
  EXPECT_EQ(pattern.error().code, ErrorCode::kTooLarge);
}

TEST(Fractionation, CanBeCancelled) {
  const auto pattern =
      Fractionation::run(growing_head(), 10'000, [](std::string_view, double fraction) { return fraction < 0.1; });
  ASSERT_FALSE(pattern);
  EXPECT_EQ(pattern.error().code, ErrorCode::kCancelled);
}

TEST(CheckFractionation, NamesWhatIsWrong) {
  FractionationParams params = growing_head();
  params.profiles[1].controls.pop_back();
  EXPECT_EQ(check(params)->where, "receptacle[1].points");
  params = growing_head();
  params.profiles[1].time = 0.0;
  EXPECT_EQ(check(params)->where, "receptacle[1].time");
  params = growing_head();
  params.interval = 0.0;
  EXPECT_EQ(check(params)->where, "interval");
}

}  // namespace
}  // namespace anthesis
