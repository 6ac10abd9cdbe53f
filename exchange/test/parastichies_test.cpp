#include "anthesis/exchange/parastichies.h"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {
namespace {

std::vector<PatternOrgan> disc(std::size_t count) {
  std::vector<Vec2> places(count);
  place_spiral({}, places);
  std::vector<PatternOrgan> organs;
  for (const Vec2 place : places) {
    organs.push_back({math::atan2(place.y, place.x), length(place), length(place), 0.0});
  }
  return organs;
}

std::vector<std::vector<std::string>> rows(const std::string& csv) {
  std::vector<std::vector<std::string>> result;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) {
      continue;
    }
    result.emplace_back(1);
    for (const char c : line) {
      if (c == ',') {
        result.back().emplace_back();
      } else {
        result.back().back() += c;
      }
    }
  }
  return result;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++found;
  }
  return found;
}

class ParastichyFiles : public testing::Test {
 protected:
  const std::vector<PatternOrgan> organs_ = disc(600);
  const Parastichies found_ = analyse_parastichies(organs_);
  const ParastichyFile file_ = {"Vogel & <disc>", "600 florets", 50.0, true};
};

TEST_F(ParastichyFiles, JsonListsTheFamiliesAlongTheSurface) {
  const nlohmann::json json = nlohmann::json::parse(parastichies_json(found_, file_));
  const nlohmann::json& regions = json["parastichies"];
  ASSERT_EQ(regions.size(), found_.regions.size());
  EXPECT_EQ(regions.back()["families"], (nlohmann::json{34, 55}));
  EXPECT_EQ(regions.back()["series"], "fibonacci");
  EXPECT_EQ(regions.back()["to"].get<double>(), found_.regions.back().to_mm / 50.0);
  for (std::size_t i = 1; i < regions.size(); ++i) {
    EXPECT_EQ(regions[i]["from"], regions[i - 1]["to"]);
  }
  EXPECT_EQ(json["transitions"].size() + 1, regions.size());
  EXPECT_NEAR(json["divergence"]["mean_deg"].get<double>(), 137.508, 1e-3);
}

TEST_F(ParastichyFiles, JsonNamesNoFamiliesWhereThereIsNoConsistentPair) {
  Parastichies found = found_;
  found.regions[0].kind.series = ParastichySeries::kIrregular;
  found.regions[0].divergence_rad = std::numeric_limits<double>::quiet_NaN();
  const nlohmann::json json = nlohmann::json::parse(parastichies_json(found, file_));
  EXPECT_TRUE(json["parastichies"][0]["families"].empty());
  EXPECT_TRUE(json["parastichies"][0]["divergence_deg"].is_null());
  EXPECT_EQ(json["parastichies"][0]["counted"][0]["number"], found_.regions[0].m.number);
}

TEST_F(ParastichyFiles, RegionTableHasARowForEachRegion) {
  const std::vector<std::vector<std::string>> table = rows(parastichy_regions_csv(found_, file_));
  ASSERT_EQ(table.size(), found_.regions.size() + 1);
  for (const std::vector<std::string>& row : table) {
    EXPECT_EQ(row.size(), table[0].size());
  }
  EXPECT_EQ(table.back()[5], "34");
  EXPECT_EQ(table.back()[6], "55");
  EXPECT_EQ(table.back()[10], "fibonacci");
}

TEST_F(ParastichyFiles, OrganTableHasARowForEachOrganAndEmptyFieldsForWhatIsNotKnown) {
  std::vector<PatternOrgan> organs = organs_;
  organs[3].radius_mm = std::numeric_limits<double>::quiet_NaN();
  const Parastichies found = analyse_parastichies(organs);
  const std::vector<std::vector<std::string>> table = rows(parastichy_organs_csv(found, organs, file_));
  ASSERT_EQ(table.size(), organs.size() + 1);
  for (const std::vector<std::string>& row : table) {
    EXPECT_EQ(row.size(), table[0].size());
  }
  EXPECT_EQ(table[4], (std::vector<std::string>{"4", table[4][1], table[4][2], "", "0", "", "", "0", "0", "", "", ""}));
  EXPECT_EQ(table.back()[0], "600");
  EXPECT_NEAR(std::stod(table.back()[6]), 137.508, 1e-3);
}

TEST_F(ParastichyFiles, DrawingsHaveEveryOrganBothTurnsAndTheNumbers) {
  for (const ParastichyView view : {ParastichyView::kPolar, ParastichyView::kUnrolled}) {
    const std::string svg = parastichies_svg(found_, organs_, view, file_);
    EXPECT_GE(count(svg, "<circle"), organs_.size());
    EXPECT_THAT(svg, testing::HasSubstr("stroke=\"#0072B2\""));
    EXPECT_THAT(svg, testing::HasSubstr("stroke=\"#D55E00\""));
    EXPECT_THAT(svg, testing::HasSubstr(">55</text>"));
    EXPECT_THAT(svg, testing::HasSubstr("Vogel &amp; &lt;disc&gt;</title>"));
    EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
    EXPECT_THAT(svg, testing::Not(testing::HasSubstr("nan")));
  }
}

TEST(ParastichyFilesOfNothing, AreStillFiles) {
  const Parastichies none = analyse_parastichies({});
  EXPECT_EQ(nlohmann::json::parse(parastichies_json(none, {}))["parastichies"].size(), 0u);
  EXPECT_EQ(rows(parastichy_regions_csv(none, {})).size(), 1u);
  EXPECT_EQ(rows(parastichy_organs_csv(none, {}, {})).size(), 1u);
  EXPECT_THAT(parastichies_svg(none, {}, ParastichyView::kPolar, {}), testing::EndsWith("</svg>\n"));
}

}  // namespace
}  // namespace anthesis
