#include "anthesis/corolla/organ_template.h"

#include <gtest/gtest.h>

#include <map>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

PetalPose pose(double stage, std::vector<Vec2> midrib, std::vector<double> half_width) {
  PetalPose result;
  result.stage = stage;
  result.midrib_mm = std::move(midrib);
  result.half_width_mm = std::move(half_width);
  result.sections = {{{0, 0, 0}, {0.5, 0.06, 0}, {1, 0.325, 0}}};
  return result;
}

/// Five petals fused into a tube, their lobes free: a disk floret's corolla.
OrganShape tube() {
  Petals petals;
  petals.name = "corolla";
  petals.count = 5;
  petals.fused = 5;
  petals.degree_along = 2;
  petals.degree_across = 2;
  petals.spacing = {{0, 0.1}, {1, 0.1}};
  petals.vertices = {{0, 3}, {0.8, 3}, {1, 1}};
  petals.poses = {
      pose(0, {{1, 0}, {1, 2}, {1, 4}, {1.1, 6}, {1.1, 7}, {0.6, 8}, {0.1, 8.2}}, {0.6, 0.6, 0.6, 0.65, 0.65, 0.3, 0}),
      pose(1, {{1, 0}, {1, 2}, {1, 4}, {1.2, 6}, {1.4, 7}, {2.4, 7.6}, {3, 7.2}}, {0.6, 0.6, 0.6, 0.7, 0.7, 0.4, 0})};
  OrganShape shape;
  shape.petals = {petals};
  return shape;
}

/// Three petals fused to the tip, side by side.
OrganShape ligule() {
  const auto petals = [](const char* name) {
    Petals p;
    p.name = name;
    p.spacing = {{0, 0.1}, {1, 0.1}};
    p.vertices = {{0, 3}, {1, 3}};
    p.poses = {pose(0, {{0, 0}, {0, 3}, {0, 6}, {-1, 9}, {-2, 12}}, {0.4, 0.6, 0.7, 0.6, 0.3}),
               pose(1, {{0, 0}, {0, 3}, {4, 6}, {9, 7}, {15, 6}}, {0.5, 0.9, 1.6, 1.6, 0.8})};
    return p;
  };
  OrganShape shape;
  shape.petals = {petals("median"), petals("lateral")};
  Petals& lateral = shape.petals[1];
  lateral.mirrored = true;
  lateral.fused = 5;
  lateral.fused_with = "median";
  lateral.poses[0].side_mm = {0.8, 1.2, 1.4, 1.2, 0.6};
  lateral.poses[1].side_mm = {1.0, 1.8, 3.2, 3.2, 1.6};
  return shape;
}

/// A ray rolled into a closed quill that opens into a spoon, as in a ball dahlia.
OrganShape quill() {
  const std::vector<SectionPoint> closed = {{0, 0, 0},      {0.55, 0, 0},   {0.98, 0.4, 0}, {1.08, 1, 0},
                                            {0.95, 1.6, 0}, {0.5, 1.95, 0}, {0.15, 1.86, 0}};
  const std::vector<SectionPoint> spoon = {{0, 0, 0},       {0.5, 0.02, 0}, {0.85, 0.15, 0}, {1.05, 0.3, 0},
                                           {1.15, 0.55, 0}, {1.1, 0.85, 0}, {1, 1.1, 0}};
  Petals petals;
  petals.name = "ligule";
  petals.spacing = {{0, 0.08}, {1, 0.08}};
  petals.vertices = {{0, 11}, {1, 11}};
  petals.poses.resize(2);
  petals.poses[0].midrib_mm = {{1, 0}, {1, 4}, {1, 8}, {1, 12}, {0, 16}, {-1, 20}};
  petals.poses[0].half_width_mm = {1, 1, 1, 1, 1, 0.8};
  petals.poses[0].sections = {closed};
  petals.poses[1].stage = 1.0;
  petals.poses[1].midrib_mm = {{1, 0}, {1, 5}, {2, 10}, {3, 15}, {4, 20}, {4, 25}};
  petals.poses[1].half_width_mm = {1, 1.5, 2.5, 3.5, 4.5, 4};
  petals.poses[1].sections = {closed, closed, closed, closed, spoon, spoon};
  OrganShape shape;
  shape.petals = {petals};
  return shape;
}

struct Posed {
  std::vector<Vec3> positions_mm;
  std::vector<Vec3> normals;
};

Posed pose_of(const OrganTemplate& organ, double stage) {
  Posed posed{std::vector<Vec3>(organ.vertex_count()), std::vector<Vec3>(organ.vertex_count())};
  organ.pose(stage, posed.positions_mm, posed.normals);
  return posed;
}

TEST(OrganTemplate, FusedNeighboursShareTheirMarginToTheLastBitAtEveryStage) {
  const OrganTemplate organ = *OrganTemplate::build(tube(), 1.0, 1, 0);
  const auto twins = organ.twins();
  std::size_t joined = 0;
  for (std::uint32_t i = 0; i < twins.size(); ++i) {
    joined += twins[i] != i;
  }
  // Seven rows of ten lie at v <= 0.6, where the five margins are fused.
  EXPECT_EQ(joined, 5u * 7u);
  for (const double stage : {0.0, 0.17, 0.5, 0.83, 1.0}) {
    const Posed posed = pose_of(organ, stage);
    for (std::uint32_t i = 0; i < twins.size(); ++i) {
      EXPECT_EQ(posed.positions_mm[i], posed.positions_mm[twins[i]]);
      EXPECT_EQ(posed.normals[i], posed.normals[twins[i]]);
    }
  }
}

TEST(OrganTemplate, AFusedTubeHasNoHoleBelowItsLobes) {
  // Each edge of the tube below v = 0.6 must have a triangle on both sides once twins are one.
  const OrganTemplate organ = *OrganTemplate::build(tube(), 1.0, 1, 0);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : organ.triangles()) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = organ.twins()[t[k]];
      const std::uint32_t b = organ.twins()[t[(k + 1) % 3]];
      ++edges[{std::min(a, b), std::max(a, b)}];
    }
  }
  for (const auto& [edge, uses] : edges) {
    const double low = std::min(organ.uvs()[edge.first].y, organ.uvs()[edge.second].y);
    const double high = std::max(organ.uvs()[edge.first].y, organ.uvs()[edge.second].y);
    if (high <= 0.6 && low > 0.0) {
      EXPECT_EQ(uses, 2);
    }
    EXPECT_LE(uses, 2);
  }
}

TEST(OrganTemplate, PetalsOfARingAreImagesOfOneAnother) {
  const OrganTemplate organ = *OrganTemplate::build(tube(), 1.0, 1, 0);
  const Posed posed = pose_of(organ, 0.4);
  const std::size_t each = posed.positions_mm.size() / 5;
  for (std::size_t k = 1; k < 5; ++k) {
    const Quaternion turn = rotation_about({0, 0, 1}, math::kTurnRad * static_cast<double>(k) / 5);
    for (std::size_t i = 0; i < each; ++i) {
      EXPECT_NEAR(length(posed.positions_mm[k * each + i] - rotate(turn, posed.positions_mm[i])), 0.0, 1e-12);
    }
  }
}

TEST(OrganTemplate, PetalsOfALiguleAreOneSurfaceAndMirrorImages) {
  const OrganTemplate organ = *OrganTemplate::build(ligule(), 1.0, 1, 0);
  std::size_t joined = 0;
  for (std::uint32_t i = 0; i < organ.twins().size(); ++i) {
    joined += organ.twins()[i] != i;
  }
  EXPECT_EQ(joined, 2u * 11u);  // both seams, all eleven rows
  const Posed posed = pose_of(organ, 0.6);
  const TemplateGroup lateral = organ.groups()[1];
  const std::uint32_t each = lateral.vertex_count / 2;
  for (std::uint32_t i = 0; i < each; ++i) {
    const Vec3 left = posed.positions_mm[lateral.first_vertex + i];
    const Vec3 right = posed.positions_mm[lateral.first_vertex + each + i];
    EXPECT_NEAR(length(left - Vec3{right.x, -right.y, right.z}), 0.0, 1e-12);
  }
}

TEST(OrganTemplate, ATwistedLiguleKeepsItsLateralPetalsBesideTheMedianOne) {
  OrganShape shape = ligule();
  shape.variation.twist_deg = {40, 40};
  shape.variation.sway_deg = {25, 25};
  const OrganTemplate organ = *OrganTemplate::build(shape, 1.0, 1, 1);
  const Posed posed = pose_of(organ, 1.0);
  // Along each row the three petals follow one another from left to right: no step back at the seams.
  const TemplateGroup lateral = organ.groups()[1];
  for (const std::uint32_t row : {2u, 5u, 8u}) {
    const auto vertex = [&](std::uint32_t first, std::uint32_t column) {
      return posed.positions_mm[first + 3 * row + column];
    };
    const std::uint32_t left = lateral.first_vertex;
    const std::uint32_t right = left + lateral.vertex_count / 2;  // mirrored: its u runs from right to left
    const Vec3 line[] = {vertex(left, 0),  vertex(left, 1),  vertex(left, 2), vertex(0, 1),
                         vertex(right, 2), vertex(right, 1), vertex(right, 0)};
    for (int i = 1; i + 1 < 7; ++i) {
      EXPECT_GT(dot(normalized(line[i] - line[i - 1]), normalized(line[i + 1] - line[i])), 0.7) << row << " " << i;
    }
  }
}

TEST(OrganTemplate, NoTriangleIsDegenerateOrInvertedAtAnyStage) {
  for (const OrganShape& shape : {tube(), ligule(), quill()}) {
    for (const double detail : {1.0, 2.0, 3.0}) {
      const OrganTemplate organ = *OrganTemplate::build(shape, detail, 1, 0);
      for (int step = 0; step <= 20; ++step) {
        Posed posed = pose_of(organ, step / 20.0);
        // Each petal by itself: at a seam the common normal belongs to neither side.
        smooth_normals(posed.positions_mm, organ.triangles(), {}, posed.normals);
        for (const Triangle& t : organ.triangles()) {
          const Vec3 normal = area_vector(posed.positions_mm, t);
          const Vec3 side = posed.positions_mm[t[1]] - posed.positions_mm[t[0]];
          EXPECT_GT(length(normal), 1e-3 * dot(side, side));
          EXPECT_GT(dot(normal, posed.normals[t[0]]), 0.0);
        }
      }
    }
  }
}

TEST(OrganTemplate, ColumnsArePointedClosedAndFaceOutwards) {
  Column column;
  column.name = "style";
  column.count = 3;
  column.ring_radius_mm = 2.0;
  column.poses = {{0.0, {{0.5, 0}, {0.5, 1}, {0.4, 2}, {0.0, 3}}, 0.0},
                  {1.0, {{0.5, 0}, {0.5, 2}, {0.4, 5}, {0.0, 6}}, 30.0}};
  OrganShape shape;
  shape.columns = {column};
  const OrganTemplate organ = *OrganTemplate::build(shape, 1.0, 1, 0);
  for (const double stage : {0.0, 0.5, 1.0}) {
    const Posed posed = pose_of(organ, stage);
    Vec3 middle{};
    for (std::size_t i = 0; i < posed.positions_mm.size() / 3; ++i) {
      middle += posed.positions_mm[i] / (static_cast<double>(posed.positions_mm.size()) / 3);
    }
    for (std::size_t k = 0; k < organ.triangles().size() / 3; ++k) {
      const Triangle t = organ.triangles()[k];
      const Vec3 normal = area_vector(posed.positions_mm, t);
      EXPECT_GT(length(normal), 1e-6);
      EXPECT_GT(dot(normal, posed.positions_mm[t[0]] - middle), 0.0);
    }
  }
  // The tip of the first column leans outwards by half the lean at half the time.
  const Posed half = pose_of(organ, 0.5);
  const Vec3 tip = half.positions_mm[organ.groups()[0].vertex_count / 3 - 1];
  EXPECT_NEAR(tip.x, 2.0 + 4.5 * math::sin(math::radians(15.0)), 1e-12);
  EXPECT_NEAR(tip.z, 4.5 * math::cos(math::radians(15.0)), 1e-12);
}

TEST(OrganTemplate, AMarginMayRollInwardsUntilItNearlyMeetsTheOther) {
  ASSERT_FALSE(check(quill(), "organs.x"));
  const OrganTemplate organ = *OrganTemplate::build(quill(), 1.0, 1, 0);
  for (const double stage : {0.0, 0.4, 0.7, 1.0}) {
    const Posed posed = pose_of(organ, stage);
    for (std::uint32_t left = 0; left + 10 < organ.vertex_count(); left += 11) {
      const double v = organ.uvs()[left].y;
      if (v > (stage < 1.0 ? 0.3 : 0.4)) {
        continue;  // the spoon begins
      }
      const Vec3 gap = posed.positions_mm[left] - posed.positions_mm[left + 10];
      const Vec3 middle = posed.positions_mm[left + 5];
      const Vec3 margins = 0.5 * (posed.positions_mm[left] + posed.positions_mm[left + 10]);
      // The left margin stays left of the right one, across the tube from the midrib.
      EXPECT_GT(gap.y, 0.0) << stage << " " << v;
      EXPECT_LT(length(gap), 0.3 * length(margins - middle)) << stage << " " << v;
      // The upper side is the inside.
      const Vec3 axis = 0.5 * (middle + margins);
      for (std::uint32_t i = left; i <= left + 10; ++i) {
        EXPECT_GT(dot(posed.normals[i], axis - posed.positions_mm[i]), 0.0) << stage << " " << v;
      }
    }
  }
}

TEST(OrganTemplate, VariantsDifferAndRepeat) {
  OrganShape shape = ligule();
  shape.variation.curl_deg = {-20, 20};
  const auto tip = [&](std::uint64_t seed, std::uint32_t variant) {
    const OrganTemplate organ = *OrganTemplate::build(shape, 1.0, seed, variant);
    return pose_of(organ, 1.0).positions_mm.back();
  };
  EXPECT_EQ(tip(1, 2), tip(1, 2));
  EXPECT_NE(tip(1, 2), tip(1, 3));
  EXPECT_NE(tip(1, 2), tip(2, 2));
}

TEST(OrganTemplate, VerticesAreCountedBeforeTheyAreMade) {
  for (const OrganShape& shape : {tube(), ligule()}) {
    for (const double detail : {0.3, 1.0, 2.5}) {
      EXPECT_EQ(OrganTemplate::count_vertices(shape, detail),
                OrganTemplate::build(shape, detail, 1, 0)->vertex_count());
    }
  }
  OrganShape huge = tube();
  huge.petals[0].count = 64;
  huge.petals[0].spacing = {{0, 0.002}, {1, 0.002}};
  huge.petals[0].vertices = {{0, 200}, {1, 200}};
  const auto refused = OrganTemplate::build(huge, 8.0, 1, 0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kTooLarge);
}

TEST(CheckOrganShape, NamesWhatIsWrong) {
  EXPECT_FALSE(check(tube(), "organs.x"));
  EXPECT_FALSE(check(ligule(), "organs.x"));
  OrganShape shape = tube();
  shape.petals[0].poses[1].midrib_mm.pop_back();
  EXPECT_EQ(check(shape, "organs.x")->where, "organs.x.petals[0].poses[1].half_width_mm");
  shape = tube();
  shape.petals[0].poses[1].stage = 0.0;
  EXPECT_EQ(check(shape, "organs.x")->where, "organs.x.petals[0].poses[1].stage");
  shape = tube();
  shape.petals[0].spacing[0].y = 0.0;
  EXPECT_EQ(check(shape, "organs.x")->where, "organs.x.petals[0].spacing");
  shape = quill();
  shape.petals[0].poses[0].sections[0][3].across = -0.1;  // beyond the midrib
  EXPECT_EQ(check(shape, "organs.x")->where, "organs.x.petals[0].poses[0].sections");
  shape = tube();
  std::swap(shape.petals[0].poses[0].sections[0][1], shape.petals[0].poses[0].sections[0][2]);  // there and back
  EXPECT_EQ(check(shape, "organs.x")->where, "organs.x.petals[0].poses[0].sections");
  shape = ligule();
  shape.petals[1].fused_with = "corona";
  EXPECT_EQ(check(shape, "organs.x")->where, "organs.x.petals[1].fused_with");
  EXPECT_EQ(check(OrganShape{}, "organs.x")->where, "organs.x");
}

}  // namespace
}  // namespace anthesis
