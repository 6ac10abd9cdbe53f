#include "anthesis/exchange/vein_files.h"

#include <gmock/gmock.h>

#include <array>
#include <charconv>
#include <cmath>
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

/// Two vertices: one straight strand.
Vasculature stick(Vec3 tip, double diameter) {
  Vasculature veins;
  veins.vertices.resize(2);
  veins.vertices[1].position = tip;
  veins.vertices[1].parent = 0;
  veins.vertices[1].diameter = diameter;
  veins.ring_vertices = 1;
  veins.primordia = {1};
  return veins;
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

struct Solid {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;

  double volume() const {
    double sum = 0.0;
    for (const Triangle& t : triangles) {
      sum += dot(positions[t[0]], cross(positions[t[1]], positions[t[2]])) / 6.0;
    }
    return sum;
  }
};

Solid solid_of(const Vasculature& veins, const VeinTubeParams& params = {}) {
  const Expected<std::string> bytes = veins_ply(veins, params);
  EXPECT_TRUE(bytes.has_value());
  const Expected<CheckedMesh> mesh = read_mesh(*bytes, "veins.ply");
  EXPECT_TRUE(mesh.has_value()) << to_string(mesh.error());
  return {mesh->pose(0).positions, {mesh->triangles().begin(), mesh->triangles().end()}};
}

TEST(VeinsCsv, HasARowForEachVertexAndNothingWhereThereIsNothing) {
  EXPECT_THAT(lines_of(veins_csv(letter())),
              ElementsAre("vertex,parent,second_parents,kind,primordium,age_frames,diameter,resistance,x,y,z",
                          "0,,,abaxial,,0,0.3,0,0,0,0", "1,,,abaxial,,0,0,5,5,0,0",
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
  ASSERT_EQ(rows.size(), veins.vertices.size());
  std::map<double, std::vector<double>> by_x;  // all x differ but for the stem's
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<double> row = numbers_of(rows[i]);
    ASSERT_EQ(row.size(), 7u) << rows[i];
    EXPECT_EQ(row[0], static_cast<double>(i + 1));
    EXPECT_LT(row[6], row[0]);
    by_x[row[2]] = row;
  }
  EXPECT_EQ(by_x[2.0][6], by_x[-2.0][6]);
  EXPECT_EQ(numbers_of(rows[static_cast<std::size_t>(by_x[2.0][6]) - 1])[4], 1.0);  // the joint
  EXPECT_EQ(by_x[5.0][6], -1.0);
  EXPECT_EQ(by_x[9.0][6], -1.0);
  EXPECT_EQ(by_x[2.0][5], 0.1);   // radius
  EXPECT_EQ(by_x[5.0][1], 1.0);   // ring
  EXPECT_EQ(by_x[2.0][1], 2.0);   // abaxial
  EXPECT_EQ(by_x[-2.0][1], 3.0);  // floret
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

TEST(VeinsPly, AStraightStrandIsAPrism) {
  for (const Vec3 tip : {Vec3{0.0, 0.0, 2.0}, Vec3{0.0, -2.0, 0.0}, Vec3{2.0, 0.0, 0.0}, Vec3{1.2, 0.0, -1.6}}) {
    for (const int sides : {3, 6, 8}) {
      const Solid prism = solid_of(stick(tip, 0.5), {.sides = sides});
      EXPECT_EQ(prism.positions.size(), static_cast<std::size_t>(2 * sides + 2));
      const double area = 0.5 * sides * 0.25 * 0.25 * std::sin(math::kTurnRad / sides);
      EXPECT_NEAR(prism.volume(), 2.0 * area, 1e-6) << sides;  // > 0: its faces look outwards
    }
  }
}

TEST(VeinsPly, TubesAreClosed) {
  const Solid solid = solid_of(letter());
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : solid.triangles) {
    for (int k = 0; k < 3; ++k) {
      ++edges[{t[k], t[(k + 1) % 3]}];
    }
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  // Two strands, of which the thin one ends in the joint, and two second connections; Euler's formula.
  EXPECT_EQ(solid.positions.size(), (3u + 2u + 2u + 2u) * 7u + 4u * 2u);
  EXPECT_EQ(solid.positions.size() + solid.triangles.size() - edges.size() / 2, 2u * 4u);
}

TEST(VeinsPly, RadiiPassFromOneEdgesToTheNext) {
  Vasculature veins = stick({0.0, 0.0, 1.0}, 0.4);
  for (std::uint32_t i = 2; i < 40; ++i) {
    VeinVertex vertex;
    vertex.position = {0.0, 0.0, static_cast<double>(i)};
    vertex.parent = i - 1;
    vertex.diameter = i < 20 ? 0.4 : 0.2;
    veins.vertices.push_back(vertex);
  }
  double before = 0.0;
  std::map<double, double> radius;
  for (const Vec3 p : solid_of(veins).positions) {
    radius[p.z] = std::max(radius[p.z], std::hypot(p.x, p.y));
  }
  EXPECT_NEAR(radius.rbegin()->second, 0.1, 1e-7);
  EXPECT_NEAR(radius.begin()->second, 0.2, 1e-7);
  for (auto point = radius.rbegin(); point != radius.rend(); ++point) {
    EXPECT_GE(point->second, before - 1e-7);
    EXPECT_LE(point->second - before, before == 0.0 ? 1.0 : 0.1 / 4.0) << point->first;
    before = point->second;
  }
}

TEST(VeinsPly, AStrandThatTurnsBackKeepsItsWidth) {
  Vasculature veins = stick({0.0, 0.0, 1.0}, 0.1);
  VeinVertex vertex;
  vertex.diameter = 0.1;
  for (const Vec3 position : {Vec3{0.0, 0.0, 0.5}, Vec3{0.0, 0.0, 0.5}, Vec3{0.0, 0.5, 0.5}, Vec3{0.0, 0.0, 0.6}}) {
    vertex.position = position;
    vertex.parent = static_cast<std::uint32_t>(veins.vertices.size() - 1);
    veins.vertices.push_back(vertex);
  }
  const Solid solid = solid_of(veins);
  EXPECT_EQ(solid.positions.size(), 5u * 7u + 2u);  // the doubled point counts once
  const std::array<std::uint32_t, 5> ways = {5, 4, 3, 1, 0};
  for (std::size_t i = 0; i < 5 * 7; ++i) {
    EXPECT_NEAR(length(solid.positions[1 + i] - veins.vertices[ways[i / 7]].position), 0.05, 1e-6) << i;
  }
}

TEST(VeinsPly, RefusesTubesThatAreNone) {
  EXPECT_EQ(to_string(veins_ply(letter(), {.sides = 2}).error()), "sides must be between 3 and 64, got 2");
  EXPECT_EQ(to_string(veins_ply(letter(), {.radius_factor = 0.0}).error()),
            "radius_factor must be > 0 and at most 1e6, got 0");
}

}  // namespace
}  // namespace anthesis
