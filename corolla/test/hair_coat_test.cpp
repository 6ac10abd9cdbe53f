#include "anthesis/corolla/hair_coat.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/corolla/organ_template.h"

namespace anthesis {
namespace {

/// A strap 10 mm long and 2 mm wide, upright and flat, that lies down by a right angle in the middle of its length.
OrganShape strap() {
  Petals petals;
  petals.name = "blade";
  petals.spacing = {{0, 0.1}, {1, 0.1}};
  petals.poses.resize(2);
  petals.poses[0].midrib_mm = {{0, 0}, {0, 2.5}, {0, 5}, {0, 7.5}, {0, 10}};
  petals.poses[1].midrib_mm = {{0, 0}, {0, 2.5}, {0, 5}, {2.5, 5}, {5, 5}};
  for (PetalPose& pose : petals.poses) {
    pose.half_width_mm = {1, 1, 1, 1, 1};
  }
  petals.poses[1].stage = 1.0;
  OrganShape shape;
  shape.petals = {petals};
  return shape;
}

Hairs hairs_on(const std::string& part) {
  Hairs hairs;
  hairs.on = part;
  hairs.density_per_mm2 = 20.0;
  hairs.radius_mm = 0.01;
  hairs.swirl_deg = {0.0, 0.0};
  return hairs;
}

OrganTemplate grown(const OrganShape& shape, double detail = 1.0, std::uint64_t seed = 1, std::uint32_t variant = 0) {
  EXPECT_FALSE(check(shape, "organs.x"));
  return *OrganTemplate::build(shape, detail, seed, variant);
}

/// The root and the tip of each straight hair: a prism of three sides that ends in a point.
struct Straight {
  Vec3 root;
  Vec3 tip;
  Vec2 uv{};
};

std::vector<Straight> hairs_of(const OrganTemplate& organ, std::span<const Vec3> positions_mm,
                               std::span<const Vec3> normals, double scale = 1.0) {
  std::vector<Straight> result;
  for (std::size_t group = 0; group < organ.hairs().groups().size(); ++group) {
    Mesh mesh;
    organ.hairs().append(group, positions_mm, normals, scale, mesh);
    for (std::size_t i = 0; i + 3 < mesh.positions_mm.size(); i += 4) {
      const auto& p = mesh.positions_mm;
      result.push_back({(p[i] + p[i + 1] + p[i + 2]) / 3.0, p[i + 3]});
    }
  }
  return result;
}

std::vector<Straight> hairs_at(const OrganTemplate& organ, double stage) {
  std::vector<Vec3> positions_mm(organ.vertex_count());
  std::vector<Vec3> normals(organ.vertex_count());
  organ.pose(stage, positions_mm, normals);
  return hairs_of(organ, positions_mm, normals);
}

TEST(HairCoat, HasAsManyHairsAsAreaTimesDensityAndSpreadsThemEvenly) {
  OrganShape shape = strap();
  shape.petals[0].poses.resize(1);   // stays upright: 20 square millimetres
  shape.petals[0].degree_along = 1;  // v is the height in centimetres
  shape.hairs = {hairs_on("blade")};
  const std::vector<Straight> hairs = hairs_at(grown(shape), 0.0);
  ASSERT_EQ(hairs.size(), 400u);
  for (int tenth = 0; tenth < 10; ++tenth) {
    const auto here = [&](const Straight& h) { return std::floor(h.root.z) == tenth; };
    EXPECT_NEAR(static_cast<double>(std::ranges::count_if(hairs, here)), 40.0, 4.0);
  }
  const auto left = [](const Straight& h) { return h.root.y > 0.0; };
  EXPECT_NEAR(static_cast<double>(std::ranges::count_if(hairs, left)), 200.0, 20.0);
  shape.hairs[0].along = {0.5, 0.75};
  const std::vector<Straight> some = hairs_at(grown(shape), 0.0);
  EXPECT_EQ(some.size(), 100u);
  for (const Straight& hair : some) {
    EXPECT_GE(hair.root.z, 5.0 - 1e-9);
    EXPECT_LE(hair.root.z, 7.5 + 1e-9);
  }
}

TEST(HairCoat, LeansTowardsTheTipOnTheSideItStandsOn) {
  // The upper side of an upright petal faces the axis, -x; its tip is up.
  OrganShape shape = strap();
  shape.petals[0].poses.resize(1);
  shape.hairs = {hairs_on("blade")};
  shape.hairs[0].length_mm = {2.0, 2.0};
  shape.hairs[0].lean_deg = {30.0, 30.0};
  for (const bool upper : {true, false}) {
    shape.hairs[0].upper = upper;
    shape.hairs[0].lower = !upper;
    for (const Straight& hair : hairs_at(grown(shape), 0.0)) {
      EXPECT_NEAR(hair.root.x, 0.0, 1e-12);
      const Vec3 way = hair.tip - hair.root;
      EXPECT_NEAR(way.x, (upper ? -2.0 : 2.0) * math::cos(math::radians(30.0)), 1e-9);
      EXPECT_NEAR(way.y, 0.0, 1e-9);
      EXPECT_NEAR(way.z, 2.0 * math::sin(math::radians(30.0)), 1e-9);
    }
  }
  shape.hairs[0].upper = true;  // and now both
  EXPECT_EQ(hairs_at(grown(shape), 0.0).size(), 800u);
}

TEST(HairCoat, StandsOnTheSurfaceAtEveryStageOnTheSamePlaces) {
  OrganShape shape = strap();
  shape.hairs = {hairs_on("blade")};
  const OrganTemplate organ = grown(shape);
  const std::vector<Straight> upright = hairs_at(organ, 0.0);
  for (const double stage : {0.3, 0.7, 1.0}) {
    const std::vector<Straight> now = hairs_at(organ, stage);
    ASSERT_EQ(now.size(), upright.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
      EXPECT_NEAR(length(now[i].tip - now[i].root), 1.0, 1e-9);
      EXPECT_NEAR(now[i].root.y, upright[i].root.y, 1e-9);  // the petal bends, its places stay across it
      // Below the bend nothing moves; the tip of the open petal lies flat with its upper side up.
      if (upright[i].root.z < 1.0) {
        EXPECT_LT(length(now[i].root - upright[i].root), 0.3);
      }
      if (stage == 1.0 && upright[i].root.z > 9.0) {
        EXPECT_GT(now[i].tip.z - now[i].root.z, 0.9);
      }
    }
  }
}

TEST(HairCoat, GoesWithASurfaceThatWasMovedAndScaled) {
  OrganShape shape = strap();
  shape.hairs = {hairs_on("blade")};
  shape.hairs[0].lean_deg = {0.0, 50.0};
  shape.hairs[0].swirl_deg = {-90.0, 90.0};
  const OrganTemplate organ = grown(shape);
  std::vector<Vec3> positions_mm(organ.vertex_count());
  std::vector<Vec3> normals(organ.vertex_count());
  organ.pose(0.5, positions_mm, normals);
  const std::vector<Straight> before = hairs_of(organ, positions_mm, normals);
  const Placement motion{{3.0, -20.0, 50.0}, rotation_about(normalized(Vec3{1.0, 2.0, -0.5}), 2.0), 0.4};
  for (std::size_t i = 0; i < positions_mm.size(); ++i) {
    positions_mm[i] = apply(motion, positions_mm[i]);
    normals[i] = rotate(motion.rotation, normals[i]);
  }
  const std::vector<Straight> after = hairs_of(organ, positions_mm, normals, motion.scale);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_LT(length(after[i].root - apply(motion, before[i].root)), 1e-9);
    EXPECT_LT(length(after[i].tip - apply(motion, before[i].tip)), 1e-9);
  }
}

TEST(HairCoat, BendsFurtherOverItsLengthWhichItKeeps) {
  OrganShape shape = strap();
  shape.petals[0].poses.resize(1);
  shape.hairs = {hairs_on("blade")};
  shape.hairs[0].bend_deg = {90.0, 90.0};
  const OrganTemplate organ = grown(shape);
  std::vector<Vec3> positions_mm(organ.vertex_count());
  std::vector<Vec3> normals(organ.vertex_count());
  organ.pose(0.0, positions_mm, normals);
  Mesh mesh;
  organ.hairs().append(0, positions_mm, normals, 1.0, mesh);
  ASSERT_EQ(mesh.positions_mm.size() % 400, 0u);
  const std::size_t each = mesh.positions_mm.size() / 400;
  for (std::size_t hair = 0; hair < 400; ++hair) {
    const Vec3 tip = mesh.positions_mm[each * hair + each - 1];
    const Vec3 root =
        (mesh.positions_mm[each * hair] + mesh.positions_mm[each * hair + 1] + mesh.positions_mm[each * hair + 2]) /
        3.0;
    // A quarter of a circle of length 1 reaches 2 / pi both out and along.
    EXPECT_NEAR(root.x - tip.x, 2.0 / math::kPi, 0.01);
    EXPECT_NEAR(tip.z - root.z, 2.0 / math::kPi, 0.01);
  }
}

TEST(HairCoat, ItsTrianglesFaceOutwardsAsItsNormalsDo) {
  OrganShape shape = strap();
  shape.hairs = {hairs_on("blade"), hairs_on("blade")};
  shape.hairs[0].lower = true;
  shape.hairs[1].bend_deg = {10.0, 60.0};
  const OrganTemplate organ = grown(shape);
  std::vector<Vec3> positions_mm(organ.vertex_count());
  std::vector<Vec3> normals(organ.vertex_count());
  organ.pose(0.5, positions_mm, normals);
  for (const std::size_t group : {0u, 1u}) {
    Mesh mesh;
    organ.hairs().append(group, positions_mm, normals, 1.0, mesh);
    ASSERT_FALSE(mesh.triangles.empty());
    ASSERT_EQ(mesh.normals.size(), mesh.positions_mm.size());
    ASSERT_EQ(mesh.uvs.size(), mesh.positions_mm.size());
    for (const Triangle& t : mesh.triangles) {
      EXPECT_GT(dot(area_vector(mesh.positions_mm, t), mesh.normals[t[0]] + mesh.normals[t[1]]), 0.0);
    }
  }
}

TEST(HairCoat, OfAColumnStandsOnItsOutside) {
  Column column;
  column.name = "ovary";
  column.sides = 24;
  column.poses = {{0.0, {{1, 0}, {1, 2}, {1, 4}, {1, 6}}, 0.0}};
  OrganShape shape;
  shape.columns = {column};
  shape.hairs = {hairs_on("ovary")};
  const std::vector<Straight> hairs = hairs_at(grown(shape), 0.0);
  EXPECT_NEAR(static_cast<double>(hairs.size()), 20.0 * math::kTurnRad * 6.0, 0.02 * 20.0 * math::kTurnRad * 6.0);
  for (const Straight& hair : hairs) {
    EXPECT_GT(length(Vec2{hair.tip.x, hair.tip.y}), 1.9);
    EXPECT_NEAR(hair.tip.z, hair.root.z, 1e-9);
  }
}

TEST(HairCoat, IsAFunctionOfSeedAndVariantAndLeavesTheSurfaceAlone) {
  OrganShape bald = strap();
  OrganShape hairy = bald;
  hairy.hairs = {hairs_on("blade")};
  const auto first = [&](std::uint64_t seed, std::uint32_t variant) {
    return hairs_at(grown(hairy, 1.0, seed, variant), 0.0).front().root;
  };
  EXPECT_EQ(first(1, 2), first(1, 2));
  EXPECT_NE(first(1, 2), first(1, 3));
  EXPECT_NE(first(1, 2), first(2, 2));
  EXPECT_EQ(grown(bald).vertex_count(), grown(hairy).vertex_count());
  EXPECT_EQ(grown(bald).groups().size(), grown(hairy).groups().size());
}

TEST(HairCoat, RefusesMoreThanItsLimitBeforeMakingThem) {
  OrganShape shape = strap();
  shape.hairs = {hairs_on("blade")};
  shape.hairs[0].density_per_mm2 = 1000.0;
  EXPECT_TRUE(OrganTemplate::build(shape, 1.0, 1, 0));  // 20,000 on 20 square millimetres, a little less at the bend
  shape.hairs[0].lower = true;
  const auto refused = OrganTemplate::build(shape, 1.0, 1, 0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kTooLarge);
}

TEST(CheckHairs, NamesWhatIsWrong) {
  const auto error_with = [](auto spoil) {
    OrganShape shape = strap();
    Column column;
    column.name = "style";
    column.poses = {{0.0, {{1, 0}, {1, 2}, {1, 4}, {0, 6}}, 0.0}};
    shape.columns = {column};
    shape.hairs = {hairs_on("blade")};
    spoil(shape.hairs[0]);
    const auto error = check(shape, "organs.x");
    return error ? to_string(*error) : std::string("nothing");
  };
  EXPECT_EQ(error_with([](Hairs&) {}), "nothing");
  EXPECT_EQ(error_with([](Hairs& h) { h.on = "style"; }), "nothing");
  EXPECT_EQ(error_with([](Hairs& h) { h.on = "blde"; }),
            "organs.x.hairs[0].on must name petals or a column of the same organ, got \"blde\"; did you mean "
            "\"blade\"?");
  EXPECT_EQ(error_with([](Hairs& h) { h.on = "style", h.lower = true; }),
            "organs.x.hairs[0].lower must be false on a column, which has only an outside, got true");
  EXPECT_EQ(error_with([](Hairs& h) { h.upper = false; }),
            "organs.x.hairs[0].upper must be true unless lower is, got false");
  EXPECT_EQ(error_with([](Hairs& h) {
              h.along = {0.5, 0.5};
            }),
            "organs.x.hairs[0].along must be of some length, got 0.5");
  EXPECT_EQ(error_with([](Hairs& h) { h.density_per_mm2 = NAN; }).substr(0, 33), "organs.x.hairs[0].density_per_mm2");
}

}  // namespace
}  // namespace anthesis
