#include "anthesis/phyllotaxis/parastichies.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/random.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {
namespace {

using Numbers = std::array<std::uint32_t, 2>;

Numbers numbers(const ParastichyRegion& region) {
  return {region.m.number, region.n.number};
}

std::vector<Numbers> pairs(const Parastichies& found) {
  std::vector<Numbers> result;
  for (const ParastichyRegion& region : found.regions) {
    result.push_back(numbers(region));
  }
  return result;
}

// ---- lattices on the unrolled surface: azimuth against u

struct LatticePlan {
  std::uint32_t right = 1;  ///< parastichies that turn counter-clockwise outwards
  std::uint32_t left = 1;
  double angle_deg = 90.0;  ///< between the two directions
  double rows = 10.0;
  double noise = 0.0;  ///< standard deviation of each coordinate, in steps
  std::uint64_t seed = 1;
};

/// All organs of a rhombic lattice that closes around the axis, by height, no two at one place.
std::vector<Vec2> lattice_places(const LatticePlan& plan) {
  // left steps along the right-turning direction and right steps back along the other lead once around the axis.
  const double p = plan.left;
  const double q = plan.right;
  const double half = 0.5 * math::radians(plan.angle_deg);
  Vec2 a = {math::cos(half), math::sin(half)};
  Vec2 b = {-math::cos(half), math::sin(half)};
  const Vec2 closing = p * a - q * b;
  const double step = math::kTurnRad / length(closing);
  const double turn = -math::atan2(closing.y, closing.x);
  const auto [sin, cos] = math::sin_cos(turn);
  a = step * Vec2{cos * a.x - sin * a.y, sin * a.x + cos * a.y};
  b = step * Vec2{cos * b.x - sin * b.y, sin * b.x + cos * b.y};
  std::vector<Vec2> places;
  const double height = plan.rows * step;
  // Along each line of direction b, those between bottom and top.
  const int reach = static_cast<int>(plan.rows + p + q) * 2;
  for (int x = -reach; x <= reach; ++x) {
    for (double y = std::ceil(-x * a.y / b.y); x * a.y + y * b.y < height; y += 1.0) {
      const Vec2 place = static_cast<double>(x) * a + y * b;
      if (place.x > -1e-9 && place.x < math::kTurnRad - 1e-9) {
        places.push_back(place);
      }
    }
  }
  std::sort(places.begin(), places.end(), [](Vec2 v, Vec2 w) { return v.y != w.y ? v.y < w.y : v.x < w.x; });
  for (std::size_t i = 0; i < places.size(); ++i) {
    Rng rng(plan.seed, i, RandomPurpose::kTest);
    places[i].x += plan.noise * step * rng.normal();
    places[i].y += plan.noise * step * rng.normal();
  }
  return places;
}

enum class Surface { kCylinder, kDisc, kCone };

std::vector<PatternOrgan> on(Surface surface, const std::vector<Vec2>& places) {
  std::vector<PatternOrgan> organs;
  for (const Vec2 place : places) {
    switch (surface) {
      case Surface::kCylinder:
        organs.push_back({place.x, 3.0 * place.y, 3.0, -3.0 * place.y});
        break;
      case Surface::kDisc: {
        const double r = math::exp(place.y);
        organs.push_back({place.x, r, r, 0.0});
        break;
      }
      case Surface::kCone: {  // half angle 30 degrees: r = s / 2, and u = 2 log s
        const double s = math::exp(0.5 * place.y);
        organs.push_back({place.x, s, 0.5 * s, -0.866 * s});
        break;
      }
    }
  }
  return organs;
}

std::vector<PatternOrgan> mirrored(std::vector<PatternOrgan> organs) {
  for (PatternOrgan& organ : organs) {
    organ.azimuth_rad = -organ.azimuth_rad;
  }
  return organs;
}

std::vector<PatternOrgan> vogel_disc(std::size_t count, double divergence_rad = kGoldenAngleRad) {
  std::vector<Vec2> places(count);
  place_spiral({.spacing_mm = 1.0, .divergence_rad = divergence_rad}, places);
  std::vector<PatternOrgan> organs;
  for (const Vec2 place : places) {
    organs.push_back({math::atan2(place.y, place.x), length(place), length(place), 0.0});
  }
  return organs;
}

struct Known {
  std::uint32_t m, n;
  ParastichySeries series;
  std::uint32_t jugacy;
};

const std::vector<Known> kKnown = {
    {1, 2, ParastichySeries::kFibonacci, 1},     {2, 3, ParastichySeries::kFibonacci, 1},
    {3, 5, ParastichySeries::kFibonacci, 1},     {5, 8, ParastichySeries::kFibonacci, 1},
    {8, 13, ParastichySeries::kFibonacci, 1},    {13, 21, ParastichySeries::kFibonacci, 1},
    {21, 34, ParastichySeries::kFibonacci, 1},   {34, 55, ParastichySeries::kFibonacci, 1},
    {55, 89, ParastichySeries::kFibonacci, 1},   {3, 4, ParastichySeries::kLucas, 1},
    {4, 7, ParastichySeries::kLucas, 1},         {7, 11, ParastichySeries::kLucas, 1},
    {18, 29, ParastichySeries::kLucas, 1},       {29, 47, ParastichySeries::kLucas, 1},
    {6, 10, ParastichySeries::kMultijugate, 2},  {10, 16, ParastichySeries::kMultijugate, 2},
    {26, 42, ParastichySeries::kMultijugate, 2}, {15, 24, ParastichySeries::kMultijugate, 3},
    {5, 5, ParastichySeries::kWhorled, 5},       {8, 8, ParastichySeries::kWhorled, 8},
    {12, 19, ParastichySeries::kOther, 1},       {20, 33, ParastichySeries::kOther, 1}};

TEST(SeriesOfPair, IsWhatContractionLeaves) {
  for (const Known& known : kKnown) {
    EXPECT_EQ(series_of_pair(known.m, known.n).series, known.series) << known.m << " " << known.n;
    EXPECT_EQ(series_of_pair(known.n, known.m).jugacy, known.jugacy) << known.m << " " << known.n;
  }
  EXPECT_EQ(series_of_pair(29, 47).seeds, (Numbers{1, 3}));
  EXPECT_EQ(series_of_pair(26, 42).seeds, (Numbers{1, 2}));
  EXPECT_EQ(series_of_pair(12, 21).series, ParastichySeries::kOther);  // three times Lucas
  EXPECT_EQ(series_of_pair(0, 3).series, ParastichySeries::kIrregular);
}

class KnownLattice : public testing::TestWithParam<Surface> {};

TEST_P(KnownLattice, IsCountedRightWithAndWithoutNoiseWhateverItsHand) {
  for (const Known& known : kKnown) {
    for (const double angle_deg : {80.0, 90.0, 97.0}) {
      const std::uint64_t seeds = known.m < 30 ? 6 : 3;
      for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        LatticePlan plan{.right = known.m, .left = known.n, .angle_deg = angle_deg};
        plan.noise = seed == 0 ? 0.0 : 0.05;
        plan.seed = seed;
        const std::vector<PatternOrgan> organs = on(GetParam(), lattice_places(plan));
        const Parastichies found = analyse_parastichies(organs, {.in_order_of_birth = false});
        SCOPED_TRACE(testing::Message() << known.m << " " << known.n << " angle " << angle_deg << " seed " << seed);
        ASSERT_EQ(pairs(found), std::vector<Numbers>({{known.m, known.n}}));
        const ParastichyRegion& region = found.regions[0];
        EXPECT_EQ(region.kind.series, known.series);
        EXPECT_EQ(region.kind.jugacy, known.jugacy);
        EXPECT_GT(region.regularity, seed == 0 ? 0.9 : 0.75);
        EXPECT_EQ(found.dislocations.size(), 0u);
        if (known.m != known.n) {
          EXPECT_EQ(region.m.turn, ParastichyTurn::kCounterClockwise);
          EXPECT_EQ(region.n.turn, ParastichyTurn::kClockwise);
        }
        const Parastichies mirror = analyse_parastichies(mirrored(organs), {.in_order_of_birth = false});
        ASSERT_EQ(pairs(mirror), pairs(found));
        if (known.m != known.n) {
          EXPECT_EQ(mirror.regions[0].m.turn, ParastichyTurn::kClockwise);
          EXPECT_EQ(mirror.regions[0].n.turn, ParastichyTurn::kCounterClockwise);
        }
      }
    }
  }
}

std::string surface_name(const testing::TestParamInfo<Surface>& info) {
  return info.param == Surface::kCylinder ? "Cylinder" : info.param == Surface::kDisc ? "Disc" : "Cone";
}
INSTANTIATE_TEST_SUITE_P(On, KnownLattice, testing::Values(Surface::kCylinder, Surface::kDisc, Surface::kCone),
                         surface_name);

TEST(Parastichies, OfVogelsDiscClimbTheFibonacciSequenceOutwardsAndTransitionsGrowByPhi) {
  const Parastichies found = analyse_parastichies(vogel_disc(3000));
  EXPECT_EQ(pairs(found), std::vector<Numbers>({{5, 8}, {8, 13}, {13, 21}, {21, 34}, {34, 55}, {55, 89}, {89, 144}}));
  for (const ParastichyRegion& region : found.regions) {
    EXPECT_EQ(region.kind.series, ParastichySeries::kFibonacci);
    EXPECT_NEAR(math::degrees(region.divergence_rad), 137.508, region.m.number < 13 ? 0.3 : 0.01);
    EXPECT_NE(region.m.turn, region.n.turn);
  }
  for (const ParastichyTransition& transition : found.transitions) {
    EXPECT_TRUE(transition.continuous);
  }
  for (std::size_t i = 3; i < found.transitions.size(); ++i) {
    EXPECT_NEAR(found.transitions[i].s_mm / found.transitions[i - 1].s_mm, std::numbers::phi, 0.12);
  }
  // The golden angle as it was put in.
  EXPECT_NEAR(found.divergence.mean_rad, kGoldenAngleRad, 1e-9);
  EXPECT_NEAR(found.divergence.deviation_rad, 0.0, 1e-9);
  EXPECT_EQ(found.divergence.turn, ParastichyTurn::kCounterClockwise);
}

TEST(Parastichies, ChangeOnceAtATransitionHoweverNoisyThePlaces) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    std::vector<PatternOrgan> organs = vogel_disc(3000);
    for (std::size_t i = 0; i < organs.size(); ++i) {
      Rng rng(seed, i, RandomPurpose::kTest);
      const double step_mm = 0.08 * 1.8;  // of the nearest neighbour's distance
      organs[i].azimuth_rad += step_mm * rng.normal() / organs[i].radius_mm;
      organs[i].s_mm = std::abs(organs[i].s_mm + step_mm * rng.normal());
      organs[i].radius_mm = organs[i].s_mm;
    }
    std::vector<Numbers> outer = pairs(analyse_parastichies(organs));
    outer.erase(outer.begin(), std::find(outer.begin(), outer.end(), Numbers{13, 21}));
    EXPECT_EQ(outer, std::vector<Numbers>({{13, 21}, {21, 34}, {34, 55}, {55, 89}, {89, 144}})) << seed;
  }
}

TEST(Parastichies, CountedAroundTheAxisAreTheDifferencesOfBirthAlongThem) {
  const Parastichies found = analyse_parastichies(vogel_disc(1000));
  for (const ParastichyRegion& region : found.regions) {
    for (const ParastichyFamily& family : {region.m, region.n}) {
      EXPECT_EQ(family.index_difference, family.number);
      EXPECT_GT(family.index_share, region.m.number < 8 ? 0.6 : 0.95);
    }
  }
}

TEST(Parastichies, DoNotDependOnTheOrderOfOrgans) {
  std::vector<PatternOrgan> organs = vogel_disc(700);
  const Parastichies in_order = analyse_parastichies(organs);
  std::reverse(organs.begin(), organs.end());
  std::rotate(organs.begin(), organs.begin() + 123, organs.end());
  const Parastichies shuffled = analyse_parastichies(organs, {.in_order_of_birth = false});
  EXPECT_EQ(pairs(shuffled), pairs(in_order));
  EXPECT_TRUE(std::isnan(shuffled.divergence.mean_rad));
  EXPECT_EQ(shuffled.regions[1].m.index_difference, 0u);
  for (std::size_t i = 1; i < in_order.regions.size(); ++i) {
    EXPECT_NEAR(shuffled.regions[i].divergence_rad, in_order.regions[i].divergence_rad, 1e-3);
  }
}

TEST(Parastichies, OfTheLucasAngleAreLucasNumbers) {
  const double lucas_rad = math::kTurnRad / (3.0 + 1.0 / std::numbers::phi);
  const Parastichies found = analyse_parastichies(vogel_disc(800, lucas_rad));
  ASSERT_GE(found.regions.size(), 3u);
  for (const ParastichyRegion& region : found.regions) {
    if (region.m.number >= 11) {
      EXPECT_EQ(region.kind.series, ParastichySeries::kLucas);
      EXPECT_NEAR(math::degrees(region.divergence_rad), 99.502, 0.05);
    }
  }
}

TEST(Parastichies, OfPlacesAtRandomAreIrregular) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<PatternOrgan> organs;
    Rng rng(seed, 0, RandomPurpose::kTest);
    for (int i = 0; i < 600; ++i) {
      const double r = 10.0 * std::sqrt(rng.uniform());
      organs.push_back({rng.uniform(0.0, math::kTurnRad), r, r, 0.0});
    }
    const Parastichies found = analyse_parastichies(organs, {.in_order_of_birth = false});
    std::size_t irregular = 0;
    for (const ParastichyRegion& region : found.regions) {
      irregular += region.kind.series == ParastichySeries::kIrregular ? region.organs : 0;
    }
    EXPECT_GT(irregular, 500u) << seed;
  }
}

/// Two lattices of equal spacing, one above the other.
TEST(Parastichies, DislocationsAccountForEveryParastichyGained) {
  const LatticePlan below{.right = 13, .left = 21, .rows = 8.0};
  const LatticePlan above{.right = 15, .left = 22, .rows = 8.0};
  std::vector<Vec2> places = lattice_places(below);
  const double step = math::kTurnRad / std::sqrt(13.0 * 13.0 + 21.0 * 21.0);
  for (const Vec2 place : lattice_places(above)) {
    places.push_back({place.x, place.y + 8.0 * step});
  }
  const Parastichies found = analyse_parastichies(on(Surface::kCylinder, places), {.in_order_of_birth = false});
  ASSERT_GE(found.regions.size(), 2u);
  EXPECT_EQ(numbers(found.regions.front()), (Numbers{13, 21}));
  EXPECT_EQ(numbers(found.regions.back()), (Numbers{15, 22}));
  ASSERT_FALSE(found.dislocations.empty());
  std::array<std::int32_t, 2> gained{};
  for (const ParastichyDislocation& dislocation : found.dislocations) {
    EXPECT_NEAR(dislocation.s_mm, 3.0 * 8.0 * step, 3.0 * 2.0 * step);
    gained[0] += dislocation.gained[0];
    gained[1] += dislocation.gained[1];
  }
  EXPECT_EQ(gained, (std::array<std::int32_t, 2>{2, 1}));
}

TEST(Parastichies, TouchFourNeighboursInASquareLatticeAndSixInAHexagonalOne) {
  for (const auto& [angle_deg, contacts] : {std::pair(90.0, 4u), std::pair(60.0, 6u)}) {
    const Parastichies found =
        analyse_parastichies(on(Surface::kCylinder, lattice_places({.right = 8, .left = 13, .angle_deg = angle_deg})),
                             {.in_order_of_birth = false});
    std::map<std::uint32_t, int> counts;
    for (std::size_t i = 40; i + 40 < found.organs.size(); ++i) {
      ++counts[found.organs[i].contacts];
    }
    EXPECT_EQ(counts.size(), 1u) << angle_deg;
    EXPECT_EQ(counts.begin()->first, contacts) << angle_deg;
  }
}

TEST(Parastichies, PlastochronRatioIsTheGrowthOfTheRadiusPerOrgan) {
  const LatticePlan plan{.right = 5, .left = 8};
  const std::vector<PatternOrgan> organs = on(Surface::kDisc, lattice_places(plan));
  const Parastichies found = analyse_parastichies(organs);
  const double ratio =
      std::pow(organs.back().radius_mm / organs.front().radius_mm, 1.0 / static_cast<double>(organs.size() - 1));
  EXPECT_NEAR(found.divergence.plastochron_ratio, ratio, 1e-9);
  EXPECT_NEAR(found.regions[0].plastochron_ratio, ratio, 1e-3);
}

TEST(Parastichies, LinksOfAFamilyAreAsManyAsItsStepsBetweenOrgans) {
  const Parastichies found = analyse_parastichies(vogel_disc(600));
  for (const ParastichyLink& link : found.links) {
    const std::uint32_t difference =
        std::max(link.organs[0], link.organs[1]) - std::min(link.organs[0], link.organs[1]);
    if (link.family != 0 && link.organs[0] > 100) {
      EXPECT_EQ(difference, link.number);
    }
  }
}

TEST(Parastichies, SurviveInputThatIsNoPattern) {
  EXPECT_TRUE(analyse_parastichies({}).regions.empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<PatternOrgan> organs = vogel_disc(200);
  organs[7].azimuth_rad = nan;
  organs[8].s_mm = std::numeric_limits<double>::infinity();
  organs[9].radius_mm = 0.0;
  organs.push_back(organs[100]);
  const Parastichies found = analyse_parastichies(organs);
  EXPECT_EQ(found.left_out, 4u);
  EXPECT_TRUE(std::isnan(found.organs[7].u));
  EXPECT_FALSE(found.regions.empty());
  // All at one place, all on a circle, all on a line.
  for (const Vec2 step : {Vec2{0.0, 0.0}, Vec2{0.1, 0.0}, Vec2{0.0, 0.1}}) {
    std::vector<PatternOrgan> odd;
    for (int i = 0; i < 50; ++i) {
      odd.push_back({step.x * i, 1.0 + step.y * i, 1.0, 0.0});
    }
    for (const ParastichyRegion& region : analyse_parastichies(odd).regions) {
      EXPECT_EQ(region.kind.series, ParastichySeries::kIrregular);
    }
  }
}

TEST(Parastichies, AreTheSameForAnyNumberOfThreads) {
  const std::vector<PatternOrgan> organs = vogel_disc(2000);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return analyse_parastichies(organs);
  };
  const Parastichies one = run(1);
  const Parastichies two = run(2);
  ASSERT_EQ(pairs(one), pairs(two));
  for (std::size_t i = 0; i < one.regions.size(); ++i) {
    EXPECT_EQ(one.regions[i].regularity, two.regions[i].regularity);
    EXPECT_EQ(one.regions[i].divergence_rad, two.regions[i].divergence_rad);
  }
}

TEST(PatternOrgans, FindTheProfileOfADomeUnderItsOrgans) {
  // Two thirds of a sphere of radius 5: the profile turns back below the equator.
  std::vector<Vec3> positions;
  std::vector<double> truth_mm;
  constexpr int kOrgans = 800;
  for (int i = 0; i < kOrgans; ++i) {
    const double z = 1.0 - 1.33 * (i + 0.5) / kOrgans;
    const double r = std::sqrt(1.0 - z * z);
    const auto [sin, cos] = math::sin_cos(i * kGoldenAngleRad);
    Rng rng(1, static_cast<std::uint64_t>(i), RandomPurpose::kTest);
    const double bump = 1.0 + 0.005 * rng.normal();
    positions.push_back({5.0 * bump * r * cos, 5.0 * bump * r * sin, 5.0 * bump * z});
    truth_mm.push_back(5.0 * math::acos(z));
  }
  const std::vector<PatternOrgan> organs = pattern_organs(positions);
  double worst = 0.0;
  for (std::size_t i = 1; i < organs.size(); ++i) {
    worst = std::max(worst, std::abs((organs[i].s_mm - organs[0].s_mm) - (truth_mm[i] - truth_mm[0])));
  }
  EXPECT_LT(worst, 0.15);  // of 9.5 mm
  const Parastichies found = analyse_parastichies(organs, {.in_order_of_birth = false});
  for (const ParastichyRegion& region : found.regions) {
    EXPECT_EQ(region.kind.series, ParastichySeries::kFibonacci) << region.m.number << " " << region.n.number;
  }
  EXPECT_THAT(pairs(found), testing::Contains(Numbers{21, 34}));
}

// ---- published heads

std::filesystem::path reference() {
  const char* given = std::getenv("ANTHESIS_REFERENCE");
  return given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT;
}

/// Primordia of a published model (id, step, share of the profile's length, azimuth) on its last curve.
std::vector<PatternOrgan> read_head(const std::filesystem::path& primordia, const std::filesystem::path& curves,
                                    int curve) {
  std::vector<Vec2> profile;
  std::string line;
  for (std::ifstream file(curves); std::getline(file, line);) {
    int id = 0;
    double s = 0.0;
    Vec2 place;
    if (std::sscanf(line.c_str(), "%d,%lf,%lf,%lf", &id, &s, &place.x, &place.y) == 4 && id == curve) {
      profile.push_back(place);
    }
  }
  double length_mm = 0.0;
  for (std::size_t i = 1; i < profile.size(); ++i) {
    length_mm += length(profile[i] - profile[i - 1]);
  }
  std::map<int, PatternOrgan> organs;
  for (std::ifstream file(primordia); std::getline(file, line);) {
    int id = 0;
    int step = 0;
    double s = 0.0;
    double azimuth = 0.0;
    if (std::sscanf(line.c_str(), "%d %d %lf %lf", &id, &step, &s, &azimuth) == 4 && profile.size() > 1) {
      const double at = s * static_cast<double>(profile.size() - 1);
      const std::size_t i = std::min(static_cast<std::size_t>(at), profile.size() - 2);
      const Vec2 place = lerp(profile[i], profile[i + 1], at - static_cast<double>(i));
      organs[id] = {azimuth, s * length_mm, place.x, place.y};
    }
  }
  std::vector<PatternOrgan> result;
  for (const auto& [id, organ] : organs) {
    result.push_back(organ);
  }
  return result;
}

class PublishedHead : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(heads_)) {
      GTEST_SKIP() << "no reference data in " << reference() << "; set ANTHESIS_REFERENCE";
    }
  }
  std::filesystem::path heads_ = reference() / "heads";
};

TEST_F(PublishedHead, SunflowerHas13And21InsideAnd21And34Outside) {
  const std::vector<PatternOrgan> organs =
      read_head(heads_ / "sunflower/sunflower_final.prims", heads_ / "sunflower/evaluated/curves.csv", 9);
  ASSERT_EQ(organs.size(), 497u);
  const Parastichies found = analyse_parastichies(organs);
  std::map<Numbers, std::size_t> regular;
  for (const ParastichyRegion& region : found.regions) {
    if (region.kind.series != ParastichySeries::kIrregular) {
      regular[numbers(region)] += region.organs;
      if (region.m.number >= 13) {
        EXPECT_EQ(region.kind.series, ParastichySeries::kFibonacci);
        EXPECT_NEAR(math::degrees(region.divergence_rad), 137.5, 0.2);
      }
    }
  }
  EXPECT_GT((regular[{13, 21}]), 50u);
  EXPECT_GT((regular[{21, 34}]), 300u);
  EXPECT_EQ(numbers(found.regions.back()), (Numbers{21, 34}));
  const Parastichies mirror = analyse_parastichies(mirrored(organs));
  EXPECT_EQ(pairs(mirror).back(), (Numbers{21, 34}));
  EXPECT_EQ(static_cast<int>(mirror.regions.back().m.turn), -static_cast<int>(found.regions.back().m.turn));
}

TEST_F(PublishedHead, BellisHas8And13AtTheRimAndIsIrregularInside) {
  const std::vector<PatternOrgan> organs =
      read_head(heads_ / "bellis/vasculature/bellis_final.prims", heads_ / "bellis/evaluated/curves.csv", 7);
  ASSERT_EQ(organs.size(), 420u);
  const Parastichies found = analyse_parastichies(organs);
  EXPECT_EQ(numbers(found.regions.back()), (Numbers{8, 13}));
  EXPECT_EQ(found.regions.back().kind.series, ParastichySeries::kFibonacci);
  std::size_t irregular = 0;
  for (const ParastichyRegion& region : found.regions) {
    irregular += region.kind.series == ParastichySeries::kIrregular ? region.organs : 0;
  }
  EXPECT_GT(irregular, 350u);
}

TEST_F(PublishedHead, TheLaterBellisHasNoConsistentPairAtAll) {
  const std::vector<PatternOrgan> organs =
      read_head(heads_ / "bellis/bellis_final.prims", heads_ / "bellis/evaluated/curves.csv", 7);
  ASSERT_EQ(organs.size(), 367u);
  for (const ParastichyRegion& region : analyse_parastichies(organs).regions) {
    EXPECT_EQ(region.kind.series, ParastichySeries::kIrregular);
  }
}

}  // namespace
}  // namespace anthesis
