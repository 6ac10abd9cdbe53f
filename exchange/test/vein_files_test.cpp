#include "anthesis/exchange/vein_files.h"

#include <gmock/gmock.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "anthesis/base/math.h"
#include "anthesis/exchange/mesh_file.h"

namespace anthesis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A letter Y with a stroke: from the ring at (0, 0, 0) up to a joint, a thick arm and a thin one, the thin one's tip
/// joined to the thick one's. Beside it a ring vertex without strands, and a strand that is not connected.
Vasculature letter() {
  Vasculature veins;
  const auto add = [&](Vec3 position, std::uint32_t parent, double diameter, std::uint32_t primordium) {
    VeinVertex vertex;
    vertex.position = position;
    vertex.parent = parent;
    vertex.diameter = diameter;
    vertex.primordium = primordium;
    vertex.kind = primordium == 8 ? VeinKind::kFloret : VeinKind::kAbaxial;
    vertex.resistance = length(position);
    veins.vertices.push_back(vertex);
  };
  add({0.0, 0.0, 0.0}, kNoVertex, 0.3, kNoPrimordium);
  add({5.0, 0.0, 0.0}, kNoVertex, 0.0, kNoPrimordium);
  add({2.0, 0.0, 2.0}, 3, 0.2, 7);  // tips come before what they hang on, as halved edges make it
  add({0.0, 0.0, 1.0}, 0, 0.3, 7);
  add({-2.0, 0.0, 2.0}, 3, 0.1, 8);
  add({9.0, 0.0, 3.0}, kNoVertex, 0.1, 9);
  veins.vertices[5].resistance = std::numeric_limits<double>::infinity();
  veins.ring_vertices = 2;
  veins.primordia = {2, 4, 5, kNoVertex};
  veins.second_connections = {{4, 2, 8, 0.05}, {4, 3, 8, 0.05}};
  return veins;
}

std::vector<VeinPrimordium> primordia() {
  return {{7, 0, 0.9, 0.0, PrimordiumKind::kBract},
          {8, 5, 0.5, math::kPi, PrimordiumKind::kTransFloret},
          {9, 6, 0.25, 0.0, PrimordiumKind::kFloret},
          {10, 99, 0.125, 0.0, PrimordiumKind::kFloret}};
}

std::vector<std::string> lines_of(const std::string& text, bool comments = false) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    if ((text[at] == '#') == comments) {
      lines.push_back(text.substr(at, end - at));
    }
    at = end + 1;
  }
  return lines;
}

std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> numbers;
  for (const char* at = line.data(); at < line.data() + line.size();) {
    at = std::from_chars(at, line.data() + line.size(), numbers.emplace_back()).ptr + 1;
  }
  return numbers;
}

TEST(VeinsCsv, HasARowForEachVertexAndNothingWhereThereIsNothing) {
  EXPECT_THAT(lines_of(veins_csv(letter())),
              ElementsAre("vertex,parent,second_parents,kind,primordium,age_frames,diameter,resistance,x,y,z",
                          "0,,,ring,,0,0.3,0,0,0,0", "1,,,ring,,0,0,5,5,0,0",
                          "2,3,,abaxial,7,0,0.2,2.8284271247461903,2,0,2", "3,0,,abaxial,7,0,0.3,1,0,0,1",
                          "4,3,2 3,floret,8,0,0.1,2.8284271247461903,-2,0,2", "5,,,abaxial,9,0,0.1,,9,0,3"));
}

TEST(VeinsCsv, SaysWhatItWasMadeFromOnLinesOfItsOwn) {
  const std::vector<std::string> comments = lines_of(veins_csv(letter(), {{"head", "a\nb"}, {"seed", "3"}}), true);
  ASSERT_EQ(comments.size(), 3u);
  EXPECT_THAT(comments[0], HasSubstr("# generator: Anthesis "));
  EXPECT_EQ(comments[1], "# head: a b");
  EXPECT_EQ(comments[2], "# seed: 3");
}

TEST(VeinPrimordiaCsv, HasPlacesAtBirthAndAtTheEnd) {
  EXPECT_THAT(
      lines_of(vein_primordia_csv(letter(), primordia())),
      ElementsAre("primordium,kind,birth_frame,s,azimuth_deg,vertex,x,y,z", "7,bract,0,0.9,0,2,2,0,2",
                  "8,trans_floret,5,0.5,180,4,-2,0,2", "9,floret,6,0.25,0,5,9,0,3", "10,floret,99,0.125,0,,,,"));
}

TEST(VeinMeasuresCsv, StatesTheMeasuresOfEachWay) {
  const VasculatureMeasures measures = measure(letter());
  const std::string text = vein_measures_csv(measures, primordia());
  const std::vector<std::string> rows = lines_of(text);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0], "primordium,kind,connected,own_length,length_to_ring,order,bundle,turned_deg,sectors_crossed");
  EXPECT_THAT(rows[1], HasSubstr("7,bract,1,"));
  EXPECT_THAT(rows[1], HasSubstr(to_text(1.0 + std::sqrt(5.0))));
  EXPECT_EQ(rows[3], "9,floret,0,,,,,,");
  EXPECT_EQ(rows[4], "10,floret,0,,,,,,");
  EXPECT_THAT(text, HasSubstr("# loops: 2\n"));
  EXPECT_THAT(text, HasSubstr("# bundles: 1\n"));
}

TEST(VeinsSwc, IsTheSameForestWithParentsFirst) {
  const Vasculature veins = letter();
  const std::vector<std::string> rows = lines_of(veins_swc(veins));
  ASSERT_EQ(rows.size(), veins.vertices.size() - 1);  // nothing grows from one of the ring
  std::map<double, std::vector<double>> by_x;         // all x differ but for the stem's
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<double> row = numbers_of(rows[i]);
    ASSERT_EQ(row.size(), 7u) << rows[i];
    EXPECT_EQ(row[0], static_cast<double>(i + 1));
    EXPECT_LT(row[6], row[0]);
    by_x[row[2]] = row;
  }
  EXPECT_EQ(by_x[2.0][6], by_x[-2.0][6]);
  EXPECT_EQ(numbers_of(rows[static_cast<std::size_t>(by_x[2.0][6]) - 1])[4], 1.0);  // the joint
  EXPECT_EQ(by_x.count(5.0), 0u);
  EXPECT_EQ(by_x[9.0][6], -1.0);
  EXPECT_EQ(by_x[2.0][5], 0.1);            // radius
  EXPECT_EQ(numbers_of(rows[0])[1], 1.0);  // ring
  EXPECT_EQ(by_x[2.0][1], 2.0);            // abaxial
  EXPECT_EQ(by_x[-2.0][1], 3.0);           // floret
}

TEST(VeinsSwc, PutsEachStrandInOnePiece) {
  const std::vector<std::string> rows = lines_of(veins_swc(letter()));
  EXPECT_EQ(numbers_of(rows[1])[6], 1.0);  // ring, joint, thick arm, thin arm
  EXPECT_EQ(numbers_of(rows[2])[5], 0.1);
  EXPECT_EQ(numbers_of(rows[3])[5], 0.05);
}

TEST(VeinsSwc, ListsSecondConnectionsByItsOwnIds) {
  EXPECT_THAT(veins_swc(letter()), HasSubstr("# second connection: 4 3\n# second connection: 4 2\n"));
}

TEST(VeinsPly, HoldsTheTubesWithTheColourOfTheirKind) {
  const Expected<std::string> bytes = veins_ply(letter());
  const Expected<VeinTubes> tubes = vein_tubes(letter());
  ASSERT_TRUE(bytes.has_value() && tubes.has_value());
  const Expected<CheckedMesh> mesh = read_mesh(*bytes, "veins.ply");
  ASSERT_TRUE(mesh.has_value()) << to_string(mesh.error());
  const std::vector<Vec3> positions = mesh->pose(0).positions;
  ASSERT_EQ(positions.size(), tubes->mesh.positions_mm.size());
  ASSERT_EQ(mesh->triangles().size(), tubes->mesh.triangles.size());
  EXPECT_TRUE(std::equal(mesh->triangles().begin(), mesh->triangles().end(), tubes->mesh.triangles.begin()));
  const std::string_view header = "end_header\n";
  const char* row = bytes->data() + bytes->find(header) + header.size();
  for (std::size_t i = 0; i < positions.size(); ++i, row += 32) {
    EXPECT_LT(length(positions[i] - tubes->mesh.positions_mm[i]), 1e-6);
    float up = 0.0f;
    std::uint32_t vein = 0;
    std::memcpy(&up, row + 20, 4);
    std::memcpy(&vein, row + 27, 4);
    EXPECT_EQ(up, static_cast<float>(tubes->mesh.normals[i].z));
    const std::array<std::uint8_t, 3> colour = vein_colour(tubes->kind[i]);
    EXPECT_EQ(std::memcmp(row + 24, colour.data(), 3), 0);
    EXPECT_EQ(vein, tubes->vein[i]);
    EXPECT_EQ(row[31], static_cast<char>(tubes->kind[i]));
  }
}

TEST(VeinsPly, RefusesTubesThatAreNone) {
  EXPECT_EQ(to_string(veins_ply(letter(), {.sides = 2}).error()), "sides must be between 3 and 64, got 2");
  EXPECT_EQ(to_string(veins_ply(letter(), {.radius_factor = 0.0}).error()),
            "radius_factor must be > 0 and at most 1e6, got 0");
}

}  // namespace
}  // namespace anthesis
