#include "anthesis/inflorescence/development.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {
namespace {

OrganKind peg(const char* name, double height_mm) {
  Column column;
  column.name = "peg";
  column.pigment = "green";
  column.poses = {{0.0, {{0.2, 0}, {0.2, 0.3 * height_mm}, {0.2, 0.6 * height_mm}, {0, height_mm}}, 0.0},
                  {1.0, {{0.2, 0}, {0.2, 0.6 * height_mm}, {0.2, 1.2 * height_mm}, {0, 2 * height_mm}}, 0.0}};
  OrganKind kind;
  kind.name = name;
  kind.shape.columns = {column};
  kind.opening = {{0.0, 0.0}, {0.5, 0.0}, {1.0, 1.0}};
  return kind;
}

/// A flat head with a bracted rim: everything that a development decides, and nothing that needs a drawing.
Species small_head() {
  Species species;
  species.name = "small";
  Pigment green;
  green.name = "green";
  species.pigments = {green};
  species.organs = {peg("bract", 4.0), peg("ray_floret", 3.0), peg("disk_floret", 2.0)};
  species.organs[2].variants = 4;
  species.organs[2].variation = {{0.9, 1.1}, {-5, 5}, {-5, 5}, {-90, 90}, {-0.1, 0.1}};
  Head& head = species.head;
  head.receptacle = {{0.0, {{0, 1}, {1, 1}}}};
  head.receptacle_pigment = "green";
  head.interval = 0.002;
  head.meristem_area_mm2 = 100.0;
  head.area_growth = {{0.0, 0.5}, {1.0, 1.0}};
  head.zones = {{"disk_floret", 0.0, 0.9}, {"bract", 0.9, 1.0}};
  head.fate = FateRule{"disk_floret", "ray_floret", 75.0};
  species.peduncle.pigment = "green";
  species.peduncle.length_mm = 30.0;
  return species;
}

std::size_t count(const Development& development, const char* kind) {
  std::size_t n = 0;
  for (const Organ& organ : development.organs()) {
    n += development.species().organs[organ.kind].name == kind;
  }
  return n;
}

TEST(Development, BractsSurroundRaysSurroundDiskFlorets) {
  const Development development = *Development::grow(small_head(), {});
  EXPECT_GT(count(development, "bract"), 20u);
  EXPECT_GT(count(development, "disk_floret"), 100u);
  const Canopy canopy = development.at(1.0);
  double nearest_bract = 1e9;
  double nearest_ray = 1e9;
  double farthest_ray = 0.0;
  double farthest_disk = 0.0;
  for (const OrganState& organ : canopy.organs) {
    const std::string& kind = development.species().organs[development.organs()[organ.id.value - 1].kind].name;
    if (kind == "bract") {
      nearest_bract = std::min(nearest_bract, organ.radius_mm);
    } else if (kind == "ray_floret") {
      nearest_ray = std::min(nearest_ray, organ.radius_mm);
      farthest_ray = std::max(farthest_ray, organ.radius_mm);
    } else {
      farthest_disk = std::max(farthest_disk, organ.radius_mm);
    }
  }
  EXPECT_LT(farthest_ray, nearest_bract);
  EXPECT_GT(farthest_ray, farthest_disk);
  EXPECT_GT(nearest_ray, 0.8 * farthest_disk);
  // A head of this size has a Fibonacci number of rays (O16 fig. 15).
  const std::size_t rays = count(development, "ray_floret");
  EXPECT_TRUE(rays == 13 || rays == 21 || rays == 34) << rays;
}

TEST(Development, OpensFromTheRimInwards) {
  Species species = small_head();
  species.organs[2].variation = {};
  const Development development = *Development::grow(species, {});
  const Canopy canopy = development.at(0.9);
  double before = 1.1;
  for (const OrganState& organ : canopy.organs) {  // by birth, so from the rim to the centre
    if (development.organs()[organ.id.value - 1].kind == 2) {
      EXPECT_LE(organ.stage, before + 1e-12);
      before = organ.stage;
    }
  }
  EXPECT_LT(canopy.organs.back().stage, canopy.organs[40].stage - 0.2);
}

TEST(Development, OrgansStandOnTheReceptacleAlongItsNormal) {
  Species species = small_head();
  species.head.receptacle = {{0.0, {{0, 1}, {1, 0}}}};  // a cone of 45 degrees
  const Development development = *Development::grow(species, {});
  for (const OrganState& organ : development.at(1.0).organs) {
    if (development.organs()[organ.id.value - 1].kind != 0) {
      continue;  // bracts have no variation, so their axis is the normal itself
    }
    const Vec3 axis = rotate(organ.world_from_organ.rotation, {0, 0, 1});
    EXPECT_NEAR(length(axis - organ.normal), 0.0, 1e-12);
    EXPECT_NEAR(organ.normal.z, std::sqrt(0.5), 1e-12);
    // The organ's +x, its outer side, points down the cone and away from the axis.
    const Vec3 outward = rotate(organ.world_from_organ.rotation, {1, 0, 0});
    EXPECT_LT(outward.z, 0.0);
    EXPECT_GT(dot(outward, organ.world_from_organ.position_mm), 0.0);
  }
}

TEST(Development, AnyTimeIsTheSameHoweverItIsReached) {
  const Development development = *Development::grow(small_head(), {});
  const Canopy once = development.at(0.37);
  for (int frame = 0; frame <= 30; ++frame) {
    development.at(frame / 30.0);
  }
  const Canopy again = development.at(0.37);
  ASSERT_EQ(once.organs.size(), again.organs.size());
  for (std::size_t i = 0; i < once.organs.size(); ++i) {
    EXPECT_EQ(once.organs[i].world_from_organ.position_mm, again.organs[i].world_from_organ.position_mm);
    EXPECT_EQ(once.organs[i].world_from_organ.rotation, again.organs[i].world_from_organ.rotation);
    EXPECT_EQ(once.organs[i].stage, again.organs[i].stage);
  }
}

TEST(Development, TheNumberOfThreadsChangesNothing) {
  std::vector<Vec3> positions;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    const Development development = *Development::grow(small_head(), {});
    std::vector<Vec3> here;
    for (const OrganState& organ : development.at(0.8).organs) {
      here.push_back(organ.world_from_organ.position_mm);
    }
    if (positions.empty()) {
      positions = here;
    }
    EXPECT_EQ(positions, here);
  }
}

TEST(Development, ASeedChangesTheIndividualButNotTheSpecies) {
  const Development one = *Development::grow(small_head(), {.seed = 1});
  const Development two = *Development::grow(small_head(), {.seed = 2});
  ASSERT_EQ(one.organs().size(), two.organs().size());
  const Canopy a = one.at(1.0);
  const Canopy b = two.at(1.0);
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.organs.size(); ++i) {
    EXPECT_EQ(one.organs()[i].kind, two.organs()[i].kind);
    different += a.organs[i].world_from_organ.scale != b.organs[i].world_from_organ.scale;
    if (one.organs()[i].kind == 2) {
      EXPECT_GE(a.organs[i].world_from_organ.scale, 0.9);
      EXPECT_LE(a.organs[i].world_from_organ.scale, 1.1);
    }
  }
  EXPECT_GT(different, 100u);
}

TEST(Development, BodiesKeepTheirTopology) {
  const Development development = *Development::grow(small_head(), {});
  const Canopy early = development.at(0.1);
  const Canopy late = development.at(1.0);
  ASSERT_EQ(early.bodies.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(early.bodies[i].mesh.triangles, late.bodies[i].mesh.triangles);
    EXPECT_EQ(early.bodies[i].mesh.positions_mm.size(), late.bodies[i].mesh.positions_mm.size());
  }
  // The stem's first ring lies on the receptacle's rim.
  const Mesh& receptacle = late.bodies[0].mesh;
  const Mesh& peduncle = late.bodies[1].mesh;
  const Vec3 rim = receptacle.positions_mm.back();
  EXPECT_NEAR(length(Vec2{peduncle.positions_mm[0].x, peduncle.positions_mm[0].y}), length(Vec2{rim.x, rim.y}), 1e-9);
  EXPECT_NEAR(peduncle.positions_mm[0].z, rim.z, 1e-9);
}

TEST(Development, BodiesFaceOutwards) {
  const Development development = *Development::grow(small_head(), {});
  for (const Body& body : development.at(1.0).bodies) {
    for (const Triangle& t : body.mesh.triangles) {
      EXPECT_GT(dot(area_vector(body.mesh.positions_mm, t), body.mesh.normals[t[0]]), 0.0) << body.name;
    }
  }
}

/// A dome of clusters; each is a smaller dome of pegs on a stalk.
Species clusters_of_pegs() {
  Species species = small_head();
  species.peduncle.length_mm = 0.0;
  species.organs = {peg("cluster", 1.0), peg("floret", 1.0)};
  species.head = Head{};
  species.head.rule = PlacementRule::kRidley;
  species.head.receptacle = {{0.0, {{0, 10}, {8, 10}, {10, 4}, {10, 0}}}};
  species.head.area_mm2 = {{0.0, 20.0}, {1.0, 20.0}};
  species.head.interval = 0.01;
  species.head.zones = {{"cluster", 0.0, 1.0}};
  Head& head = species.organs[0].head.emplace();
  head.rule = PlacementRule::kRidley;
  head.receptacle = {{0.0, {{0, 1}, {1, 1}, {1, 0}}}};
  head.area_mm2 = {{0.0, 0.2}, {1.0, 0.2}};
  head.interval = 0.01;
  head.height_mm = 3.0;
  head.zones = {{"floret", 0.0, 1.0}};
  species.organs[0].growth = {{0.0, 0.5}, {1.0, 1.5}};
  return species;
}

TEST(Development, OrgansOnOrgansRepeatOnePattern) {
  const Development development = *Development::grow(clusters_of_pegs(), {});
  const std::size_t clusters = count(development, "cluster");
  const std::size_t florets = count(development, "floret");
  ASSERT_GT(clusters, 10u);
  ASSERT_EQ(florets % clusters, 0u);
  ASSERT_GT(florets / clusters, 5u);
  const Canopy canopy = development.at(1.0);
  ASSERT_EQ(canopy.organs.size(), clusters + florets);
  std::map<std::uint32_t, std::vector<Vec3>> on_cluster;
  for (const OrganState& state : canopy.organs) {
    const Organ& organ = development.organs()[state.id.value - 1];
    if (organ.parent.value == 0) {
      continue;
    }
    ASSERT_LT(organ.parent, organ.id);
    const Placement& cluster = canopy.organs[organ.parent.value - 1].world_from_organ;
    const Vec3 local =
        rotate(conjugate(cluster.rotation), state.world_from_organ.position_mm - cluster.position_mm) / cluster.scale;
    on_cluster[organ.parent.value].push_back(local);
    EXPECT_GE(local.z, 3.0 - 1e-9);  // on the stalk
    EXPECT_NEAR(std::hypot(local.x, local.y), state.radius_mm, 1e-9);
    EXPECT_NEAR(state.world_from_organ.scale, cluster.scale, 1e-12);
  }
  ASSERT_EQ(on_cluster.size(), clusters);
  const std::vector<Vec3>& first = on_cluster.begin()->second;
  for (const auto& [parent, places] : on_cluster) {
    ASSERT_EQ(places.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_LT(length(places[i] - first[i]), 1e-9);
    }
  }
}

// O16 fig. 13: the first element of a meristem lies as far as possible from the centre of the one that carries it.
TEST(Development, TheFirstOrganOnAnOrganLiesOutwards) {
  const Development development = *Development::grow(clusters_of_pegs(), {});
  const Canopy canopy = development.at(1.0);
  std::map<std::uint32_t, const OrganState*> first;
  for (const OrganState& state : canopy.organs) {
    first.try_emplace(development.organs()[state.id.value - 1].parent.value, &state);
  }
  for (const auto& [parent, state] : first) {
    if (parent == 0) {
      continue;
    }
    const Vec3 cluster = canopy.organs[parent - 1].world_from_organ.position_mm;
    const Vec3 normal = canopy.organs[parent - 1].normal;
    const Vec3 apex{0.0, 0.0, 10.0};
    const auto in_plane = [&](Vec3 v) { return v - dot(v, normal) * normal; };
    const Vec3 away = in_plane(cluster - apex);
    const Vec3 offset = in_plane(state->world_from_organ.position_mm - cluster);
    EXPECT_GT(dot(away, offset), 0.999 * length(away) * length(offset));
  }
}

TEST(Development, AnOrgansOwnHeadLivesByItsAge) {
  const Development development = *Development::grow(clusters_of_pegs(), {});
  double before = 0.0;
  for (const Organ& organ : development.organs()) {
    EXPECT_GE(organ.birth, before);
    before = organ.birth;
    const Canopy canopy = development.at(organ.birth);  // at its birth to the last bit it is there
    EXPECT_GE(canopy.organs.size(), organ.id.value);
  }
  const Organ& last = development.organs().back();
  EXPECT_GT(last.birth, development.organs()[last.parent.value - 1].birth);
}

TEST(Development, AFormStandsOnItsContactPointAlongItsAxis) {
  Species species = clusters_of_pegs();
  const Canopy plain = Development::grow(species, {})->at(1.0);
  OrganKind& cluster = species.organs[0];
  cluster.contact_point_mm = {0.0, 0.0, 0.5};
  const Canopy sunk = Development::grow(species, {})->at(1.0);
  cluster.contact_point_mm = {};
  cluster.axis = {3.0, 0.0, 0.0};
  cluster.outward = {1.0, 2.0, 0.0};  // only what is square to the axis counts
  const Canopy lying = Development::grow(species, {})->at(1.0);
  const Placement& upright = plain.organs[0].world_from_organ;
  EXPECT_LT(length(apply(sunk.organs[0].world_from_organ, {0.0, 0.0, 0.5}) - upright.position_mm), 1e-12);
  EXPECT_LT(length(apply(lying.organs[0].world_from_organ, {1.0, 0.0, 0.0}) - apply(upright, {0.0, 0.0, 1.0})), 1e-12);
  EXPECT_LT(length(apply(lying.organs[0].world_from_organ, {0.0, 1.0, 0.0}) - apply(upright, {1.0, 0.0, 0.0})), 1e-12);
}

TEST(Development, OrgansFitTheirPlaces) {
  Species species = clusters_of_pegs();
  species.head.area_mm2 = {{0.0, 10.0}, {1.0, 40.0}};
  species.organs[0].growth = {{0.0, 1.0}, {1.0, 1.0}};
  species.organs[0].fits_radius_mm = 2.0;
  const Canopy canopy = Development::grow(species, {})->at(1.0);
  for (const OrganState& state : canopy.organs) {
    if (state.area_mm2 > 5.0) {  // of a cluster: the disc of its area is as wide as its form says
      EXPECT_NEAR(2.0 * state.world_from_organ.scale, std::sqrt(state.area_mm2 / math::kPi), 1e-9);
    }
  }
}

// The rules of growing meristems and of given receptacles, asked for by name: each has its mark.
TEST(Development, EveryRulePlacesItsOrgans) {
  Species species = clusters_of_pegs();
  species.organs[0].head.reset();
  species.head.radius_mm = {{0.0, 1.5}, {1.0, 1.5}};
  species.head.rule = PlacementRule::kCollision;
  const Canopy spheres = Development::grow(species, {})->at(1.0);
  ASSERT_GT(spheres.organs.size(), 30u);
  double nearest = 1e9;
  for (const OrganState& a : spheres.organs) {
    for (const OrganState& b : spheres.organs) {
      if (a.id != b.id) {
        nearest = std::min(nearest, length(a.world_from_organ.position_mm - b.world_from_organ.position_mm));
      }
    }
  }
  EXPECT_NEAR(nearest, 3.0, 1e-9);  // they touch, and none comes nearer

  species.head.meristem_area_mm2 = 300.0;
  species.head.outer_area_mm2 = 300.0;
  species.head.rule = PlacementRule::kDivergent;
  const Development divergent = *Development::grow(species, {});
  const Canopy both_ways = divergent.at(1.0);
  ASSERT_GT(both_ways.organs.size(), 15u);
  const double first_s = both_ways.organs[0].s;
  EXPECT_TRUE(std::any_of(both_ways.organs.begin(), both_ways.organs.end(),
                          [&](const auto& o) { return o.s > first_s + 0.1; }));
  EXPECT_TRUE(std::any_of(both_ways.organs.begin(), both_ways.organs.end(),
                          [&](const auto& o) { return o.s < first_s - 0.1; }));

  species.head.meristem_area_mm2 = 22.0;
  species.head.threshold_area_mm2 = 30.0;
  species.head.meristem_rate = {{0.0, 20.0}, {1.0, 20.0}};
  species.head.rule = PlacementRule::kSegregation;
  const Canopy given_off = Development::grow(species, {})->at(1.0);
  ASSERT_GT(given_off.organs.size(), 10u);
  for (std::size_t i = 1; i < given_off.organs.size(); ++i) {
    EXPECT_LT(given_off.organs[i].s, given_off.organs[i - 1].s);  // the youngest next to the tip
  }
}

TEST(Development, RefusesBadSpeciesAndStopsWhenAsked) {
  Species species = small_head();
  species.head.interval = -1.0;
  EXPECT_EQ(Development::grow(species, {}).error().where, "head.interval");
  EXPECT_EQ(Development::grow(small_head(), {.detail = 0.0}).error().where, "detail");
  const auto cancelled = Development::grow(small_head(), {}, [](std::string_view, double) { return false; });
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace anthesis
