#include "anthesis/exchange/csv.h"

#include <gmock/gmock.h>

#include <charconv>
#include <sstream>

#include "anthesis/base/math.h"
#include "tiny_species.h"

namespace anthesis {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::stringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) {
    fields.push_back(field);
  }
  return fields;
}

double number(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  EXPECT_TRUE(error == std::errc() && end == text.data() + text.size()) << text;
  return value;
}

TEST(OrgansCsv, ReadsBackAsTheSameNumbers) {
  const Development development = test::grow_tiny();
  const double time = 0.8;
  const Expected<std::string> text = organs_csv(development, time);
  ASSERT_TRUE(text.has_value());
  std::stringstream stream(*text);
  std::string line;
  std::string comments;
  while (std::getline(stream, line) && line.starts_with("#")) {
    comments += line + "\n";
  }
  EXPECT_THAT(comments, testing::HasSubstr("# seed: 7\n"));
  EXPECT_THAT(comments, testing::HasSubstr("# species_sha256: aaaa"));
  EXPECT_EQ(line,
            "id,parent,kind,birth,age,x_mm,y_mm,z_mm,nx,ny,nz,divergence_deg,azimuth_deg,s,radius_mm,area_mm2,size,"
            "stage");
  const Canopy canopy = development.at(time);
  for (const OrganState& state : canopy.organs) {
    ASSERT_TRUE(std::getline(stream, line));
    const std::vector<std::string> fields = split(line);
    ASSERT_EQ(fields.size(), 18u);
    const Organ& organ = development.organs()[state.id.value - 1];
    EXPECT_EQ(number(fields[0]), state.id.value);
    EXPECT_EQ(fields[2], development.species().organs[organ.kind].name);
    EXPECT_EQ(number(fields[3]), organ.birth);
    EXPECT_EQ(number(fields[4]), time - organ.birth);
    EXPECT_EQ(number(fields[5]), state.world_from_organ.position_mm.x);
    EXPECT_EQ(number(fields[10]), state.normal.z);
    EXPECT_EQ(number(fields[12]), math::degrees(organ.azimuth_rad));
    EXPECT_EQ(number(fields[16]), state.world_from_organ.scale);
    EXPECT_EQ(number(fields[17]), state.stage);
  }
  EXPECT_FALSE(std::getline(stream, line));
}

TEST(OrgansCsv, RefusesTimesOutsideTheDevelopment) {
  const Development development = test::grow_tiny();
  EXPECT_EQ(organs_csv(development, -0.1).error().where, "time");
  EXPECT_EQ(organs_csv(development, std::nan("")).error().where, "time");
}

}  // namespace
}  // namespace anthesis
