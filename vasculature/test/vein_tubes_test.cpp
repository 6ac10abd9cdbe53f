#include "anthesis/vasculature/vein_tubes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

std::uint32_t add_vertex(Vasculature& veins, Vec3 position, std::uint32_t parent, double diameter,
                         VeinKind kind = VeinKind::kAbaxial) {
  VeinVertex vertex;
  vertex.position = position;
  vertex.parent = parent;
  vertex.diameter = diameter;
  vertex.kind = kind;
  veins.vertices.push_back(vertex);
  return static_cast<std::uint32_t>(veins.vertices.size() - 1);
}

/// One strand, from the ring outwards.
Vasculature strand(const std::vector<Vec3>& places, double diameter) {
  Vasculature veins;
  veins.ring_vertices = 1;
  std::uint32_t parent = kNoVertex;
  for (const Vec3 place : places) {
    parent = add_vertex(veins, place, parent, diameter);
  }
  return veins;
}

/// A stem of eight edges along z from the ring, and from its middle a strand in direction (1, 0, 1).
Vasculature fork(double stem_diameter, double side_diameter) {
  Vasculature veins;
  for (int i = 0; i <= 8; ++i) {
    add_vertex(veins, {0.0, 0.0, static_cast<double>(i)}, i == 0 ? kNoVertex : static_cast<std::uint32_t>(i - 1),
               stem_diameter);
  }
  std::uint32_t parent = 4;
  for (int i = 1; i <= 4; ++i) {
    parent = add_vertex(veins, {static_cast<double>(i), 0.0, 4.0 + i}, parent, side_diameter, VeinKind::kFloret);
  }
  veins.ring_vertices = 1;
  return veins;
}

VeinTubes tubes_of(const Vasculature& veins, const VeinTubeParams& params = {}) {
  Expected<VeinTubes> tubes = vein_tubes(veins, params);
  EXPECT_TRUE(tubes.has_value());
  return *tubes;
}

double volume(const Mesh& mesh, const std::vector<Triangle>& triangles) {
  double sum = 0.0;
  for (const Triangle& t : triangles) {
    sum += dot(mesh.positions_mm[t[0]], cross(mesh.positions_mm[t[1]], mesh.positions_mm[t[2]])) / 6.0;
  }
  return sum;
}

double polygon_area(double radius, int sides) {
  return 0.5 * sides * radius * radius * std::sin(math::kTurnRad / sides);
}

/// Triangles of each connected piece, by its least vertex.
std::map<std::uint32_t, std::vector<Triangle>> pieces_of(const Mesh& mesh) {
  std::vector<std::uint32_t> least(mesh.positions_mm.size());
  std::iota(least.begin(), least.end(), 0u);
  for (bool changed = true; changed;) {
    changed = false;
    for (const Triangle& t : mesh.triangles) {
      const std::uint32_t low = std::min({least[t[0]], least[t[1]], least[t[2]]});
      for (const std::uint32_t corner : t) {
        changed = changed || least[corner] != low;
        least[corner] = low;
      }
    }
  }
  std::map<std::uint32_t, std::vector<Triangle>> pieces;
  for (const Triangle& t : mesh.triangles) {
    pieces[least[t[0]]].push_back(t);
  }
  return pieces;
}

struct RingOfTube {
  Vec3 centre;
  Vec3 axis;
  double radius = 0.0;
  std::uint32_t vein = 0;
};

/// The rings of a single tube, those of the round tip left out: the tip's own is the first with `radius` about `tip`.
std::vector<RingOfTube> rings_of(const VeinTubes& tubes, Vec3 tip, int sides = 7) {
  const std::vector<Vec3>& p = tubes.mesh.positions_mm;
  std::vector<RingOfTube> rings;
  bool begun = false;
  for (std::size_t i = 1; i + 1 < p.size(); i += static_cast<std::size_t>(sides)) {
    RingOfTube ring;
    for (int j = 0; j < sides; ++j) {
      ring.centre += p[i + static_cast<std::size_t>(j)] / sides;
    }
    ring.radius = length(p[i] - ring.centre);
    ring.axis = normalized(cross(p[i] - ring.centre, p[i + 1] - ring.centre));
    ring.vein = tubes.vein[i];
    begun = begun || length(ring.centre - tip) < 1e-9;
    if (begun) {
      rings.push_back(ring);
    }
  }
  return rings;
}

double distance(Vec3 p, Vec3 a, Vec3 b) {
  const double along = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
  return length(p - lerp(a, b, along));
}

double distance(Vec3 p, const std::vector<Vec3>& line) {
  double least = 1e300;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    least = std::min(least, distance(p, line[i], line[i + 1]));
  }
  return least;
}

/// A line upwards that kinks by about 60 degrees at each of its vertices, which are 0.4 apart.
std::vector<Vec3> crumpled() {
  std::vector<Vec3> places;
  for (int i = 0; i < 60; ++i) {
    places.push_back({0.2 * ((i / 2) % 2), 0.2 * ((i + 1) / 2 % 2), 0.28 * i});
  }
  return places;
}

TEST(VeinTubes, AStraightStrandIsARodWithARoundTip) {
  for (const Vec3 tip : {Vec3{0.0, 0.0, 2.0}, Vec3{0.0, -2.0, 0.0}, Vec3{2.0, 0.0, 0.0}, Vec3{1.2, 0.0, -1.6}}) {
    for (const int sides : {3, 6, 8, 64}) {
      const VeinTubes tubes = tubes_of(strand({{}, tip}, 0.5), {.sides = sides});
      const double rod = 2.0 * polygon_area(0.25, sides);
      const double half_ball = 2.0 / 3.0 * math::kPi * 0.25 * 0.25 * 0.25;
      const double found = volume(tubes.mesh, tubes.mesh.triangles);
      EXPECT_GT(found, rod + 0.25 * half_ball) << sides;  // > 0: its faces look outwards
      EXPECT_LT(found, rod + half_ball) << sides;
      if (sides == 64) {
        EXPECT_NEAR(found, math::kPi * 0.25 * 0.25 * 2.0 + half_ball, 0.003 * found);
      }
    }
  }
}

TEST(VeinTubes, ATipIsHalfASphereWithTheNormalsOfASphere) {
  const Vec3 tip{0.6, 0.0, 0.8};
  const VeinTubes tubes = tubes_of(strand({{}, tip}, 0.5));
  std::set<double> heights;
  for (std::size_t i = 0; i < tubes.mesh.positions_mm.size(); ++i) {
    const Vec3 off = tubes.mesh.positions_mm[i] - tip;
    if (dot(off, tip) > -1e-9) {
      EXPECT_NEAR(length(off), 0.25, 1e-12);
      EXPECT_NEAR(length(off / 0.25 - tubes.mesh.normals[i]), 0.0, 1e-12);
      heights.insert(std::round(1e6 * dot(off, tip)));
    }
  }
  EXPECT_EQ(heights.size(), 4u);  // the equator, two rings, the pole
  EXPECT_EQ(*heights.rbegin(), 250000.0);
}

TEST(VeinTubes, EachTubeIsAClosedManifoldThatEnclosesSpace) {
  Vasculature veins = fork(0.4, 0.2);
  veins.second_connections = {{12, 8, 0, 0.1}};
  const VeinTubes tubes = tubes_of(veins);
  const auto pieces = pieces_of(tubes.mesh);
  EXPECT_EQ(pieces.size(), 3u);
  for (const auto& [least, triangles] : pieces) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::set<std::uint32_t> vertices;
    for (const Triangle& t : triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_TRUE(edges.insert({t[k], t[(k + 1) % 3]}).second);
        vertices.insert(t[k]);
      }
    }
    for (const auto& [from, to] : edges) {
      EXPECT_EQ(edges.count({to, from}), 1u);
    }
    EXPECT_EQ(vertices.size() + triangles.size() - edges.size() / 2, 2u);  // Euler's formula
    EXPECT_GT(volume(tubes.mesh, triangles), 0.0);
  }
}

TEST(VeinTubes, NormalsAreAcrossTheSurface) {
  std::vector<Vec3> places;
  for (int i = 0; i <= 40; ++i) {
    places.push_back({0.0, 0.0, 0.25 * i});
  }
  Vasculature veins = strand(places, 0.5);
  for (std::size_t i = 20; i <= 40; ++i) {
    veins.vertices[i].diameter = 1.0;  // a rod with a step, which is smoothed into a slope
  }
  const VeinTubes tubes = tubes_of(veins);
  double steepest = 0.0;
  std::vector<Vec3> flat(tubes.mesh.positions_mm.size());
  smooth_normals(tubes.mesh.positions_mm, tubes.mesh.triangles, {}, flat);
  for (std::size_t i = 0; i < flat.size(); ++i) {
    EXPECT_NEAR(length(tubes.mesh.normals[i]), 1.0, 1e-12);
    if (tubes.mesh.positions_mm[i].z > 0.0) {  // its flat end is shaded as if round
      EXPECT_GT(dot(flat[i], tubes.mesh.normals[i]), 0.99);
      steepest = tubes.mesh.positions_mm[i].z < 10.0 ? std::max(steepest, std::abs(tubes.mesh.normals[i].z)) : steepest;
    }
  }
  EXPECT_GT(steepest, 0.1);
}

TEST(VeinTubes, ASideStrandBeginsInsideTheThickerOne) {
  for (const double side_diameter : {0.1, 0.25, 0.39}) {
    for (const int sides : {3, 7}) {
      const VeinTubes tubes = tubes_of(fork(0.4, side_diameter), {.sides = sides});
      int hidden = 0;
      for (std::size_t i = 0; i < tubes.vein.size(); ++i) {
        if (tubes.vein[i] == 4 && tubes.kind[i] == VeinKind::kFloret) {
          ++hidden;
          // Its ring stands on the stem's middle, within the facets of the stem.
          EXPECT_LT(length(tubes.mesh.positions_mm[i] - Vec3{0.0, 0.0, 4.0}), 0.2 * std::cos(math::kPi / sides));
        }
      }
      EXPECT_EQ(hidden, sides + 1);
    }
  }
}

TEST(VeinTubes, AStrandThatWindsWithinTheThickerOneDoesNotStickOut) {
  Vasculature veins = fork(1.0, 0.2);
  std::uint32_t parent = 4;
  // From the stem's middle through its far side and back, then out.
  for (const Vec3 place : {Vec3{0, 0.3, 4}, Vec3{0, 0.6, 4}, Vec3{0.1, 0.3, 4}, Vec3{0.3, 0, 4}, Vec3{2, 0, 4}}) {
    parent = add_vertex(veins, place, parent, 0.2, VeinKind::kAdaxial);
  }
  const VeinTubes tubes = tubes_of(veins);
  for (std::size_t i = 0; i < tubes.vein.size(); ++i) {
    if (tubes.kind[i] == VeinKind::kAdaxial) {
      EXPECT_LT(std::abs(tubes.mesh.positions_mm[i].y), 0.2);
    }
  }
}

TEST(VeinTubes, SecondConnectionsBeginAndEndInsideWhatTheyJoin) {
  Vasculature veins = fork(0.4, 0.2);
  veins.second_connections = {{11, 7, 0, 5.0}};  // far thicker than what it joins
  const VeinTubes tubes = tubes_of(veins);
  const std::size_t count = tubes.vein.size();
  const std::size_t second = count - 2 * (7 + 1);  // the last tube: a ring and a middle at each end
  for (std::size_t i = second; i < count; ++i) {
    const bool at_start = i < second + 8;
    EXPECT_EQ(tubes.vein[i], at_start ? 11u : 7u);
    const Vec3 end = veins.vertices[tubes.vein[i]].position;
    EXPECT_LT(length(tubes.mesh.positions_mm[i] - end), (at_start ? 0.1 : 0.2) * std::cos(math::kPi / 7));
  }
}

TEST(VeinTubes, AJointFollowsTheRoundedStem) {
  Vasculature veins;
  std::uint32_t parent = kNoVertex;
  for (const Vec3 place : crumpled()) {
    parent = add_vertex(veins, place, parent, 2.0);
  }
  veins.ring_vertices = 1;
  parent = 31;
  for (int i = 1; i <= 5; ++i) {
    parent = add_vertex(veins, veins.vertices[31].position + Vec3{1.0 * i, 0.0, 0.0}, parent, 1.9, VeinKind::kFloret);
  }
  const VeinTubes tubes = tubes_of(veins);
  const Vec3 before = veins.vertices[31].position;
  Vec3 joint;
  for (std::size_t i = 0; i < tubes.vein.size(); ++i) {
    if (tubes.vein[i] == 31 && tubes.kind[i] == VeinKind::kFloret) {
      joint = tubes.mesh.positions_mm[i];  // the last is the middle of the end
    }
  }
  EXPECT_GT(length(joint - before), 0.1);
  EXPECT_NEAR(length(joint - Vec3{0.1, 0.1, joint.z}), 0.0, 0.02);  // the middle of the stem
}

TEST(VeinTubes, ACrumpledStrandBecomesASmoothTubeWithinTheOldOne) {
  const std::vector<Vec3> places = crumpled();
  const VeinTubes tubes = tubes_of(strand(places, 2.0));
  const std::vector<RingOfTube> rings = rings_of(tubes, places.back());
  ASSERT_GT(rings.size(), 3u);
  for (std::size_t i = 0; i < rings.size(); ++i) {
    EXPECT_NEAR(rings[i].radius, 1.0, 1e-9);
    EXPECT_LT(distance(rings[i].centre, places), 0.75);
    if (i > 0) {
      EXPECT_GT(dot(rings[i - 1].axis, rings[i].axis), std::cos(0.3)) << i;
    }
  }
  EXPECT_NEAR(length(rings.front().centre - places.back()), 0.0, 1e-12);
  EXPECT_NEAR(length(rings.back().centre - places.front()), 0.0, 1e-12);
}

TEST(VeinTubes, SharpBendsKeepTheirWidth) {
  const std::vector<std::vector<Vec3>> bends = {
      {{0, 0, 0}, {0, 0, 5}, {5, 0, 5}},      // square
      {{0, 0, 0}, {0, 0, 5}, {0.5, 0, 0.2}},  // nearly back
      {{0, 0, 0}, {0, 0, 5}, {0, 0, 1}},      // right back
      {{0, 0, 0}, {0, 0, 1}, {0, 0, 0.5}, {0, 0, 0.5}, {0, 0.5, 0.5}, {0, 0, 0.6}}};
  for (const std::vector<Vec3>& places : bends) {
    const VeinTubes tubes = tubes_of(strand(places, 1.0));
    const std::vector<RingOfTube> rings = rings_of(tubes, places.back());
    for (std::size_t i = 0; i < rings.size(); ++i) {
      EXPECT_NEAR(rings[i].radius, 0.5, 1e-9);
      EXPECT_LE(distance(rings[i].centre, places), 0.75 * 0.5);
      if (i > 0) {  // a ring for each step of the turn
        EXPECT_GT(dot(rings[i - 1].axis, rings[i].axis), std::cos(0.81)) << i;
      }
    }
  }
}

TEST(VeinTubes, TubesDoNotTurnAboutThemselves) {
  for (const std::vector<Vec3>& places :
       {crumpled(), std::vector<Vec3>{{0, 0, 0}, {0, 0, 5}, {5, 0, 5}, {5, 5, 5}, {5, 5, 0}, {5, 5.5, 3}}}) {
    const VeinTubes tubes = tubes_of(strand(places, 1.0));
    const std::vector<RingOfTube> rings = rings_of(tubes, places.back());
    const std::size_t first = tubes.mesh.positions_mm.size() - 1 - 7 * rings.size();
    for (std::size_t i = 1; i < rings.size(); ++i) {
      const std::size_t at = first + 7 * i;
      const Vec3 before = (tubes.mesh.positions_mm[at - 7] - rings[i - 1].centre) / rings[i - 1].radius;
      const Vec3 after = (tubes.mesh.positions_mm[at] - rings[i].centre) / rings[i].radius;
      EXPECT_GT(dot(before, after), dot(rings[i - 1].axis, rings[i].axis) - 1e-9) << i;  // by no more than the bend
    }
  }
}

TEST(VeinTubes, RadiiPassFromOneEdgesToTheNext) {
  std::vector<Vec3> places;
  for (int i = 0; i < 60; ++i) {
    places.push_back({0.0, 0.0, static_cast<double>(i)});
  }
  Vasculature veins = strand(places, 0.4);
  for (std::size_t i = 30; i < 60; ++i) {
    veins.vertices[i].diameter = 0.2;
  }
  const std::vector<RingOfTube> rings = rings_of(tubes_of(veins), places.back());
  EXPECT_NEAR(rings.front().radius, 0.1, 1e-12);
  EXPECT_NEAR(rings.back().radius, 0.2, 1e-12);
  for (std::size_t i = 1; i < rings.size(); ++i) {
    const double wider = rings[i].radius - rings[i - 1].radius;
    EXPECT_GE(wider, -1e-12);
    EXPECT_LE(wider, 0.1 / 4.0);
  }
}

TEST(VeinTubes, StraightStrandsHaveNoMoreRingsThanTheyNeed) {
  std::vector<Vec3> places;
  for (int i = 0; i <= 1000; ++i) {
    places.push_back({0.0, 0.0, 0.01 * i});
  }
  const std::vector<RingOfTube> rings = rings_of(tubes_of(strand(places, 0.2)), places.back());
  EXPECT_LT(rings.size(), 60u);
  for (std::size_t i = 0; i < rings.size(); ++i) {
    EXPECT_NEAR(rings[i].centre.z, 0.01 * rings[i].vein, 1e-9);  // the vertex that it names
    if (i > 0) {
      EXPECT_LE(rings[i - 1].centre.z - rings[i].centre.z, 4.0 * 0.1 + 1e-9);
    }
  }
}

TEST(VeinTubes, BentStrandsHaveARingForEachFewDegrees) {
  std::vector<Vec3> places;
  for (int i = 0; i <= 200; ++i) {
    const double angle = 0.02 * i;
    places.push_back({1.5 * std::cos(angle), 1.5 * std::sin(angle), 0.0});
  }
  const std::vector<RingOfTube> rings = rings_of(tubes_of(strand(places, 2.0)), places.back());
  for (std::size_t i = 1; i < rings.size(); ++i) {
    EXPECT_GT(dot(rings[i - 1].axis, rings[i].axis), std::cos(0.29)) << i;
  }
  EXPECT_LT(rings.size(), 40u);
}

TEST(VeinTubes, TheFirstCornerTellsTheKindOfATriangle) {
  std::vector<Vec3> places;
  for (int i = 0; i <= 100; ++i) {
    places.push_back({0.0, 0.0, 0.1 * i});
  }
  Vasculature veins = strand(places, 0.2);
  for (std::size_t i = 61; i <= 100; ++i) {
    veins.vertices[i].kind = VeinKind::kFloret;  // edges from z = 6 upwards
  }
  const VeinTubes tubes = tubes_of(veins);
  std::set<VeinKind> kinds;
  for (const Triangle& t : tubes.mesh.triangles) {
    const double middle =
        (tubes.mesh.positions_mm[t[0]].z + tubes.mesh.positions_mm[t[1]].z + tubes.mesh.positions_mm[t[2]].z) / 3.0;
    EXPECT_EQ(tubes.kind[t[0]], middle > 6.0 ? VeinKind::kFloret : VeinKind::kAbaxial) << middle;
    kinds.insert(tubes.kind[t[0]]);
  }
  EXPECT_EQ(kinds.size(), 2u);
}

TEST(VeinTubes, WhatIsNotConnectedHasNone) {
  Vasculature veins = strand({{}}, 0.2);
  add_vertex(veins, {1.0, 0.0, 0.0}, kNoVertex, 0.2);
  EXPECT_TRUE(tubes_of(veins).mesh.triangles.empty());
}

TEST(VeinTubes, AStrandWithAnEdgeOfNoWidthHasNone) {
  Vasculature veins = fork(0.4, 0.2);
  const std::size_t both = pieces_of(tubes_of(veins).mesh).size();
  veins.vertices[10].diameter = 0.0;  // in the middle of the side strand
  veins.second_connections = {{12, 8, 0, 0.0}};
  EXPECT_EQ(both, 2u);
  EXPECT_EQ(pieces_of(tubes_of(veins).mesh).size(), 1u);
}

TEST(VeinTubes, RefusesTubesThatAreNone) {
  const Vasculature veins = strand({{}, {0.0, 0.0, 1.0}}, 0.2);
  EXPECT_EQ(to_string(vein_tubes(veins, {.sides = 2}).error()), "sides must be between 3 and 64, got 2");
  EXPECT_EQ(to_string(vein_tubes(veins, {.radius_factor = 0.0}).error()),
            "radius_factor must be > 0 and at most 1e6, got 0");
}

}  // namespace
}  // namespace anthesis
