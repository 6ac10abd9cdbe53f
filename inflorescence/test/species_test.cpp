#include "anthesis/inflorescence/species.h"

#include <gtest/gtest.h>

#include <limits>

namespace anthesis {
namespace {

Species disc() {
  Pigment green;
  green.name = "green";
  Column peg;
  peg.name = "peg";
  peg.pigment = "green";
  peg.poses = {{0.0, {{0.2, 0}, {0.2, 1}, {0.2, 2}, {0, 3}}, 0.0}};
  OrganKind floret;
  floret.name = "floret";
  floret.shape.columns = {peg};
  Species species;
  species.name = "disc";
  species.pigments = {green};
  species.organs = {floret};
  species.head.receptacle = {{0.0, {{0, 1}, {1, 1}}}};
  species.head.zones = {{"floret", 0.0, 1.0}};
  return species;
}

TEST(CheckSpecies, AcceptsASmallDisc) {
  EXPECT_FALSE(check(disc())) << to_string(*check(disc()));
}

TEST(CheckSpecies, NamesTheFieldTheRuleAndTheValue) {
  Species species = disc();
  species.head.zones[0].organ = "flroet";
  ASSERT_TRUE(check(species));
  EXPECT_EQ(to_string(*check(species)), "head.zones.organ must name an organ, got flroet; did you mean floret?");
  species = disc();
  species.head.zones[0].from = 0.2;
  EXPECT_EQ(check(species)->where, "head.zones");
  species = disc();
  species.head.interval = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check(species)->where, "head.interval");
  species = disc();
  species.organs[0].variation.size = {2.0, 1.0};
  EXPECT_EQ(check(species)->where, "organs.floret.variation.size");
  species = disc();
  species.organs.push_back(species.organs[0]);
  EXPECT_EQ(check(species)->where, "organs");
  species = disc();
  species.pigments[0].translucency = 1.5;
  EXPECT_EQ(check(species)->where, "pigments.green.translucency");
  species = disc();
  species.head.fate = FateRule{"floret", "floret", 180.0};
  EXPECT_EQ(check(species)->where, "head.fate.cone_deg");
  species = disc();
  species.peduncle.length_mm = 10.0;
  EXPECT_EQ(check(species)->where, "peduncle.pigment");
}

TEST(CheckSpecies, OrgansMayCarryOrgansButNotThemselves) {
  Species species = disc();
  species.organs.push_back(species.organs[0]);
  species.organs[1].name = "cluster";
  species.organs[1].head = species.head;
  species.organs[1].head->zones = {{"floret", 0.0, 1.0}};
  species.head.zones = {{"cluster", 0.0, 1.0}};
  EXPECT_FALSE(check(species));
  species.organs[0].head = species.organs[1].head;
  species.organs[0].head->zones = {{"cluster", 0.0, 1.0}};  // a floret of clusters of florets of ...
  EXPECT_EQ(to_string(*check(species)), "organs.floret.head.zones must not lead back to the organ itself, got floret");
  species.organs[0].head->zones = {{"flower", 0.0, 1.0}};
  EXPECT_EQ(check(species)->where, "organs.floret.head.zones.organ");
}

TEST(CheckSpecies, AFormStandsAlongTwoDirections) {
  Species species = disc();
  species.organs[0].axis = {0.0, 0.0, 0.0};
  EXPECT_EQ(check(species)->where, "organs.floret.axis");
  species.organs[0].axis = {0.0, 2.0, 0.0};
  EXPECT_FALSE(check(species));
  species.organs[0].outward = {0.0, -1.0, 0.0};
  EXPECT_EQ(check(species)->where, "organs.floret.outward");
}

}  // namespace
}  // namespace anthesis
