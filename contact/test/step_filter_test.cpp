#include "step_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "anthesis/base/math.h"
#include "anthesis/base/random.h"
#include "anthesis/contact/continuous.h"
#include "anthesis/contact/crossings.h"
#include "anthesis/contact/growing_sheets.h"
#include "sheets.h"

namespace anthesis {
namespace {

constexpr double kEdge_mm = 0.5;
constexpr double kThickness_mm = 0.1;
constexpr double kFractions[] = {0.1, 0.25, 0.5, 0.75, 0.9, 1.0};

constexpr std::uint32_t kPetalColumns = 4;
constexpr std::uint32_t kTubeColumns = 6;

Vec3 place_in(std::uint32_t sheet, std::uint32_t vertex) {
  const std::uint32_t columns = sheet == 1 ? kTubeColumns : kPetalColumns;
  const double column = vertex % columns;
  const double row = static_cast<double>(vertex / columns) - 1.5;
  if (sheet == 1) {
    const auto [sine, cosine] = math::sin_cos(math::radians(360.0 / kTubeColumns * column));
    return {0.4 * cosine, 0.4 * sine, kEdge_mm * row};
  }
  return {kEdge_mm * (column - 1.5), 0.1 * row * row, kEdge_mm * row};
}

/// A petal, a narrow tube, and a single triangle.
const std::vector<Sheet>& sheets() {
  static const std::vector<Sheet> all = [] {
    std::vector<Sheet> made = {grid_sheet(kPetalColumns, 5), grid_sheet(kTubeColumns, 4, true),
                               make_sheet(3, std::vector<Triangle>{{0, 1, 2}})};
    for (std::uint32_t sheet : {0u, 1u}) {  // as organs have a shape; and one of them has none
      for (std::uint32_t i = 0; i < made[sheet].vertex_count; ++i) {
        made[sheet].shape_mm.push_back(place_in(sheet, i));
      }
    }
    return made;
  }();
  return all;
}

Vec3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

struct Scene {
  std::vector<std::uint32_t> sheet_of;  ///< by body
  std::vector<MovingBody> bodies;
  std::vector<Vec3> from_mm;
  std::vector<Vec3> to_mm;
  std::vector<Triangle> triangles;

  void add(std::uint32_t sheet, std::span<const Vec3> places, bool relaxes) {
    const auto first = static_cast<std::uint32_t>(from_mm.size());
    from_mm.insert(from_mm.end(), places.begin(), places.end());
    for (const Triangle& t : sheets()[sheet].triangles) {
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    sheet_of.push_back(sheet);
    bodies.push_back({first, static_cast<std::uint32_t>(from_mm.size()), {}, relaxes});
  }
  void remove_last() {
    from_mm.resize(bodies.back().first_vertex);
    triangles.resize(triangles.size() - sheets()[sheet_of.back()].triangles.size());
    sheet_of.pop_back();
    bodies.pop_back();
  }
  bool crosses_at(double fraction) const {
    std::vector<Vec3> places(from_mm.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i] = fraction == 1.0 ? to_mm[i] : lerp(from_mm[i], to_mm[i], fraction);
    }
    return find_crossings(places, triangles, 1)->count > 0;
  }
};

/// Two to four bodies that cross nothing, in a narrow place or in layers; and where each of them would like to go,
/// with no regard for the others.
Scene random_scene(std::uint64_t seed) {
  Rng rng(seed, 0, RandomPurpose::kTest);
  Scene scene;
  const std::size_t wanted = 2 + rng.bits() % 3;
  std::vector<Vec3> places;
  for (int attempt = 0; attempt < 100 && scene.bodies.size() < wanted; ++attempt) {
    std::uint32_t sheet = rng.bits() % 3;
    const bool layer = !scene.bodies.empty() && rng.bits() % 3 == 0;
    if (layer) {
      // A copy of the body before, anything from far below the least gap to a tenth of an edge away.
      sheet = scene.sheet_of.back();
      const Vec3 way = normalized(random_vector(rng, 1.0));
      const double distance = math::pow(10.0, rng.uniform(-4.5, -1.0));
      places.assign(scene.from_mm.begin() + scene.bodies.back().first_vertex, scene.from_mm.end());
      for (Vec3& p : places) {
        p += distance * way;
      }
    } else {
      const Vec3 centre = random_vector(rng, 1.2);
      const Quaternion turn = rotation_about(normalized(random_vector(rng, 1.0)), rng.uniform(0.0, 3.0));
      places.clear();
      for (std::uint32_t i = 0; i < sheets()[sheet].vertex_count; ++i) {
        places.push_back(centre + rotate(turn, place_in(sheet, i) + random_vector(rng, 0.1)));
      }
    }
    scene.add(sheet, places, rng.bits() % 4 != 0);
    scene.to_mm = scene.from_mm;
    if (scene.crosses_at(1.0)) {
      scene.remove_last();
    }
  }
  scene.to_mm = scene.from_mm;
  const Vec3 common = random_vector(rng, 2.0 * kEdge_mm);
  for (MovingBody& body : scene.bodies) {
    const Vec3 centre = scene.from_mm[body.first_vertex];
    const Vec3 way = std::array{Vec3{}, common, random_vector(rng, 3.0 * kEdge_mm)}[rng.bits() % 3];
    body.ride_mm = rng.bits() % 2 == 0 ? Vec3{} : way;
    const Quaternion turn =
        rng.bits() % 2 == 0 ? Quaternion{} : rotation_about(normalized(random_vector(rng, 1.0)), rng.uniform(0.0, 2.0));
    const double noise = rng.bits() % 2 == 0 ? 0.0 : rng.uniform(0.0, 3.0 * kEdge_mm);
    for (std::uint32_t i = body.first_vertex; i < body.end_vertex; ++i) {
      scene.to_mm[i] = centre + rotate(turn, scene.from_mm[i] - centre) + way + random_vector(rng, noise);
    }
  }
  return scene;
}

/// How far vertices look around beyond the least: as a share of their own moves.
enum class Look {
  kFar,     ///< all of it and a quarter more
  kAlong,   ///< along where they go and a little beside it, as the solver does
  kAnyhow,  ///< along some way or other, and besides something between nothing and all of it, each for itself
  kNear,    ///< nothing
};
constexpr Look kLooks[] = {Look::kFar, Look::kAlong, Look::kAnyhow, Look::kNear};

constexpr double kLeastReach_mm = 0.7 * kThickness_mm;
constexpr double kLeastReachWithin_mm = 0.3 * kThickness_mm;

/// Looks around and filters the move.
std::uint64_t filter(Scene& scene, Look look, StepFilter& step_filter) {
  Rng rng(scene.from_mm.size(), 2, RandomPurpose::kTest);
  std::vector<double> reach(scene.from_mm.size());
  std::vector<double> within_reach(scene.from_mm.size());
  std::vector<Vec3> way(scene.from_mm.size());
  std::vector<ContactBody> seen;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const MovingBody& body = scene.bodies[b];
    const std::uint32_t count = body.end_vertex - body.first_vertex;
    const bool moves = body.relaxes || body.ride_mm != Vec3{};
    for (std::uint32_t i = body.first_vertex; i < body.end_vertex; ++i) {
      const Vec3 own = body.relaxes ? scene.to_mm[i] - scene.from_mm[i] - body.ride_mm : Vec3{};
      double share = 0.0;
      if (look == Look::kFar) {
        share = 1.25;
      } else if (look == Look::kAlong) {
        way[i] = own + random_vector(rng, 0.1 * length(own));
        share = 0.2;
      } else if (look == Look::kAnyhow) {
        way[i] = rng.bits() % 3 == 0 ? Vec3{} : rng.uniform(-0.5, 1.5) * own + random_vector(rng, length(own));
        share = std::max(0.0, rng.uniform(-1.25, 1.25));
      }
      reach[i] = kLeastReach_mm + share * length(own);
      within_reach[i] = kLeastReachWithin_mm + share * length(own);
    }
    ContactBody outlook;
    outlook.sheet = scene.sheet_of[b];
    outlook.first_vertex = body.first_vertex;
    outlook.reach_mm = kLeastReach_mm;
    outlook.awake = moves;
    outlook.within = body.relaxes;  // the parts of a body that only rides keep their distances
    outlook.ride_mm = body.ride_mm;
    outlook.within_less_mm = kLeastReach_mm - kLeastReachWithin_mm;
    if (body.relaxes) {
      outlook.vertex_reach_mm = std::span(reach).subspan(body.first_vertex, count);
      outlook.vertex_way_mm = std::span(way).subspan(body.first_vertex, count);
    }
    seen.push_back(outlook);
  }
  std::vector<Contact> contacts;
  Detector(sheets()).find_near(scene.from_mm, seen, contacts);
  return step_filter.apply(contacts, scene.bodies, {way, reach, within_reach}, scene.from_mm, scene.to_mm);
}

/// Gaps of all pairs nearer than the least gap, at a fraction of the move.
std::vector<Contact> tight_pairs(const Scene& scene, double fraction, std::vector<Vec3>& places) {
  places.resize(scene.from_mm.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = lerp(scene.from_mm[i], scene.to_mm[i], fraction);
  }
  std::vector<ContactBody> all;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    all.push_back({scene.sheet_of[b], scene.bodies[b].first_vertex, 0.5 * kLeastGap_mm});
  }
  std::vector<Contact> contacts;
  Detector(sheets()).find_near(places, all, contacts);
  return contacts;
}

TEST(StepFilter, NothingCrossesAtAnyTimeOfAWildMove) {
  StepFilter step_filter;
  int wild = 0;
  std::uint64_t shortened = 0;
  constexpr int kScenes = 2500;
  for (int seed = 0; seed < kScenes; ++seed) {
    Scene scene = random_scene(static_cast<std::uint64_t>(seed));
    wild += std::ranges::any_of(kFractions, [&](double fraction) { return scene.crosses_at(fraction); });
    // Whether they looked far enough or not.
    shortened += filter(scene, kLooks[seed % 4], step_filter);
    for (const double fraction : kFractions) {
      ASSERT_FALSE(scene.crosses_at(fraction)) << "scene " << seed << " at " << fraction;
    }
  }
  EXPECT_GT(wild, kScenes / 2);  // or this test shows nothing
  EXPECT_GT(shortened, 10u * kScenes);
}

TEST(StepFilter, GapsNeverFallBelowTheLeastGapAndSmallerOnesDoNotShrink) {
  StepFilter step_filter;
  int tight = 0;
  for (int seed = 0; seed < 1000; ++seed) {
    Scene scene = random_scene(10'000 + static_cast<std::uint64_t>(seed));
    filter(scene, kLooks[seed % 4], step_filter);
    std::vector<Vec3> places;
    for (const double fraction : kFractions) {
      for (const Contact& contact : tight_pairs(scene, fraction, places)) {
        std::array<Vec3, 4> before;
        for (int k = 0; k < 4; ++k) {
          before[k] = scene.from_mm[contact.vertices[k]];
        }
        const double gap_before_mm =
            (contact.edges ? nearest_edge_edge(before) : nearest_vertex_triangle(before)).distance;
        ASSERT_GE(contact.gap_mm, std::min(kLeastGap_mm, gap_before_mm) - 1e-13) << "scene " << seed;
        ++tight;
      }
    }
  }
  EXPECT_GT(tight, 1000);
}

TEST(StepFilter, BodiesThatMoveTogetherAreNotShortened) {
  StepFilter step_filter;
  for (std::uint64_t seed = 20'000; seed < 20'300; ++seed) {
    Scene scene = random_scene(seed);
    std::vector<Vec3> places;
    if (!tight_pairs(scene, 0.0, places).empty()) {
      continue;  // at or below the least gap even a rounding error is held
    }
    Rng rng(seed, 1, RandomPurpose::kTest);
    const Vec3 way = random_vector(rng, 10.0 * kEdge_mm);
    for (std::size_t i = 0; i < scene.from_mm.size(); ++i) {
      scene.to_mm[i] = scene.from_mm[i] + way;
    }
    for (MovingBody& body : scene.bodies) {
      body.relaxes = true;
      // Whether they know it or not, or some do.
      body.ride_mm = std::array{Vec3{}, way, 0.5 * way}[rng.bits() % 3];
    }
    const std::vector<Vec3> wanted = scene.to_mm;
    EXPECT_EQ(filter(scene, Look::kFar, step_filter), 0u);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_LE(length(scene.to_mm[i] - wanted[i]), 1e-14);
    }
  }
}

TEST(StepFilter, AFreeBodyMovesWhereItWantsTo) {
  StepFilter step_filter;
  for (const std::uint32_t sheet : {0u, 1u, 2u}) {
    Scene scene;
    std::vector<Vec3> places;
    for (std::uint32_t i = 0; i < sheets()[sheet].vertex_count; ++i) {
      places.push_back(place_in(sheet, i));
    }
    scene.add(sheet, places, true);
    for (const Vec3 p : places) {
      scene.to_mm.push_back(1.1 * p + Vec3{3.0, -2.0, 1.0});
    }
    scene.bodies[0].ride_mm = {3.0, -2.0, 1.0};
    const std::vector<Vec3> wanted = scene.to_mm;
    EXPECT_EQ(filter(scene, Look::kFar, step_filter), 0u);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_LE(length(scene.to_mm[i] - wanted[i]), 1e-14);
    }
  }
}

TEST(StepFilter, WhatDoesNotRelaxRidesOrRests) {
  StepFilter step_filter;
  int rests = 0;
  int rides = 0;
  for (std::uint64_t seed = 30'000; seed < 30'300; ++seed) {
    Scene scene = random_scene(seed);
    filter(scene, Look::kFar, step_filter);
    for (const MovingBody& body : scene.bodies) {
      const Vec3 way = scene.to_mm[body.first_vertex] - scene.from_mm[body.first_vertex];
      for (std::uint32_t i = body.first_vertex; !body.relaxes && i < body.end_vertex; ++i) {
        if (body.ride_mm == Vec3{}) {
          ASSERT_EQ(scene.to_mm[i], scene.from_mm[i]);
          ++rests;
        } else {
          // All of it by one share of the ride.
          ASSERT_LE(length(scene.to_mm[i] - scene.from_mm[i] - way), 1e-14);
          ASSERT_LE(length(cross(way, body.ride_mm)), 1e-14);
          ASSERT_LE(length(way), length(body.ride_mm) + 1e-14);
          ++rides;
        }
      }
    }
  }
  EXPECT_GT(rests, 500);
  EXPECT_GT(rides, 500);
}

TEST(StepFilter, TwoThatDoNotSeeEachOtherStopBeforeTheyMeet) {
  StepFilter step_filter;
  Scene scene;
  const double apart_mm = 2.0 * kLeastReach_mm + 1e-6;
  const std::vector<Vec3> low = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.add(2, low, true);
  scene.add(2, std::vector<Vec3>{{0, 0, apart_mm}, {1, 0, apart_mm}, {0, 1, apart_mm}}, true);
  for (int k = 0; k < 6; ++k) {
    scene.to_mm.push_back(scene.from_mm[k] + Vec3{0, 0, k < 3 ? 1.0 : -1.0});
  }
  const std::vector<double> reach(6, kLeastReach_mm);
  step_filter.apply({}, scene.bodies, {{}, reach, reach}, scene.from_mm, scene.to_mm);
  for (int k = 0; k < 3; ++k) {
    EXPECT_GT(scene.to_mm[3 + k].z - scene.to_mm[k].z, kLeastGap_mm);
    EXPECT_LT(scene.to_mm[3 + k].z - scene.to_mm[k].z, 2.0 * kLeastGap_mm);
  }
}

TEST(StepFilter, TwoThatMeetHeadOnEachUseAtMostTheirShareOfTheRoom) {
  StepFilter step_filter;
  Scene scene;
  const std::vector<Vec3> low = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Vec3> high = {{0, 0, 0.5}, {1, 0, 0.5}, {0, 1, 0.5}};
  scene.add(2, low, true);
  scene.add(2, high, true);
  for (const Vec3 p : low) {
    scene.to_mm.push_back(p + Vec3{0, 0, 1});
  }
  for (const Vec3 p : high) {
    scene.to_mm.push_back(p - Vec3{0, 0, 1});
  }
  EXPECT_EQ(filter(scene, Look::kFar, step_filter), 6u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT(scene.to_mm[k].z, 0.25);
    EXPECT_GT(scene.to_mm[k].z, 0.2);
    EXPECT_NEAR(scene.to_mm[k].z + scene.to_mm[3 + k].z, 0.5, 1e-12);
  }
}

}  // namespace
}  // namespace anthesis
