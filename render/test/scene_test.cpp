#include "anthesis/render/scene.h"

#include <gtest/gtest.h>

#include <limits>

#include "anthesis/base/math.h"
#include "anthesis/render/scene_of_canopy.h"

namespace anthesis {
namespace {

Scene ball() {
  Scene scene;
  scene.pigments.emplace_back();
  scene.meshes.push_back({unit_sphere(), {{0, 1280, 0}}});
  scene.instances.emplace_back();
  return scene;
}

TEST(UnitSphere, IsClosedRoundAndTurnedOutward) {
  const Mesh sphere = unit_sphere();
  EXPECT_EQ(sphere.triangles.size(), 1280U);
  double volume = 0.0;
  for (const auto& [a, b, c] : sphere.triangles) {
    volume += dot(sphere.positions_mm[a], cross(sphere.positions_mm[b], sphere.positions_mm[c])) / 6.0;
  }
  EXPECT_NEAR(volume, 4.0 / 3.0 * math::kPi, 0.04);
  EXPECT_EQ(sphere.positions_mm.size() + sphere.triangles.size() - 3 * sphere.triangles.size() / 2, 2U);
}

TEST(CheckScene, FindsNothingWrongWithAGoodScene) {
  EXPECT_FALSE(check(ball()).has_value());
}

TEST(CheckScene, NamesWhatIsWrong) {
  const auto where = [](auto spoil) {
    Scene scene = ball();
    spoil(scene);
    const auto error = check(scene);
    return error ? error->where : std::string("nothing");
  };
  EXPECT_EQ(where([](Scene& s) { s.instances[0].mesh = 3; }), "instances[0].mesh");
  EXPECT_EQ(where([](Scene& s) { s.instances[0].world_from_mesh.scale = 0.0; }), "instances[0].world_from_mesh");
  EXPECT_EQ(where([](Scene& s) { s.instances[0].variations.resize(2); }), "instances[0].variations");
  EXPECT_EQ(where([](Scene& s) { s.meshes[0].mesh.triangles[7][1] = 9999; }), "meshes[0].triangles");
  EXPECT_EQ(where([](Scene& s) { s.meshes[0].mesh.positions_mm[0].x = std::numeric_limits<double>::quiet_NaN(); }),
            "meshes[0].positions_mm");
  EXPECT_EQ(where([](Scene& s) { s.meshes[0].mesh.uvs.pop_back(); }), "meshes[0].uvs");
  EXPECT_EQ(where([](Scene& s) { s.meshes[0].spans[0].triangle_count = 1281; }), "meshes[0].spans");
  EXPECT_EQ(where([](Scene& s) { s.pigments[0].translucency = 1.5; }), "pigments[0].translucency");
  EXPECT_EQ(where([](Scene& s) { s.lighting.lamps.push_back({.towards = {1, 1, 1}}); }), "lighting.lamps[0].towards");
  EXPECT_EQ(where([](Scene& s) { s.lighting.sky.zenith.g = -1.0; }), "lighting.sky");
  EXPECT_EQ(where([](Scene& s) { s.haze = Haze{}; }), "nothing");
  EXPECT_EQ(where([](Scene& s) { s.haze = Haze{.towards = {0, 0, 2}}; }), "haze.towards");
  EXPECT_EQ(where([](Scene& s) { s.haze = Haze{.clear_mm = -1.0}; }), "haze");
  EXPECT_EQ(where([](Scene& s) { s.haze = Haze{.share = 2.0}; }), "haze.share");
  EXPECT_EQ(where([](Scene& s) { s.instances[0].veil = Veil{}; }), "nothing");
  EXPECT_EQ(where([](Scene& s) { s.instances[0].veil = Veil{.facing = -0.1}; }), "instances[0].veil.facing");
  EXPECT_EQ(where([](Scene& s) { s.instances[0].veil = Veil{.edge = 1.1}; }), "instances[0].veil.edge");
  EXPECT_EQ(where([](Scene& s) { s.instances[0].veil = Veil{.doublings = 6}; }), "instances[0].veil.doublings");
}

TEST(OpenIrradiance, IsPiUnderAnEvenSkyAndAddsLampsByTheirCosine) {
  Lighting lighting;
  EXPECT_NEAR(open_irradiance(lighting, normalized(Vec3{1, 2, 3})).g, math::kPi, 1e-9);
  lighting.lamps.push_back({.towards = {0, 0, 1}, .irradiance = {2, 2, 2}});
  EXPECT_NEAR(open_irradiance(lighting, {0, 0.8, 0.6}).r, math::kPi + 1.2, 1e-9);
  EXPECT_NEAR(open_irradiance(lighting, {0, 0, -1}).r, math::kPi, 1e-9);
}

TEST(OpenIrradiance, OfAGlowIsThatOfItsIntegral) {
  // Cos^4 about the normal, weighed by the cosine: 2 pi / 6.
  Lighting lighting;
  lighting.sky = {{0, 0, 1}, {}, {}, {}, {{{0, 0, 1}, 2, {1, 1, 1}}}};
  EXPECT_NEAR(open_irradiance(lighting, {0, 0, 1}).r, math::kPi / 3.0, 1e-3);
}

/// A flat head of pegs in two colours.
Species head_of_pegs() {
  Column peg;
  peg.name = "peg";
  peg.pigment = "red";
  peg.poses = {{0.0, {{0.2, 0}, {0.2, 0.6}, {0.2, 1.2}, {0, 2}}, 0.0},
               {1.0, {{0.2, 0}, {0.2, 1.2}, {0.2, 2.4}, {0, 4}}, 0.0}};
  OrganKind kind;
  kind.name = "floret";
  kind.shape.columns = {peg};
  kind.variants = 3;
  kind.opening = {{0.0, 0.0}, {0.5, 0.2}, {1.0, 1.0}};
  Species species;
  species.name = "pegs";
  species.pigments.resize(2);
  species.pigments[0].name = "green";
  species.pigments[1].name = "red";
  species.organs = {kind};
  Head& head = species.head;
  head.receptacle = {{0.0, {{0, 1}, {1, 1}}}};
  head.receptacle_pigment = "green";
  head.interval = 0.005;
  head.meristem_area_mm2 = 100.0;
  head.area_growth = {{0.0, 0.5}, {1.0, 1.0}};
  head.zones = {{"floret", 0.0, 1.0}};
  species.peduncle.pigment = "green";
  species.peduncle.length_mm = 30.0;
  return species;
}

TEST(MakeScene, HoldsEveryOrganOnceAndSharesTheirMeshes) {
  const auto development = Development::grow(head_of_pegs(), {});
  ASSERT_TRUE(development.has_value()) << to_string(development.error());
  const Canopy canopy = development->at(1.0);
  const Scene scene = make_scene(*development, canopy, {.ground = true});
  EXPECT_FALSE(check(scene).has_value());
  ASSERT_GT(canopy.organs.size(), 50U);
  EXPECT_EQ(scene.instances.size(), canopy.organs.size() + canopy.bodies.size());
  EXPECT_LE(scene.meshes.size(), 3U * 65U + canopy.bodies.size());
  EXPECT_EQ(scene.meshes[scene.instances[0].mesh].spans[0].pigment, 1U);  // red is the second pigment
  EXPECT_TRUE(scene.instances[0].framed);
  ASSERT_TRUE(scene.ground.has_value());
  EXPECT_LT(scene.ground->height_mm, -20.0);  // at the foot of the stem
  bool unframed = false;
  for (const Instance& instance : scene.instances) {
    unframed = unframed || !instance.framed;
  }
  EXPECT_TRUE(unframed);
}

/// The canopy at `time` with each organ turned about +x by a degree and moved, in single precision: as if bent.
Canopy moved(const Development& development, double time) {
  const Placement motion{{0.5, 0.25, -1.0}, rotation_about({1.0, 0.0, 0.0}, math::radians(1.0)), 1.0};
  Canopy canopy = development.at(time);
  for (OrganState& state : canopy.organs) {
    const OrganTemplate& shape = development.templates()[development.organs()[state.id.value - 1].template_index];
    std::vector<Vec3> positions_mm(shape.vertex_count());
    std::vector<Vec3> normals(shape.vertex_count());
    shape.pose(state.stage, positions_mm, normals);
    for (const Vec3 p : positions_mm) {
      const Vec3 q = apply(motion, apply(state.world_from_organ, p));
      state.deformed_mm.push_back({static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)});
    }
  }
  return canopy;
}

TEST(MakeScene, DrawsBentOrgansWhereTheirVerticesAre) {
  const auto development = Development::grow(head_of_pegs(), {});
  ASSERT_TRUE(development.has_value());
  Canopy canopy = moved(*development, 1.0);
  canopy.organs[7].deformed_mm.clear();  // one that nothing touches
  const Scene scene = make_scene(*development, canopy);
  EXPECT_FALSE(check(scene).has_value());
  const Scene straight = make_scene(*development, development->at(1.0));
  ASSERT_EQ(scene.instances.size(), straight.instances.size());
  for (std::size_t i = 0; i < canopy.organs.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const OrganState& state = canopy.organs[i];
    // Colours do not change because an organ is bent.
    ASSERT_EQ(instance.variations.size(), 1U);
    EXPECT_EQ(instance.variations[0].pattern, straight.instances[i].variations[0].pattern);
    EXPECT_EQ(instance.variations[0].value, straight.instances[i].variations[0].value);
    if (state.deformed_mm.empty()) {
      EXPECT_EQ(instance.world_from_mesh.position_mm, state.world_from_organ.position_mm);
      continue;
    }
    const Mesh& mesh = scene.meshes[instance.mesh].mesh;
    ASSERT_EQ(mesh.positions_mm.size(), state.deformed_mm.size());
    for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v) {
      const std::array<float, 3>& p = state.deformed_mm[v];
      ASSERT_EQ(apply(instance.world_from_mesh, mesh.positions_mm[v]), (Vec3{p[0], p[1], p[2]}));
      ASSERT_NEAR(length(mesh.normals[v]), 1.0, 1e-9);
    }
  }
}

TEST(MakeScene, FinerOrgansFollowBentOnes) {
  const auto development = Development::grow(head_of_pegs(), {.detail = 1.0});
  const auto finer = Development::grow(head_of_pegs(), {.detail = 3.0});
  ASSERT_TRUE(development.has_value() && finer.has_value());
  const Canopy canopy = moved(*development, 1.0);
  const Canopy wanted = moved(*finer, 1.0);
  const Scene scene = make_scene(*development, canopy, {.finer = &*finer});
  EXPECT_FALSE(check(scene).has_value());
  ASSERT_EQ(scene.instances.size(), wanted.organs.size() + wanted.bodies.size());
  for (std::size_t i = 0; i < wanted.organs.size(); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh].mesh;
    ASSERT_EQ(mesh.positions_mm.size(), wanted.organs[i].deformed_mm.size());
    for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v) {
      const std::array<float, 3>& p = wanted.organs[i].deformed_mm[v];
      ASSERT_LT(length(mesh.positions_mm[v] - Vec3{p[0], p[1], p[2]}), 1e-4);
    }
  }
  EXPECT_EQ(scene.meshes.back().mesh.positions_mm, wanted.bodies.back().mesh.positions_mm);
}

/// Pegs with four hairs to a square millimetre, on a stem with two.
Species hairy_pegs() {
  Species species = head_of_pegs();
  Hairs hairs;
  hairs.pigment = "green";
  hairs.density_per_mm2 = 2.0;
  species.peduncle.hairs = {hairs};
  hairs.on = "peg";
  hairs.density_per_mm2 = 4.0;
  species.organs[0].shape.hairs = {hairs};
  return species;
}

TEST(MakeScene, DrawsHairsOnOrgansAndTheStem) {
  const auto bald = Development::grow(head_of_pegs(), {});
  const auto hairy = Development::grow(hairy_pegs(), {});
  ASSERT_TRUE(bald.has_value() && hairy.has_value());
  const Scene without = make_scene(*bald, bald->at(1.0));
  const Scene with = make_scene(*hairy, hairy->at(1.0));
  EXPECT_FALSE(check(with).has_value());
  ASSERT_EQ(with.instances.size(), without.instances.size());
  for (std::size_t i = 0; i < with.instances.size(); ++i) {
    const SceneMesh& plain = without.meshes[without.instances[i].mesh];
    const SceneMesh& mesh = with.meshes[with.instances[i].mesh];
    const bool receptacle = i + 2 == with.instances.size();
    ASSERT_EQ(mesh.spans.size(), receptacle ? 1U : 2U);
    EXPECT_EQ(mesh.mesh.triangles.size() > plain.mesh.triangles.size(), !receptacle);
    // The surface comes first and is what it is without hairs.
    for (std::size_t v = 0; v < plain.mesh.positions_mm.size(); ++v) {
      ASSERT_EQ(mesh.mesh.positions_mm[v], plain.mesh.positions_mm[v]);
    }
    if (!receptacle) {
      EXPECT_EQ(mesh.spans[1].first_triangle, plain.mesh.triangles.size());
      EXPECT_EQ(mesh.spans[1].first_triangle + mesh.spans[1].triangle_count, mesh.mesh.triangles.size());
      EXPECT_EQ(mesh.spans[1].pigment, 0U);  // green
    }
  }
}

TEST(MakeScene, HairsOfABentOrganGoWithIt) {
  const auto development = Development::grow(hairy_pegs(), {});
  const auto finer = Development::grow(hairy_pegs(), {.detail = 2.0});
  ASSERT_TRUE(development.has_value() && finer.has_value());
  const Canopy canopy = moved(*development, 1.0);
  const Placement motion{{0.5, 0.25, -1.0}, rotation_about({1.0, 0.0, 0.0}, math::radians(1.0)), 1.0};
  for (const Development* drawn : {static_cast<const Development*>(nullptr), &*finer}) {
    const Development& shown = drawn != nullptr ? *drawn : *development;
    const Scene straight = make_scene(shown, shown.at(1.0));
    const Scene scene = make_scene(*development, canopy, {.finer = drawn});
    for (std::size_t i = 0; i < canopy.organs.size(); ++i) {
      if (canopy.organs[i].stage < 1.0) {
        continue;  // those that nothing bent stand at the nearest stage of 64
      }
      const Instance& was = straight.instances[i];
      const Mesh& before = straight.meshes[was.mesh].mesh;
      const Mesh& after = scene.meshes[scene.instances[i].mesh].mesh;
      ASSERT_EQ(after.positions_mm.size(), before.positions_mm.size());
      for (std::size_t v = 0; v < after.positions_mm.size(); ++v) {
        const Vec3 wanted = apply(motion, apply(was.world_from_mesh, before.positions_mm[v]));
        ASSERT_LT(length(after.positions_mm[v] - wanted), 1e-3);
      }
    }
  }
}

TEST(MakeOrganScene, ShowsOneOrganUprightAtItsStage) {
  const Species species = head_of_pegs();
  for (const auto& [stage, height_mm] : {std::pair(0.0, 2.0), std::pair(0.5, 3.0), std::pair(1.0, 4.0)}) {
    const auto scene = make_organ_scene(species, 0, stage, 1.0);
    ASSERT_TRUE(scene.has_value());
    EXPECT_FALSE(check(*scene).has_value());
    ASSERT_EQ(scene->instances.size(), 1U);
    EXPECT_EQ(scene->instances[0].variations.size(), scene->meshes[0].spans.size());
    double top_mm = 0.0;
    for (const Vec3 p : scene->meshes[0].mesh.positions_mm) {
      top_mm = std::max(top_mm, p.z);
    }
    EXPECT_NEAR(top_mm, height_mm, 1e-12);
  }
}

}  // namespace
}  // namespace anthesis
