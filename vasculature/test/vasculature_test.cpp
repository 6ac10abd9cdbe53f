#include "anthesis/vasculature/vasculature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "anthesis/base/parallel.h"
#include "anthesis/vasculature/vein_measures.h"
#include "own_heads.h"

namespace anthesis {
namespace {

using test::on_top;
using test::plain_veins;
using test::still_cylinder;

Vasculature grown(const VeinParams& params, const HeadGrowth& growth, const std::vector<VeinPrimordium>& primordia,
                  const VeinOptions& options = {}) {
  Expected<Vasculature> veins = grow_veins(params, growth, primordia, options);
  EXPECT_TRUE(veins.has_value()) << to_string(veins.error());
  return veins ? std::move(*veins) : Vasculature{};
}

/// Where a strand leaves the vertices that its primordium made: the vertex of another strand, or of the ring.
std::uint32_t joint_of(const Vasculature& veins, std::size_t primordium) {
  std::uint32_t v = veins.primordia[primordium];
  const std::uint32_t own = veins.vertices[v].primordium;
  while (v != kNoVertex && veins.vertices[v].primordium == own) {
    v = veins.vertices[v].parent;
  }
  return v;
}

bool same(const Vasculature& a, const Vasculature& b) {
  const auto equal = [](const VeinVertex& x, const VeinVertex& y) {
    return x.position == y.position && x.parent == y.parent && x.kind == y.kind && x.age_frames == y.age_frames &&
           x.diameter == y.diameter && x.resistance == y.resistance && x.primordium == y.primordium;
  };
  return std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(), equal) &&
         a.primordia == b.primordia && a.attraction_points == b.attraction_points &&
         a.second_connections.size() == b.second_connections.size();
}

TEST(GrowVeins, ALonePrimordiumGoesStraightToTheRing) {
  const Vasculature veins = grown(plain_veins(), still_cylinder(10), {on_top(3, 2, 0.5, 0.0)});
  const VasculatureMeasures m = measure(veins);
  ASSERT_EQ(m.strands.size(), 1u);
  EXPECT_TRUE(m.strands[0].connected);
  EXPECT_EQ(m.strands[0].order, 1);
  EXPECT_NEAR(m.strands[0].length_to_ring, 1.0, 1e-9);
  EXPECT_NEAR(veins.vertices[veins.primordia[0]].resistance, 1.0, 1e-9);
  for (const VeinVertex& v : veins.vertices) {
    EXPECT_NEAR(v.position.x, 0.5, 1e-9);
    EXPECT_NEAR(v.position.y, 0.0, 1e-9);
  }
}

TEST(GrowVeins, ASecondPrimordiumJoinsTheFirstsStrandWhereSnellsLawSays) {
  // The first strand is the line from (0.5, 0, 1) down to the ring. From (0.2, 0, 0.9) the resistance r d + z is least
  // where the sine of the angle against the perpendicular is 1 / r; where that lies below the ring, at the ring.
  for (const double r : {1.05, 1.2, 2.0, 4.0}) {
    VeinParams params = plain_veins();
    params.ground_resistivity.points = {{0.0, r}};
    const Vasculature veins = grown(params, still_cylinder(20), {on_top(0, 2, 0.5, 0.0), on_top(1, 10, 0.2, 0.0)});
    const double below = 0.3 / std::sqrt(r * r - 1.0);
    const Vec3 joint = veins.vertices[joint_of(veins, 1)].position;
    EXPECT_NEAR(joint.z, std::max(0.9 - below, 0.0), 0.02) << r;
    const double least = r * std::hypot(0.3, std::min(below, 0.9)) + std::max(0.9 - below, 0.0);
    // The strand is mature at once, so the way itself costs no more than 1 a length.
    const double way = std::hypot(0.3, 0.9 - joint.z) + joint.z + 0.1;
    EXPECT_NEAR(veins.vertices[veins.primordia[1]].resistance, way, 0.02) << r;
    EXPECT_LE(way - 0.1, least + 0.01);
  }
}

TEST(GrowVeins, ARingOfPrimordiaMakesASymmetricPattern) {
  constexpr std::uint32_t kCount = 12;
  VeinParams params = plain_veins();
  params.ring_vertices = kCount;
  std::vector<VeinPrimordium> primordia;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    primordia.push_back(on_top(i, 1, 0.8, math::kTurnRad * i / kCount));
  }
  const Vasculature veins = grown(params, still_cylinder(10), primordia);
  const VasculatureMeasures m = measure(veins);
  EXPECT_EQ(m.bundles, kCount);
  EXPECT_EQ(m.joints, 0u);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    EXPECT_EQ(m.strands[i].bundle, i);
    EXPECT_NEAR(m.strands[i].length_to_ring, m.strands[0].length_to_ring, 1e-9);
    EXPECT_NEAR(m.strands[i].turned_rad, 0.0, 1e-9);
    EXPECT_EQ(veins.vertices[i].diameter, veins.vertices[0].diameter);
  }
}

TEST(GrowVeins, PrefersTheOlderOfTwoStrandsEquallyNear) {
  // Strands go down at 0 and 90 degrees; the newcomer stands between, a hair nearer to the younger one, so that
  // distance alone would decide for that.
  for (const bool first_is_left : {true, false}) {
    VeinParams params = plain_veins();
    params.ring_vertices = 4;
    params.ground_resistivity.points = {{0.0, 2.0}};
    params.age_weight = 1.0;
    const double first = first_is_left ? 0.5 * math::kPi : 0.0;
    const double second = 0.5 * math::kPi - first;
    const double between = 0.5 * first + 0.5 * second + 0.01 * (second - first);
    const std::vector<VeinPrimordium> primordia = {on_top(0, 2, 0.5, first), on_top(1, 60, 0.5, second),
                                                   on_top(2, 120, 0.5, between)};
    const Vasculature veins = grown(params, still_cylinder(200), primordia);
    EXPECT_EQ(veins.vertices[joint_of(veins, 2)].primordium, 0u);
    params.age_weight = 0.0;
    const Vasculature by_distance = grown(params, still_cylinder(200), primordia);
    EXPECT_EQ(by_distance.vertices[joint_of(by_distance, 2)].primordium, 1u);
  }
}

TEST(GrowVeins, SectorialityKeepsStrandsInTheirRadialPlane) {
  // One strand in the plane of the newcomer but 0.4 away, another across it and 0.25 away.
  for (const SectorRule rule : {SectorRule::kSquaredDistance, SectorRule::kFourthPower}) {
    for (const bool sectorial : {false, true}) {
      VeinParams params = plain_veins();
      params.ring_vertices = 4;
      params.ground_resistivity.points = {{0.0, 8.0}};
      params.sector_rule = rule;
      params.sector_weight = sectorial ? 1000.0 : 0.0;
      const double plane = 0.7;
      const std::vector<VeinPrimordium> primordia = {
          on_top(0, 2, 0.9, plane), on_top(1, 2, 0.5, plane + 2.0 * math::asin(0.25)), on_top(2, 10, 0.5, plane)};
      const Vasculature veins = grown(params, still_cylinder(20), primordia);
      EXPECT_EQ(veins.vertices[joint_of(veins, 2)].primordium, sectorial ? 0u : 1u);
    }
  }
}

TEST(GrowVeins, WaitsForTheFirstStartAndForDelays) {
  VeinParams params = plain_veins();
  params.first_start = 0.45;  // frames from 50 on
  params.initials[0].delay_frames = {7, 7};
  const std::vector<VeinPrimordium> primordia = {on_top(0, 10, 0.5, 0.0), on_top(1, 70, 0.3, 1.0)};
  VeinOptions options;
  options.frames = {49, 50, 76, 77};
  std::vector<std::pair<bool, bool>> connected;
  options.at_frame = [&](std::uint32_t, const Vasculature& veins) {
    const auto is = [&](std::size_t p) {
      return veins.primordia[p] != kNoVertex && std::isfinite(veins.vertices[veins.primordia[p]].resistance);
    };
    connected.emplace_back(is(0), is(1));
  };
  grown(params, still_cylinder(111), primordia, options);
  EXPECT_EQ(connected,
            (std::vector<std::pair<bool, bool>>{{false, false}, {true, false}, {true, false}, {true, true}}));
}

TEST(GrowVeins, SecondConnectionsNeedALimitThatAllowsThem) {
  VeinParams params = plain_veins();
  params.ring_vertices = 16;
  params.ground_resistivity.points = {{0.0, 2.0}};
  params.reticulation.rule = ReticulationRule::kLeastResistance;
  params.reticulation.delay_frames = 20;
  std::vector<VeinPrimordium> primordia;
  for (std::uint32_t i = 0; i < 40; ++i) {
    primordia.push_back(on_top(i, 1 + i, 0.9 - 0.015 * i, 2.399963 * i));
  }
  for (const auto& [limit, count] : {std::pair(0.0, 0u), std::pair(1e6, 40u)}) {
    params.reticulation.ratio_limit = limit;
    const Vasculature veins = grown(params, still_cylinder(100), primordia);
    EXPECT_EQ(veins.second_connections.size(), count);
    for (const SecondConnection& second : veins.second_connections) {
      std::set<std::uint32_t> first_way;
      for (std::uint32_t v = second.from; v >= veins.ring_vertices; v = veins.vertices[v].parent) {
        first_way.insert(v);
      }
      EXPECT_EQ(first_way.count(second.to), 0u);  // another way indeed
      EXPECT_TRUE(std::isfinite(veins.vertices[second.to].resistance));
      EXPECT_GT(second.diameter, 0.0);
    }
    // What the tips send arrives at the ring: nothing runs in circles.
    double ring = 0.0;
    for (std::size_t v = 0; v < veins.ring_vertices; ++v) {
      ring += std::pow(veins.vertices[v].diameter, params.murray_exponent);
    }
    EXPECT_NEAR(ring, 40.0 * std::pow(params.tip_diameter_mm[1], params.murray_exponent), 1e-12 * ring);
  }
}

TEST(GrowVeins, TheRingNeedsARadius) {
  VeinParams params = plain_veins();
  params.ring_vertices = 8;
  params.ring_inset_mm = 0.6;  // the ring's radius is 0.5
  const auto veins = grow_veins(params, still_cylinder(10), std::vector{on_top(0, 1, 0.6, 0.0)});
  ASSERT_FALSE(veins.has_value());
  EXPECT_EQ(to_string(veins.error()), "ring_inset_mm must be less than the ring's radius of 0.5, got 0.6");
}

TEST(GrowVeins, NoMomentumCarriesAStrandAway) {
  VeinParams params = plain_veins();
  params.momentum = 1e6;
  const Vasculature veins =
      grown(params, still_cylinder(100), {on_top(0, 1, 0.6, 0.0), on_top(1, 30, 0.7, 0.1), on_top(2, 60, 0.7, 3.0)});
  for (std::size_t v = veins.ring_vertices; v < veins.vertices.size(); ++v) {
    EXPECT_TRUE(std::isfinite(veins.vertices[v].resistance)) << v;
    EXPECT_LT(length(veins.vertices[v].position), 100.0) << v;
  }
}

TEST(GrowVeins, StrandsThickenWithTheirAgeAndByTheirCourse) {
  VeinParams params = plain_veins();
  const std::vector<VeinPrimordium> primordia = {on_top(0, 1, 0.6, 0.0), on_top(1, 60, 0.7, 3.0)};
  const Vasculature full = grown(params, still_cylinder(100), primordia);
  params.diameter_course.points = {{0.0, 0.2}, {1.0, 0.5}};
  params.fade_in_frames = 50;
  const Vasculature faded = grown(params, still_cylinder(100), primordia);
  ASSERT_EQ(full.vertices.size(), faded.vertices.size());
  std::set<double> shares;
  for (std::size_t v = full.ring_vertices; v < full.vertices.size(); ++v) {
    const double age = std::min(1.0, full.vertices[v].age_frames / 50.0);
    const double share = 0.5 * age * age * (3.0 - 2.0 * age);
    EXPECT_NEAR(faded.vertices[v].diameter, share * full.vertices[v].diameter, 1e-12);
    shares.insert(share);
  }
  EXPECT_GE(shares.size(), 2u);  // an old strand and a young one
  EXPECT_EQ(*shares.rbegin(), 0.5);
}

TEST(GrowVeins, AdaxialStrandsGrowTowardsTheirSourcesAndUseThemUp) {
  VeinParams params = plain_veins();
  params.ring_vertices = 8;
  params.colonisation.enabled = true;
  params.colonisation.window = {0.2, 0.21};
  params.colonisation.s.points = {{0.0, 0.2}};  // radius 0.4 on the top
  params.colonisation.depth_mm = {0.3, 0.3};
  params.colonisation.spacing_mm = 0.02;
  params.colonisation.kill_distance_mm = 0.05;
  params.colonisation.step_mm = 0.01;
  VeinOptions options;
  options.frames = {205};
  std::size_t first = 0;
  options.at_frame = [&](std::uint32_t, const Vasculature& veins) { first = veins.attraction_points.size(); };
  const Vasculature veins = grown(params, still_cylinder(1001), {on_top(0, 5, 0.9, 0.0)}, options);
  EXPECT_GT(first, 0u);
  EXPECT_EQ(veins.attraction_points.size(), 0u);
  double highest = 0.0;
  for (const VeinVertex& v : veins.vertices) {
    if (v.kind == VeinKind::kAdaxial) {
      highest = std::max(highest, v.position.z);
      EXPECT_TRUE(std::isfinite(v.resistance));
      EXPECT_LE(v.position.z, 0.75);  // not beyond the attraction points, at height 0.7
    }
  }
  EXPECT_GT(highest, 0.6);
}

TEST(GrowVeins, GerberaOnAHeadOfOurOwn) {
  const test::SaucerHead head = test::saucer_head(400, 0.25, 3);
  for (const VeinSource source : {VeinSource::kAsPublished, VeinSource::kPaper}) {
    const VeinParams params = gerbera_veins(source);
    const Vasculature veins = grown(params, mean_value_growth(head.outlines), head.primordia);
    const VasculatureMeasures m = measure(veins);
    std::size_t adaxial = 0;
    for (const VeinVertex& v : veins.vertices) {
      adaxial += v.kind == VeinKind::kAdaxial;
      EXPECT_TRUE(v.parent == kNoVertex || v.parent < veins.vertices.size());
    }
    EXPECT_GT(adaxial, 100u);
    EXPECT_GE(m.tips, head.primordia.size());
    for (const StrandMeasures& strand : m.strands) {
      EXPECT_TRUE(strand.connected);
    }
  }
}

TEST(GrowVeins, MakesAForestRootedInTheRing) {
  const test::SaucerHead head = test::saucer_head(400, 0.25, 3);
  for (const VeinParams& params : {bellis_veins(VeinSource::kAsPublished), bellis_veins(VeinSource::kPaper),
                                   sunflower_veins(VeinSource::kAsPublished)}) {
    const Vasculature veins = grown(params, mean_value_growth(head.outlines), head.primordia);
    for (std::uint32_t v = 0; v < veins.vertices.size(); ++v) {
      std::uint32_t root = v;
      for (std::size_t steps = 0; veins.vertices[root].parent != kNoVertex; ++steps) {
        ASSERT_LT(steps, veins.vertices.size());  // no circle
        const std::uint32_t below = veins.vertices[root].parent;
        EXPECT_LE(veins.vertices[below].resistance, veins.vertices[root].resistance);
        EXPECT_TRUE(std::isfinite(veins.vertices[root].resistance));
        root = below;
      }
      const bool waits = root == v && std::count(veins.primordia.begin(), veins.primordia.end(), v) == 1;
      EXPECT_TRUE(root < veins.ring_vertices || waits) << v;
    }
  }
}

TEST(GrowVeins, IsTheSameForAnyNumberOfThreads) {
  const test::SaucerHead head = test::saucer_head(300, 0.2, 5);
  const VeinParams params = gerbera_veins(VeinSource::kAsPublished);
  const HeadGrowth growth = mean_value_growth(head.outlines);
  std::vector<Vasculature> results;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    results.push_back(grown(params, growth, head.primordia));
  }
  EXPECT_TRUE(same(results[0], results[1]));
  EXPECT_TRUE(same(results[0], results[2]));
}

TEST(GrowVeins, LookingAtFramesLeavesNoTrace) {
  const test::SaucerHead head = test::saucer_head(300, 0.2, 5);
  const VeinParams params = bellis_veins(VeinSource::kAsPublished);
  const HeadGrowth growth = mean_value_growth(head.outlines);
  VeinOptions options;
  options.frames = {0, 7, 100, 203, 299};
  std::vector<std::uint32_t> seen;
  Vasculature last;
  options.at_frame = [&](std::uint32_t frame, const Vasculature& veins) {
    seen.push_back(frame);
    last = veins;
  };
  const Vasculature veins = grown(params, growth, head.primordia, options);
  EXPECT_EQ(seen, options.frames);
  EXPECT_TRUE(same(veins, last));
  EXPECT_TRUE(same(veins, grown(params, growth, head.primordia)));
}

TEST(GrowVeins, ASeedIsAHeadOfItsOwn) {
  const test::SaucerHead head = test::saucer_head(300, 0.2, 5);
  const VeinParams params = sunflower_veins(VeinSource::kAsPublished);
  const HeadGrowth growth = mean_value_growth(head.outlines);
  VeinOptions one;
  VeinOptions two;
  two.seed = 2;
  EXPECT_FALSE(same(grown(params, growth, head.primordia, one), grown(params, growth, head.primordia, two)));
}

TEST(GrowVeins, PrimordiaStayOnTheSurface) {
  const test::SaucerHead head = test::saucer_head(300, 0.2, 5);
  VeinOptions options;
  options.stride = 1;
  const Vasculature veins =
      grown(bellis_veins(VeinSource::kAsPublished), mean_value_growth(head.outlines), head.primordia, options);
  const std::span<const Vec2> outline = head.outlines.frame(299);
  for (const std::uint32_t v : veins.primordia) {
    ASSERT_NE(v, kNoVertex);
    const Vec2 p = {std::hypot(veins.vertices[v].position.x, veins.vertices[v].position.y),
                    veins.vertices[v].position.z};
    double nearest = 1e300;
    for (std::size_t i = 1; i < outline.size(); ++i) {
      const Vec2 edge = outline[i] - outline[i - 1];
      const double t = std::clamp(dot(p - outline[i - 1], edge) / dot(edge, edge), 0.0, 1.0);
      nearest = std::min(nearest, length(p - lerp(outline[i - 1], outline[i], t)));
    }
    EXPECT_LT(nearest, 1e-6);
  }
}

TEST(GrowVeins, NamesWhatIsWrong) {
  const HeadGrowth growth = still_cylinder(10);
  const auto where = [&](const VeinParams& params, std::vector<VeinPrimordium> primordia, VeinOptions options = {}) {
    const Expected<Vasculature> veins = grow_veins(params, growth, primordia, options);
    return veins ? std::string("nothing") : veins.error().where;
  };
  EXPECT_EQ(where(plain_veins(), {}), "nothing");
  EXPECT_EQ(where(plain_veins(), {on_top(0, 0, 0.5, 0.0), on_top(1, 0, 2.1, 0.0)}), "primordia[1].s");
  EXPECT_EQ(where(plain_veins(), {on_top(0, 0, 0.5, std::nan(""))}), "primordia[0].azimuth_rad");
  EXPECT_EQ(where(plain_veins(), {on_top(4, 0, 0.5, 0.0), on_top(4, 0, 0.6, 0.0)}), "primordia[1].id");
  VeinParams params = plain_veins();
  params.ring_vertices = 0;
  EXPECT_EQ(where(params, {}), "ring_vertices");
  VeinOptions options;
  options.stride = 0;
  EXPECT_EQ(where(plain_veins(), {}, options), "stride");
}

TEST(GrowVeins, StopsWhenAsked) {
  VeinOptions options;
  options.progress = [](std::string_view, double fraction) { return fraction < 0.5; };
  const Expected<Vasculature> veins =
      grow_veins(plain_veins(), still_cylinder(100), std::vector{on_top(0, 1, 0.5, 0.0)}, options);
  ASSERT_FALSE(veins.has_value());
  EXPECT_EQ(veins.error().code, ErrorCode::kCancelled);
}

TEST(MakeBirthsAscend, MovesEarlyBirthsBehindTheirPredecessor) {
  std::vector<VeinPrimordium> primordia(4);
  const std::uint32_t ids[] = {2, 0, 1, 3};
  const std::uint32_t births[] = {5, 10, 7, 40};
  for (std::size_t i = 0; i < 4; ++i) {
    primordia[i].id = ids[i];
    primordia[i].birth_frame = births[i];
  }
  make_births_ascend(primordia);
  std::vector<std::uint32_t> repaired;
  for (const VeinPrimordium& p : primordia) {
    repaired.push_back(p.birth_frame);
  }
  EXPECT_EQ(repaired, (std::vector<std::uint32_t>{10, 11, 12, 40}));
}

}  // namespace
}  // namespace anthesis
