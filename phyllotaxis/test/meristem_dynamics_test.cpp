#include "anthesis/phyllotaxis/meristem_dynamics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

/// A dome that flattens while it grows. Each mode covers it with some 150 primordia, which it has done before time 1.
MeristemDynamicsParams growing_head(MeristemMode mode) {
  MeristemDynamicsParams params;
  params.mode = mode;
  params.profiles = {{0.0, {{0, 3}, {2, 3}, {3, 1}, {3, 0}}}, {1.0, {{0, 1}, {3, 1}, {5, 0.5}, {5, 0}}}};
  params.interval = 0.002;
  params.meristem_area_mm2 = 30.0;
  params.meristem_growth = FunctionGraph({{0.0, 1.0}, {0.5, 2.0}, {1.0, 2.0}});
  params.area_mm2 = FunctionGraph({{0.0, 0.6}, {1.0, 1.0}});
  params.area_growth = FunctionGraph({{0.0, 0.25}, {0.3, 0.8}, {1.0, 1.0}});
  if (mode == MeristemMode::kDivergent) {
    params.meristem_area_mm2 = 18.0;
    params.outer_area_mm2 = 10.0;
    params.outer_growth = FunctionGraph({{0.0, 1.0}, {0.3, 1.6}, {1.0, 1.6}});
  }
  if (mode == MeristemMode::kSegregation) {
    params.meristem_area_mm2 = 0.4;
    params.threshold_area_mm2 = 0.9;
    params.meristem_growth =
        GrowthFunction::from_rate(FunctionGraph({{0.0, 50.0}, {0.4, 60.0}, {0.7, 0.0}, {1.0, 0.0}}));
  }
  return params;
}

constexpr std::array kModes = {MeristemMode::kCentripetal, MeristemMode::kDivergent, MeristemMode::kSegregation};

MeristemDynamics run(const MeristemDynamicsParams& params) {
  auto pattern = MeristemDynamics::run(params, 10'000);
  EXPECT_TRUE(pattern);
  return std::move(*pattern);
}

/// Some 300 organs of area 1 on a flat disc, and 0.4 naked at its centre in the end, which is at `end`.
struct FlatDisc {
  MeristemDynamics pattern;
  double end = 1.0;
};

FlatDisc flat_disc(MeristemMode mode) {
  MeristemDynamicsParams params;
  params.mode = mode;
  params.profiles = {{0.0, {{0, 0}, {1, 0}}}};
  params.meristem_area_mm2 = mode == MeristemMode::kCentripetal ? 300.4
                             : mode == MeristemMode::kDivergent ? 180.4
                                                                : 1.4;
  params.outer_area_mm2 = 120.0;
  params.threshold_area_mm2 = 1.4;
  if (mode == MeristemMode::kSegregation) {
    params.meristem_growth = GrowthFunction::from_rate(FunctionGraph({{0.0, 376.0}, {1.0, 376.0}}));
  }
  FlatDisc disc{run(params)};
  if (mode == MeristemMode::kSegregation) {
    disc.end = disc.pattern.primordia()[299].birth;  // just then the centre is 0.4 again
  }
  return disc;
}

struct Seen {
  Vec2 place_mm;
  double azimuth_rad = 0.0;
  double age = 0.0;
  int index = 0;
};

/// The organs from the rim to the centre, seen from above.
std::vector<Seen> seen_from_above(const MeristemDynamics& pattern, double time) {
  const SurfaceOfRevolution surface = pattern.surface(time);
  const auto places = pattern.places(time, surface);
  std::vector<std::pair<double, Seen>> by_t;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Primordium& primordium = pattern.primordia()[i];
    const Vec3 p = surface.frame(places[i].t, primordium.azimuth_rad).position_mm;
    by_t.push_back({places[i].t, {{p.x, p.y}, primordium.azimuth_rad, time - primordium.birth, primordium.index}});
  }
  std::sort(by_t.begin(), by_t.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Seen> seen;
  for (const auto& [t, organ] : by_t) {
    seen.push_back(organ);
  }
  return seen;
}

/// Distances to the nearest neighbour, ascending.
std::vector<double> neighbour_distances(std::span<const Seen> organs) {
  std::vector<double> distances;
  for (const Seen& a : organs) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Seen& b : organs) {
      if (&a != &b) {
        nearest = std::min(nearest, length(a.place_mm - b.place_mm));
      }
    }
    distances.push_back(nearest);
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

/// The two most frequent differences of index between organs [first, last) and their two nearest neighbours: the
/// numbers of parastichies that cross there.
std::array<int, 2> parastichies(std::span<const Seen> organs, std::size_t first, std::size_t last) {
  std::map<int, int> votes;
  for (std::size_t a = first; a < last; ++a) {
    std::vector<std::pair<double, int>> near;
    for (std::size_t b = 0; b < organs.size(); ++b) {
      if (b != a) {
        near.push_back({length(organs[a].place_mm - organs[b].place_mm), std::abs(organs[a].index - organs[b].index)});
      }
    }
    std::sort(near.begin(), near.end());
    for (std::size_t k = 0; k < 4; ++k) {
      ++votes[near[k].second];
    }
  }
  std::array<int, 2> most{};
  for (int& difference : most) {
    const auto best = std::max_element(votes.begin(), votes.end(), [](auto a, auto b) { return a.second < b.second; });
    difference = best->first;
    best->second = 0;
  }
  std::sort(most.begin(), most.end());
  return most;
}

// What all modes promise

TEST(MeristemDynamics, RegionsSumToTheSurfaceAtAllTimes) {
  for (const MeristemMode mode : kModes) {
    const MeristemDynamics pattern = run(growing_head(mode));
    ASSERT_GT(pattern.primordia().size(), 100u);
    for (const double time : {0.0, 0.03, 0.1234, 0.5, 0.777, 1.0}) {
      const SurfaceOfRevolution surface = pattern.surface(time);
      const auto places = pattern.places(time, surface);
      double sum = pattern.naked_area_mm2(time) + pattern.outer_area_mm2(time);
      std::size_t innermost = 0;
      std::size_t outermost = 0;
      for (std::size_t i = 0; i < places.size(); ++i) {
        sum += places[i].area_mm2;
        innermost = places[i].t < places[innermost].t ? i : innermost;
        outermost = places[i].t > places[outermost].t ? i : outermost;
      }
      EXPECT_NEAR(surface.area_mm2() / sum, 1.0, 1e-12);
      // The naked regions are what the bands leave free at the apex and at the base.
      const auto above = [&](std::size_t i) { return surface.area_from_apex_mm2(places[i].t); };
      if (!places.empty()) {
        EXPECT_NEAR(above(innermost) - 0.5 * places[innermost].area_mm2, pattern.naked_area_mm2(time), 1e-9 * sum);
        EXPECT_NEAR(sum - above(outermost) - 0.5 * places[outermost].area_mm2, pattern.outer_area_mm2(time),
                    1e-9 * sum);
      }
    }
  }
}

TEST(MeristemDynamics, NothingDependsOnWhichTimesAreAskedFor) {
  for (const MeristemMode mode : kModes) {
    const MeristemDynamics pattern = run(growing_head(mode));
    const auto places_at = [&](double time) { return pattern.places(time, pattern.surface(time)); };
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
}

TEST(MeristemDynamics, PrimordiaMoveWithoutJumpsWhileOthersAreBorn) {
  // A birth takes its area from a naked region and gives it to the primordium: nothing else may notice.
  for (const MeristemMode mode : kModes) {
    const MeristemDynamics pattern = run(growing_head(mode));
    for (const std::size_t i : {60u, 61u}) {  // in divergent mode one on each front
      const double birth = pattern.primordia()[i].birth;
      const double just_before = birth - 1e-9;
      const SurfaceOfRevolution before = pattern.surface(just_before);
      const SurfaceOfRevolution after = pattern.surface(birth);
      EXPECT_EQ(pattern.born(just_before) + 1, pattern.born(birth));
      EXPECT_NEAR(before.area_mm2() / after.area_mm2(), 1.0, 1e-7);
      const auto places_before = pattern.places(just_before, before);
      const auto places_after = pattern.places(birth, after);
      for (std::size_t k = 0; k < places_before.size(); ++k) {
        EXPECT_NEAR(places_before[k].t, places_after[k].t, 1e-7);
      }
    }
  }
}

TEST(MeristemDynamics, APrimordiumIsBornAtTheBorderOfTheNakedRegionThatItTakes) {
  for (const MeristemMode mode : kModes) {
    const MeristemDynamicsParams params = growing_head(mode);
    const MeristemDynamics pattern = run(params);
    for (const std::size_t i : {0u, 1u, 40u, 41u, 120u, 121u}) {
      const Primordium& primordium = pattern.primordia()[i];
      const SurfaceOfRevolution surface = pattern.surface(primordium.birth);
      const PrimordiumPlace place = pattern.places(primordium.birth, surface)[i];
      const double half = primordium.index < 0 ? -0.5 : 0.5;  // its band lies on the naked side of the border
      const double border = surface.area_from_apex_mm2(place.t) + half * place.area_mm2;
      EXPECT_NEAR(surface.s_from_t(surface.t_from_area_mm2(border)), primordium.s_at_birth, 1e-11);
      EXPECT_EQ(primordium.mature_area_mm2, params.area_mm2(primordium.s_at_birth));
    }
  }
}

TEST(MeristemDynamics, AzimuthIsTheIndexTimesTheDivergenceInEveryMode) {
  for (const MeristemMode mode : kModes) {
    const MeristemDynamics pattern = run(growing_head(mode));
    for (const Primordium& primordium : pattern.primordia()) {
      const double turns = (primordium.azimuth_rad - primordium.index * kGoldenAngleRad) / math::kTurnRad;
      EXPECT_NEAR(turns, std::round(turns), 1e-12);
      EXPECT_GE(primordium.azimuth_rad, 0.0);
      EXPECT_LT(primordium.azimuth_rad, math::kTurnRad);
    }
  }
}

// What the modes have in common in the end, and what not

TEST(MeristemDynamics, EqualOrgansOnADiscEndInTheSamePatternInEveryMode) {
  const FlatDisc centripetal = flat_disc(MeristemMode::kCentripetal);
  const auto expected = seen_from_above(centripetal.pattern, centripetal.end);
  ASSERT_EQ(expected.size(), 300u);
  for (const MeristemMode mode : {MeristemMode::kDivergent, MeristemMode::kSegregation}) {
    const FlatDisc disc = flat_disc(mode);
    const auto organs = seen_from_above(disc.pattern, disc.end);
    ASSERT_EQ(organs.size(), 300u);
    const int first = organs[0].index;
    EXPECT_EQ(first, mode == MeristemMode::kDivergent ? -120 : 0);
    const auto [sine, cosine] = math::sin_cos(-first * kGoldenAngleRad);
    for (std::size_t i = 0; i < organs.size(); ++i) {
      EXPECT_EQ(organs[i].index, static_cast<int>(i) + first);
      const Vec2 p = organs[i].place_mm;
      const Vec2 turned{cosine * p.x - sine * p.y, sine * p.x + cosine * p.y};
      EXPECT_LT(length(turned - expected[i].place_mm), 1e-7);
    }
  }
}

TEST(MeristemDynamics, PatternsOnAGrowingDomeHaveTheSameSpacingAndTheSameParastichiesInEveryMode) {
  std::vector<std::vector<double>> distances;
  std::vector<std::array<int, 2>> near_rim;
  std::vector<std::array<int, 2>> near_centre;
  for (const MeristemMode mode : kModes) {
    MeristemDynamicsParams params = growing_head(mode);
    params.interval = 0.001;
    params.area_mm2 = FunctionGraph({{0.0, 0.3}, {1.0, 0.3}});
    params.area_growth = FunctionGraph({{0.0, 0.25}, {0.15, 0.9}, {0.25, 1.0}});
    const MeristemDynamics pattern = run(params);
    const auto organs = seen_from_above(pattern, 1.0);
    ASSERT_GE(organs.size(), 220u);
    // The inner organs, counted from the centre, lie on equally large discs whatever there is around them.
    const std::span<const Seen> inner = std::span(organs).last(220);
    distances.push_back(neighbour_distances(inner));
    near_rim.push_back(parastichies(inner, 40, 80));
    near_centre.push_back(parastichies(inner, 190, 210));
  }
  for (std::size_t mode = 1; mode < kModes.size(); ++mode) {
    EXPECT_EQ(near_rim[mode], near_rim[0]);
    EXPECT_EQ(near_centre[mode], near_centre[0]);
    for (const std::size_t rank : {11u, 55u, 110u, 165u, 209u}) {
      EXPECT_NEAR(distances[mode][rank] / distances[0][rank], 1.0, 0.03) << rank;
    }
  }
  EXPECT_THAT(near_rim[0], testing::ElementsAre(21, 34));
  EXPECT_THAT(near_centre[0], testing::ElementsAre(8, 13));
}

TEST(MeristemDynamics, AgesFallTowardsTheNakedRegions) {
  for (const MeristemMode mode : kModes) {
    const FlatDisc disc = flat_disc(mode);
    for (const double time : {0.3 * disc.end, disc.end}) {
      const auto organs = seen_from_above(disc.pattern, time);
      ASSERT_GT(organs.size(), 10u);
      for (std::size_t i = 1; i < organs.size(); ++i) {
        if (organs[i].index >= 0 && organs[i - 1].index >= 0) {
          EXPECT_LT(organs[i].age, organs[i - 1].age);
        } else if (organs[i].index < 0) {
          EXPECT_GT(organs[i].age, organs[i - 1].age);
        }
      }
      const auto oldest =
          std::max_element(organs.begin(), organs.end(), [](auto& a, auto& b) { return a.age < b.age; });
      EXPECT_EQ(oldest->index, 0);
      EXPECT_EQ(oldest == organs.begin(), mode != MeristemMode::kDivergent);
    }
  }
}

// Centripetal fractionation

TEST(CentripetalFractionation, PrimordiaComeAtFixedIntervalsFromTheRimInwards) {
  const MeristemDynamics pattern = run(growing_head(MeristemMode::kCentripetal));
  const auto primordia = pattern.primordia();
  EXPECT_EQ(primordia[0].s_at_birth, 1.0);
  for (std::size_t i = 1; i < primordia.size(); ++i) {
    EXPECT_EQ(primordia[i].birth, 0.002 * static_cast<double>(i));
    EXPECT_EQ(primordia[i].index, static_cast<int>(i));
    EXPECT_LT(primordia[i].s_at_birth, primordia[i - 1].s_at_birth);
  }
}

TEST(CentripetalFractionation, EndsWhenLessThanOnePrimordiumIsLeft) {
  const MeristemDynamicsParams params = growing_head(MeristemMode::kCentripetal);
  const MeristemDynamics pattern = run(params);
  const Primordium last = pattern.primordia().back();
  ASSERT_LT(last.birth + params.interval, 1.0);  // it ended for want of room, not of time
  const double newborn = params.area_growth(0.0) * params.area_mm2(0.0);
  EXPECT_LT(pattern.naked_area_mm2(last.birth + params.interval), newborn);
  EXPECT_GE(pattern.naked_area_mm2(last.birth), 0.0);
}

// Divergent fractionation

TEST(DivergentFractionation, BeginsAtTheBorderAndTakesTurnsInwardsAndOutwards) {
  const MeristemDynamicsParams params = growing_head(MeristemMode::kDivergent);
  const MeristemDynamics pattern = run(params);
  const auto primordia = pattern.primordia();
  const SurfaceOfRevolution start = pattern.surface(0.0);
  EXPECT_NEAR(start.area_mm2(), 28.0, 1e-11);
  EXPECT_NEAR(start.area_from_apex_mm2(start.t_from_s(primordia[0].s_at_birth)), 18.0, 1e-9);
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_NEAR(primordia[i].birth, 0.001 * static_cast<double>(i), 1e-15);
    EXPECT_EQ(primordia[i].index, i % 2 == 0 ? static_cast<int>(i / 2) : -static_cast<int>(i / 2) - 1);
    if (i >= 2) {
      EXPECT_EQ(primordia[i].s_at_birth < primordia[i - 2].s_at_birth, i % 2 == 0);
    }
  }
}

TEST(DivergentFractionation, EachFrontGoesOnUntilItsOwnRegionIsUsedUp) {
  const MeristemDynamicsParams params = growing_head(MeristemMode::kDivergent);
  const MeristemDynamics pattern = run(params);
  double last_inner = 0.0;
  double last_outer = 0.0;
  for (const Primordium& primordium : pattern.primordia()) {
    (primordium.index < 0 ? last_outer : last_inner) = primordium.birth;
  }
  ASSERT_LT(last_outer + 0.01, last_inner);
  ASSERT_LT(last_inner + 0.01, 1.0);
  const double newborn = params.area_growth(0.0);
  EXPECT_LT(pattern.outer_area_mm2(last_outer + params.interval), newborn * params.area_mm2(1.0));
  EXPECT_LT(pattern.naked_area_mm2(last_inner + params.interval), newborn * params.area_mm2(0.0));
  EXPECT_GE(pattern.outer_area_mm2(1.0), 0.0);
  EXPECT_GE(pattern.naked_area_mm2(1.0), 0.0);
}

// Segregation

TEST(Segregation, PrimordiaAreBornExactlyWhereTheInnerRegionReachesTheThreshold) {
  const MeristemDynamicsParams params = growing_head(MeristemMode::kSegregation);
  const MeristemDynamics pattern = run(params);
  ASSERT_GT(pattern.primordia().size(), 100u);
  for (const Primordium& primordium : pattern.primordia()) {
    const double newborn = primordium.mature_area_mm2 * params.area_growth(0.0);
    const double just_before = std::nextafter(primordium.birth, 0.0);
    EXPECT_NEAR(pattern.naked_area_mm2(just_before), 0.9, 1e-12);
    EXPECT_NEAR(pattern.naked_area_mm2(primordium.birth), 0.9 - newborn, 1e-12);
  }
  for (int frame = 0; frame <= 5000; ++frame) {
    EXPECT_LE(pattern.naked_area_mm2(frame / 5000.0), 0.9 + 1e-12);
  }
}

TEST(Segregation, BirthsAreAsExactWhenGrowthIsGivenAsAFactor) {
  MeristemDynamicsParams params = growing_head(MeristemMode::kSegregation);
  params.meristem_growth = FunctionGraph({{0.0, 1.0}, {0.3, 1.2}, {0.6, 9.0}, {1.0, 12.0}});
  const MeristemDynamics pattern = run(params);
  ASSERT_GT(pattern.primordia().size(), 4u);
  for (const Primordium& primordium : pattern.primordia()) {
    EXPECT_NEAR(pattern.naked_area_mm2(std::nextafter(primordium.birth, 0.0)), 0.9, 1e-12);
  }
}

TEST(Segregation, PeriodFollowsTheGrowthRate) {
  MeristemDynamicsParams params = growing_head(MeristemMode::kSegregation);
  params.area_mm2 = FunctionGraph({{0.0, 0.8}, {1.0, 0.8}});
  for (const double rate : {20.0, 40.0}) {
    params.meristem_growth = GrowthFunction::from_rate(FunctionGraph({{0.0, rate}, {1.0, rate}}));
    const auto pattern = run(params);
    const auto primordia = pattern.primordia();
    EXPECT_NEAR(primordia[0].birth, math::log(0.9 / 0.4) / rate, 1e-14);
    for (std::size_t i = 1; i < primordia.size(); ++i) {
      EXPECT_NEAR(primordia[i].birth - primordia[i - 1].birth, math::log(0.9 / (0.9 - 0.2)) / rate, 1e-13);
    }
  }
}

TEST(Segregation, BeginsAsOneInnerRegion) {
  const MeristemDynamics pattern = run(growing_head(MeristemMode::kSegregation));
  EXPECT_EQ(pattern.born(0.0), 0u);
  EXPECT_NEAR(pattern.surface(0.0).area_mm2(), 0.4, 1e-13);
  EXPECT_EQ(pattern.primordia()[0].s_at_birth, 1.0);
}

// Errors

TEST(MeristemDynamics, RefusesMoreThanTheLimit) {
  for (const MeristemMode mode : kModes) {
    const auto pattern = MeristemDynamics::run(growing_head(mode), 50);
    ASSERT_FALSE(pattern);
    EXPECT_EQ(pattern.error().code, ErrorCode::kTooLarge);
  }
}

TEST(MeristemDynamics, CanBeCancelled) {
  for (const MeristemMode mode : kModes) {
    const auto pattern = MeristemDynamics::run(growing_head(mode), 10'000,
                                               [](std::string_view, double fraction) { return fraction < 0.1; });
    ASSERT_FALSE(pattern);
    EXPECT_EQ(pattern.error().code, ErrorCode::kCancelled);
  }
}

TEST(MeristemDynamics, RefusesAThresholdThatAPrimordiumWouldUseUp) {
  MeristemDynamicsParams params = growing_head(MeristemMode::kSegregation);
  params.area_growth = FunctionGraph({{0.0, 0.9}, {1.0, 1.0}});  // the first would take 0.9 of 0.9
  const auto pattern = MeristemDynamics::run(params, 1000);
  ASSERT_FALSE(pattern);
  EXPECT_EQ(to_string(pattern.error()), "threshold_area_mm2 must be > the area of a newborn primordium, 0.9, got 0.9");
}

TEST(CheckMeristemDynamics, NamesWhatIsWrong) {
  MeristemDynamicsParams params = growing_head(MeristemMode::kCentripetal);
  params.profiles[1].controls.pop_back();
  EXPECT_EQ(check(params)->where, "receptacle[1].points");
  params = growing_head(MeristemMode::kCentripetal);
  params.profiles[1].time = 0.0;
  EXPECT_EQ(check(params)->where, "receptacle[1].time");
  params = growing_head(MeristemMode::kCentripetal);
  params.interval = 0.0;
  EXPECT_EQ(check(params)->where, "interval");
  params = growing_head(MeristemMode::kDivergent);
  params.outer_area_mm2 = -1.0;
  EXPECT_EQ(check(params)->where, "outer_area_mm2");
  params = growing_head(MeristemMode::kSegregation);
  params.threshold_area_mm2 = 0.3;
  EXPECT_EQ(check(params)->where, "threshold_area_mm2");
}

}  // namespace
}  // namespace anthesis
