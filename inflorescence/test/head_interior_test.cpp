#include "anthesis/inflorescence/head_interior.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "anthesis/base/parallel.h"
#include "anthesis/inflorescence/development.h"
#include "anthesis/vasculature/vein_measures.h"

namespace anthesis {
namespace {

/// A cap that grows tenfold while its ring runs from near the rim to the apex.
Species cap() {
  Species species;
  species.name = "cap";
  Pigment green;
  green.name = "green";
  green.colour = {{0.0, {0.2, 0.4, 0.1}}};
  species.pigments = {green};
  for (const char* name : {"bract", "floret"}) {
    Column column;
    column.name = "body";
    column.pigment = "green";
    column.poses = {{.stage = 0.0, .profile_mm = {{0.2, 0.0}, {0.2, 0.3}, {0.2, 0.6}, {0.0, 0.6}}, .lean_deg = 0.0}};
    OrganKind kind;
    kind.name = name;
    kind.shape.columns = {column};
    species.organs.push_back(kind);
  }
  species.head.rule = PlacementRule::kActiveRing;
  ActiveRing& ring = species.head.active_ring.emplace();
  const double rings[] = {0.6, 0.35, 0.1, 0.0};
  const double sizes[] = {0.5, 1.5, 4.0, 5.0};
  for (int i = 0; i < 4; ++i) {
    const double r = sizes[i];
    ring.sections.push_back(
        {{{0.0, r}, {0.6 * r, r}, {r, 0.7 * r}, {1.1 * r, 0.3 * r}, {0.9 * r, 0.0}}, {0.8}, rings[i]});
  }
  ring.threshold_mm = {{0.0, 0.6}, {1.0, 0.6}};
  ring.floret = "floret";
  ring.bract = "bract";
  ring.bract_landmark = 1;
  HeadVeins& veins = species.vasculature.emplace();
  veins.params = bellis_veins(VeinSource::kAsPublished);
  veins.frames = 300;
  return species;
}

std::vector<VeinPrimordium> primordia_of(const Species& species) {
  return head_primordia(species, *head_ring(species));
}

/// The error of check, without the optional around it.
std::string wrong_with(const Species& species) {
  const auto error = check(species);
  return error ? to_string(*error) : "nothing";
}

TEST(HeadInterior, OrgansOfTheHeadAreThePrimordiaOfItsVeins) {
  const Species species = cap();
  ASSERT_EQ(wrong_with(species), "nothing");
  const auto primordia = primordia_of(species);
  const auto development = Development::grow(species, {.seed = 1, .detail = 0.5});
  ASSERT_TRUE(development.has_value()) << to_string(development.error());
  ASSERT_EQ(development->organs().size(), primordia.size());
  EXPECT_GT(primordia.size(), 40u);
  std::multiset<double> of_organs;
  std::multiset<double> of_veins;
  std::size_t bracts = 0;
  for (const Organ& organ : development->organs()) {
    of_organs.insert(organ.azimuth_rad);
    bracts += species.organs[organ.kind].name == "bract" ? 1 : 0;
  }
  for (const VeinPrimordium& one : primordia) {
    of_veins.insert(one.azimuth_rad);
    bracts -= one.kind == PrimordiumKind::kBract ? 1 : 0;
  }
  EXPECT_EQ(of_organs, of_veins);
  EXPECT_EQ(bracts, 0u);
}

TEST(HeadInterior, OfAPointedHeadHasVeins) {
  Species species = cap();
  species.head.active_ring->sections.back().points = {{0, 5}, {0.001, 5}, {0.4, 3}, {5, 1}, {3.6, 0}};
  ASSERT_EQ(wrong_with(species), "nothing");
  const auto contours = head_contours(species);
  ASSERT_TRUE(contours.has_value());
  const auto veins = head_veins(species, *contours, primordia_of(species));
  ASSERT_TRUE(veins.has_value()) << to_string(veins.error());
  EXPECT_GT(veins->vertices.size(), 100u);
}

TEST(HeadInterior, OutlinesThatCrossThemselvesAreRefusedEarly) {
  Species species = cap();
  const std::vector<HeadSection> simple = species.head.active_ring->sections;
  species.head.active_ring->sections[2].points = {{0, 4}, {4, 1}, {4, 4}, {1, 2}, {3, 0}};
  EXPECT_THAT(wrong_with(species), testing::HasSubstr("head.active_ring.sections[2].points must not touch or cross"));
  // A cone and a section in folds, one above the other: half way the cone's fall tilts the folds into each other.
  species.head.active_ring->sections = simple;
  std::vector<HeadSection>& sections = species.head.active_ring->sections;
  sections[1].points = {{0, 8}, {3, 6}, {6, 4}, {9, 2}};
  sections[2].points = {{0, 3}, {4, 3},   {8, 3}, {9, 3.5}, {8, 4},  {5, 4},
                        {2, 4}, {1, 4.5}, {2, 5}, {9, 5},   {10, 3}, {9, 0}};
  ASSERT_EQ(wrong_with(species), "nothing");
  const auto contours = head_contours(species);
  ASSERT_FALSE(contours.has_value());
  EXPECT_THAT(to_string(contours.error()), testing::HasSubstr("must blend into outlines that do not cross"));
}

TEST(HeadInterior, OrgansKeepTheirDistanceWhenTheyArise) {
  const Species species = cap();
  const auto development = Development::grow(species, {.seed = 1, .detail = 0.5});
  ASSERT_TRUE(development.has_value());
  // The threshold is constant and the head grows: no two mature organs are closer than nine tenths of it (sideways
  // movement may bring a pair slightly nearer). About the apex the model's distances, along parallels, are too long.
  const Canopy mature = development->at(1.0);
  double nearest = 1e9;
  for (std::size_t i = 0; i < mature.organs.size(); ++i) {
    for (std::size_t j = 0; j < i && mature.organs[i].s > 0.25; ++j) {
      nearest = std::min(nearest, length(mature.organs[i].world_from_organ.position_mm -
                                         mature.organs[j].world_from_organ.position_mm));
    }
  }
  EXPECT_GT(nearest, 0.9 * 0.6);
  EXPECT_LT(nearest, 2.0 * 0.6);
}

TEST(HeadInterior, OrgansStandOnTheReceptacleAtAllTimes) {
  const Species species = cap();
  const auto development = Development::grow(species, {.seed = 1, .detail = 0.5});
  ASSERT_TRUE(development.has_value());
  const GrowingReceptacle head(digitised_head(*species.head.active_ring));
  for (const double time : {0.1, 0.5, 1.0}) {
    const SurfaceOfRevolution surface = development->receptacle(time);
    for (const double s : {0.1, 0.45, 0.8}) {  // the spline keeps to the blended sections
      const Vec2 point = surface.profile_mm().at(s);
      EXPECT_NEAR(length(point - head.point(time, s)), 0.0, 2e-3 * head.length(time)) << time << ' ' << s;
    }
    for (const OrganState& organ : development->at(time).organs) {
      const Vec3 p = organ.world_from_organ.position_mm;
      const Vec2 on = surface.profile_mm().at(surface.t_from_s(organ.s));
      EXPECT_NEAR(std::hypot(p.x, p.y), on.x, 1e-6);
      EXPECT_NEAR(p.z, on.y, 1e-6);
    }
  }
}

TEST(HeadInterior, VeinsConnectAllPrimordiaWithinTheHead) {
  const Species species = cap();
  const auto primordia = primordia_of(species);
  const auto contours = head_contours(species);
  ASSERT_TRUE(contours.has_value());
  EXPECT_EQ(contours->frames(), 300u);
  const auto veins = head_veins(species, *contours, primordia);
  ASSERT_TRUE(veins.has_value()) << to_string(veins.error());
  const VasculatureMeasures measures = measure(*veins);
  for (std::size_t i = 0; i < primordia.size(); ++i) {
    EXPECT_TRUE(measures.strands[i].connected || measures.strands[i].vertex == kNoVertex) << i;
  }
  const double top = contours->frame(299).front().position.y;
  for (const VeinVertex& vertex : veins->vertices) {
    EXPECT_GE(vertex.position.z, -1e-6);
    EXPECT_LE(vertex.position.z, top + 1e-6);
    EXPECT_LE(std::hypot(vertex.position.x, vertex.position.y), 1.1 * 5.0);
  }
}

TEST(HeadInterior, BothWaysToMoveTheInsideGiveMuchTheSameVeins) {
  Species species = cap();
  const auto primordia = primordia_of(species);
  const auto contours = head_contours(species);
  const auto harmonic = head_veins(species, *contours, primordia);
  species.vasculature->inside = HeadInside::kMeanValue;
  const auto mean_value = head_veins(species, *contours, primordia);
  ASSERT_TRUE(harmonic && mean_value);
  const auto count = [](const auto& veins) { return static_cast<double>(veins->vertices.size()); };
  EXPECT_NEAR(count(harmonic), count(mean_value), 0.1 * count(harmonic));
}

TEST(HeadInterior, TheConditionOnTheAxisIsTheSpecies) {
  Species species = cap();
  const auto contours = head_contours(species);
  const auto beside_the_axis = [&] {  // where tissue goes that starts near the axis
    InteriorGrowth inside = *head_inside(species, *contours);
    std::vector<Vec2> points = {{0.01, 0.2}};
    for (std::size_t f = 0; f + 1 < inside.frames(); ++f) {
      EXPECT_FALSE(inside.advance(f).has_value());
      inside.carry(points);
    }
    return points[0].x;
  };
  const double natural = beside_the_axis();
  species.vasculature->axis = AxisCondition::kZero;
  EXPECT_GT(natural, 5.0 * beside_the_axis());
}

TEST(HeadInterior, IsTheSameForAnyNumberOfThreads) {
  const Species species = cap();
  const auto positions = [&](int threads) {
    const ThreadLimit limit(threads);
    const auto veins = head_veins(species, *head_contours(species), primordia_of(species));
    std::vector<double> z;
    for (const VeinVertex& vertex : veins->vertices) {
      z.push_back(vertex.position.z);
    }
    return z;
  };
  EXPECT_EQ(positions(1), positions(2));
}

TEST(HeadInterior, ThePublishedClockSeesOlderOutlines) {
  Species species = cap();
  species.vasculature->clock = VeinClock::kPublished;
  species.vasculature->pace = {{0.0, 0.42}, {0.5, 0.22}, {1.0, 0.02}};
  const auto contours = head_contours(species);
  ASSERT_TRUE(contours.has_value());
  const auto primordia = primordia_of(species);
  for (const VeinPrimordium& one : primordia) {
    if (one.birth_frame < 1800) {  // later both are nearly grown; born at 0.0005 a step on a head of that time
      EXPECT_GE(contours->times[one.birth_frame] + 1e-12, std::min(1.0, 0.0005 * one.birth_frame));
    }
  }
}

TEST(HeadInterior, SaysWhatIsWrongWithAHead) {
  const auto after = [](auto&& change) {
    Species species = cap();
    change(species, *species.head.active_ring);
    return wrong_with(species);
  };
  using testing::HasSubstr;
  EXPECT_THAT(after([](Species& s, ActiveRing&) { s.head.rule = PlacementRule::kRidley; }),
              HasSubstr("head.active_ring must come with rule"));
  EXPECT_THAT(after([](Species& s, ActiveRing&) { s.head.active_ring.reset(); }),
              HasSubstr("head.active_ring must be given with rule"));
  EXPECT_THAT(after([](Species&, ActiveRing& ring) { ring.sections[1].points.resize(3); }),
              HasSubstr("head.active_ring.sections[1].points must be at least 4, got 3"));
  EXPECT_THAT(after([](Species&, ActiveRing& ring) { ring.sections[1].points[2].x = -1.0; }),
              HasSubstr("head.active_ring.sections[1].points"));
  EXPECT_THAT(after([](Species&, ActiveRing& ring) {
                ring.sections[2].landmarks = {0.5, 0.6};
              }),
              HasSubstr("head.active_ring.sections[2].landmarks[1] must descend"));
  EXPECT_THAT(after([](Species&, ActiveRing& ring) {
                ring.knots = {0.0, 1.0};
              }),
              HasSubstr("head.active_ring.knots must be three more than the 4 sections"));
  EXPECT_THAT(after([](Species&, ActiveRing& ring) { ring.bract_landmark = 7; }),
              HasSubstr("head.active_ring.bract_landmark must be one of the profile's 1, got 7"));
  EXPECT_THAT(after([](Species&, ActiveRing& ring) { ring.bract = "brakt"; }),
              HasSubstr("head.active_ring.bract must name an organ, got brakt; did you mean bract?"));
  EXPECT_THAT(after([](Species&, ActiveRing& ring) { ring.threshold_mm[1].y = 0.0; }),
              HasSubstr("head.active_ring.threshold_mm"));
  EXPECT_THAT(after([](Species& s, ActiveRing&) {
                s.head.zones = {{"floret", 0.0, 1.0}};
              }),
              HasSubstr("head.zones must be left out with rule active_ring"));
  EXPECT_THAT(after([](Species& s, ActiveRing&) { s.vasculature->params.initials[0].depth_mm = 0.0; }),
              HasSubstr("vasculature.bract.depth_mm"));
  EXPECT_THAT(after([](Species& s, ActiveRing&) { s.vasculature->params.tip_diameter_mm[2] = 0.0; }),
              HasSubstr("vasculature.adaxial_tip_mm"));
  EXPECT_THAT(after([](Species& s, ActiveRing&) { s.vasculature->frames = 1; }), HasSubstr("vasculature.frames"));
}

}  // namespace
}  // namespace anthesis
