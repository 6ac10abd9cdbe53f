#include "anthesis/exchange/species_key.h"

#include <gmock/gmock.h>

#include "anthesis/exchange/species_file.h"

namespace anthesis {
namespace {

using testing::HasSubstr;

Species head() {
  Species species = *find_species("sunflower-head");
  return species;
}

std::string message(const std::optional<Error>& error) {
  return error ? to_string(*error) : "no error";
}

TEST(SpeciesKey, SetsNumbersWhereverTheyStand) {
  Species species = head();
  EXPECT_EQ(message(set_number(species, "vasculature.sector_weight", 0.25)), "no error");
  EXPECT_EQ(species.vasculature->params.sector_weight, 0.25);
  EXPECT_EQ(message(set_number(species, "head.active_ring.sections[1].ring", 0.5)), "no error");
  EXPECT_EQ(species.head.active_ring->sections[1].ring, 0.5);
  EXPECT_EQ(message(set_number(species, "vasculature.ring_vertices", 21)), "no error");
  EXPECT_EQ(species.vasculature->params.ring_vertices, 21);
  EXPECT_EQ(message(set_number(species, "organs." + species.organs[0].name + ".sink_mm", 0.125)), "no error");
  EXPECT_EQ(species.organs[0].sink_mm, 0.125);
  EXPECT_EQ(message(set_number(species, "vasculature.floret.jitter.strength", 0.75)), "no error");
  EXPECT_EQ(species.vasculature->params.initials[2].jitter.strength, 0.75);
}

TEST(SpeciesKey, KnowsTheSymbolsOfThePaper) {
  Species species = head();
  EXPECT_EQ(whole_key("mu_sec"), "vasculature.sector_weight");
  EXPECT_EQ(whole_key("floret.depth_mm"), "vasculature.floret.depth_mm");
  EXPECT_EQ(whole_key("organs.floret.sink_mm"), "organs.floret.sink_mm");
  EXPECT_EQ(message(set_number(species, "mu_sec", 0.75)), "no error");
  EXPECT_EQ(species.vasculature->params.sector_weight, 0.75);
  EXPECT_EQ(message(set_number(species, "kappa", 1.5)), "no error");
  EXPECT_EQ(species.vasculature->params.reticulation.ratio_limit, 1.5);
}

TEST(SpeciesKey, SetsWhatTheSymbolsOfAllStrandsStandFor) {
  Species species = head();
  EXPECT_EQ(message(set_number(species, "eta", 0.25)), "no error");
  EXPECT_EQ(message(scale_number(species, "gamma_max", 0.0)), "no error");
  for (const VeinInitial& initial : species.vasculature->params.initials) {
    for (const VeinJitter& jitter : {initial.jitter, initial.strand_jitter}) {
      EXPECT_EQ(jitter.probability, 0.25);
      EXPECT_EQ(jitter.strength, 0.0);
    }
  }
  EXPECT_EQ(message(set_number(species, "rho", 0.125)), "no error");
  EXPECT_EQ(species.vasculature->params.tip_diameter_mm, (std::array{0.125, 0.125, 0.125}));
  const std::string before = write_species(species);
  EXPECT_THAT(message(set_number(species, "eta", 1.5)), HasSubstr("must be in [0, 1], got 1.5"));
  EXPECT_EQ(write_species(species), before);
}

TEST(SpeciesKey, MakesCoursesConstantAndRangesSingle) {
  Species species = head();
  EXPECT_EQ(message(set_number(species, "r_G", 1.5)), "no error");
  for (const double time : {0.0, 0.4, 1.0}) {
    EXPECT_EQ(species.vasculature->params.ground_resistivity.at(time), 1.5);
  }
  EXPECT_EQ(message(set_number(species, "vasculature.floret.delay_frames", 7)), "no error");
  EXPECT_EQ(species.vasculature->params.initials[2].delay_frames, (std::array{7, 7}));
}

TEST(SpeciesKey, ReachesNumbersWithinLists) {
  Species species = head();
  ActiveRing& ring = *species.head.active_ring;
  EXPECT_EQ(message(set_number(species, "head.active_ring.sections[1].landmarks[2]", 0.25)), "no error");
  EXPECT_EQ(ring.sections[1].landmarks[2], 0.25);
  EXPECT_EQ(message(set_number(species, "head.active_ring.threshold_mm[1][1]", 0.125)), "no error");
  EXPECT_EQ(ring.threshold_mm[1].y, 0.125);
  EXPECT_EQ(message(set_number(species, "head.active_ring.sections[0].points[2][0]", 0.5)), "no error");
  EXPECT_EQ(ring.sections[0].points[2].x, 0.5);
  EXPECT_EQ(message(set_number(species, "colonisation.window[1]", 0.75)), "no error");
  EXPECT_EQ(species.vasculature->params.colonisation.window[1], 0.75);
  EXPECT_EQ(message(set_number(species, "organs." + species.organs[0].name + ".axis[2]", 2.0)), "no error");
  EXPECT_EQ(species.organs[0].axis.z, 2.0);
}

TEST(SpeciesKey, ScalesNumbersListsAndTheValuesOfFunctions) {
  const Species before = head();
  Species species = before;
  const ActiveRing& was = *before.head.active_ring;
  const ActiveRing& ring = *species.head.active_ring;
  EXPECT_EQ(message(scale_number(species, "mu_sec", 2.0)), "no error");
  EXPECT_EQ(species.vasculature->params.sector_weight, 2.0 * before.vasculature->params.sector_weight);
  EXPECT_EQ(message(scale_number(species, "head.active_ring.threshold_mm", 1.5)), "no error");
  ASSERT_GT(ring.threshold_mm.size(), 2u);
  for (std::size_t i = 0; i < ring.threshold_mm.size(); ++i) {
    EXPECT_EQ(ring.threshold_mm[i], (Vec2{was.threshold_mm[i].x, 1.5 * was.threshold_mm[i].y}));
  }
  EXPECT_EQ(message(scale_number(species, "head.active_ring.sections[3].points", 0.5)), "no error");
  for (std::size_t i = 0; i < ring.sections[3].points.size(); ++i) {
    EXPECT_EQ(ring.sections[3].points[i], 0.5 * was.sections[3].points[i]);
  }
  EXPECT_EQ(message(scale_number(species, "ring_vertices", 2.0)), "no error");
  EXPECT_EQ(species.vasculature->params.ring_vertices, 2 * before.vasculature->params.ring_vertices);
  const std::array<int, 2> delay = before.vasculature->params.initials[0].delay_frames;
  EXPECT_EQ(message(scale_number(species, "bract.delay_frames", 3.0)), "no error");
  EXPECT_EQ(species.vasculature->params.initials[0].delay_frames, (std::array{3 * delay[0], 3 * delay[1]}));
}

TEST(SpeciesKey, RefusesWithTheRuleAndLeavesTheSpeciesAlone) {
  Species species = head();
  const std::string before = write_species(species);
  const auto refused = [&](std::string_view key, double value) { return message(set_number(species, key, value)); };
  EXPECT_THAT(refused("vasculature.sector_wieght", 1.0), HasSubstr("did you mean sector_weight?"));
  EXPECT_THAT(refused("sector_wieght", 1.0), HasSubstr("did you mean sector_weight?"));
  EXPECT_THAT(refused("mu_sek", 1.0), HasSubstr("vasculature.mu_sek is not known; did you mean mu_sec?"));
  EXPECT_THAT(refused("mu_sec", -1.0), HasSubstr("vasculature.sector_weight must be in [0, 1e+06], got -1"));
  EXPECT_THAT(refused("ring_vertices", 2.5), HasSubstr("must be a whole number in [1, 100000], got 2.5"));
  EXPECT_THAT(refused("join", 1.0), HasSubstr("must be a number, which this key is not"));
  EXPECT_THAT(refused("head.active_ring.sections[99].ring", 0.5), HasSubstr("must be that of one of"));
  EXPECT_THAT(refused("organs.nobody.sink_mm", 0.5), HasSubstr("must be a key of one of the species' organs"));
  EXPECT_THAT(refused("head.fate.cone_deg", 0.5), HasSubstr("must be in a table that the species has, got none"));
  EXPECT_THAT(refused("", 0.5), HasSubstr("must be a number, which this key is not"));
  EXPECT_THAT(refused("head.active_ring.knots", 0.5), HasSubstr("is not; knots[0] is one"));
  EXPECT_THAT(refused("head.active_ring.knots[99]", 0.5), HasSubstr("must be that of one of"));
  EXPECT_THAT(refused("head.active_ring.knots[0", 0.5), HasSubstr("is not known"));
  EXPECT_THAT(refused("colonisation.window[0].x", 0.5), HasSubstr("is not known"));
  EXPECT_THAT(refused("vasculature.floret", 0.5), HasSubstr("must be a number, which this key is not"));
  EXPECT_THAT(refused("head.active_ring.sections[1].points", 0.5), HasSubstr("is not; points[0][0] is one"));
  EXPECT_THAT(refused("head.active_ring.sections[1].points[0]", 0.5), HasSubstr("is not; points[0][0] is one"));
  EXPECT_THAT(refused("head.active_ring.sections[1].points[0][2]", 0.5), HasSubstr("must end in [0] or [1]"));
  EXPECT_THAT(refused("head.active_ring.sections.points", 0.5), HasSubstr("must be that of one of"));
  const auto scaled = [&](std::string_view key, double factor) { return message(scale_number(species, key, factor)); };
  EXPECT_THAT(scaled("head.active_ring.threshold_mm", -1.0), HasSubstr("must be > 0"));
  EXPECT_THAT(scaled("head.active_ring.sections[1].points", -1.0), HasSubstr("must be"));  // radii would be negative
  EXPECT_THAT(scaled("ring_vertices", 0.501), HasSubstr("must be a whole number"));
  EXPECT_THAT(scaled("join", 2.0), HasSubstr("must be a number, which this key is not"));
  EXPECT_EQ(write_species(species), before);
}

}  // namespace
}  // namespace anthesis
