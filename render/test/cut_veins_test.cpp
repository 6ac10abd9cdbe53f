#include "../src/cut_veins.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace anthesis {
namespace {

constexpr double kRadius = 0.5;
const CutPlane kPlane = {{0, 0, 1}, 2.0};

/// A strand along points, its root first.
void add_strand(Vasculature& veins, std::initializer_list<Vec3> points, std::uint32_t parent = kNoVertex) {
  for (const Vec3 p : points) {
    VeinVertex vertex;
    vertex.position = p;
    vertex.parent = parent;
    vertex.diameter = parent == kNoVertex ? 0.0 : 2.0 * kRadius;
    parent = static_cast<std::uint32_t>(veins.vertices.size());
    veins.vertices.push_back(vertex);
  }
}

Vasculature strand(std::initializer_list<Vec3> points) {
  Vasculature veins;
  add_strand(veins, points);
  return veins;
}

std::vector<Vec3> places(const Vasculature& veins) {
  std::vector<Vec3> places;
  for (const VeinVertex& vertex : veins.vertices) {
    places.push_back(vertex.position);
  }
  return places;
}

/// Edges from one vertex to the next.
double strand_length(const Vasculature& veins) {
  double sum = 0.0;
  for (const VeinVertex& vertex : veins.vertices) {
    sum += vertex.parent == kNoVertex ? 0.0 : length(vertex.position - veins.vertices[vertex.parent].position);
  }
  return sum;
}

TEST(CutVeins, AStrandAcrossThePlaneEndsInItWithAVertex) {
  const Vasculature up = cut(strand({{0, 0, -4}, {0, 0, 0}, {2, 0, 4}, {2, 0, 8}}), kPlane);
  ASSERT_EQ(up.vertices.size(), 3U);
  EXPECT_EQ(up.vertices.back().position, Vec3(1, 0, 2));
  EXPECT_EQ(up.vertices.back().parent, 1U);
  EXPECT_DOUBLE_EQ(up.vertices.back().diameter, 2.0 * kRadius);
  // The root's side is gone: the new vertex is the root.
  const Vasculature down = cut(strand({{2, 0, 8}, {2, 0, 4}, {0, 0, 0}, {0, 0, -4}}), kPlane);
  ASSERT_EQ(down.vertices.size(), 3U);
  EXPECT_EQ(down.vertices.back().position, Vec3(1, 0, 2));
  EXPECT_EQ(down.vertices[0].parent, 2U);
  EXPECT_EQ(down.vertices[2].parent, kNoVertex);
}

TEST(CutVeins, ThePartsOnBothSidesAreAsLongAsTheStrand) {
  const Vasculature veins = strand({{0, 0, -9}, {1, 0, 0}, {2, 1, 8}, {3, 0, 9}, {4, 0, 0}, {3, 1, -6}, {5, 5, 9}});
  const double below = strand_length(cut(veins, kPlane));
  const double above = strand_length(cut(veins, {-kPlane.normal, -kPlane.distance}));
  EXPECT_NEAR(below + above, strand_length(veins), 1e-12);
}

TEST(CutVeins, AStrandThatWindsAlongThePlaneIsWholeAndLiesInIt) {
  const Vasculature veins = strand({{0, 0, 1.7}, {1, 0, 2.2}, {2, 0, 1.9}, {3, 0, 2.4}, {4, 0, 1.8}, {5, 0, 2.3}});
  const Vasculature kept = cut(veins, kPlane);
  ASSERT_EQ(kept.vertices.size(), veins.vertices.size());
  for (std::size_t i = 0; i < veins.vertices.size(); ++i) {
    EXPECT_EQ(kept.vertices[i].parent, veins.vertices[i].parent);
    const Vec3 p = veins.vertices[i].position;
    EXPECT_EQ(kept.vertices[i].position, Vec3(p.x, p.y, std::min(p.z, 2.0)));
  }
}

TEST(CutVeins, AStrandThatOnlyTouchesThePlaneIsAbsent) {
  EXPECT_TRUE(cut(strand({{0, 0, 5}, {9, 0, 3}, {18, 0, 1.6}, {27, 0, 1.8}, {36, 0, 5}}), kPlane).vertices.empty());
  EXPECT_TRUE(cut(strand({{0, 0, 5}, {9, 0, 2.2}, {18, 0, 2.3}, {27, 0, 2.4}}), kPlane).vertices.empty());
  EXPECT_EQ(cut(strand({{0, 0, 5}, {9, 0, 3}, {18, 0, 1.4}, {27, 0, 1.8}, {36, 0, 5}}), kPlane).vertices.size(), 4U);
}

TEST(CutVeins, AShortPieceIsAbsentUnlessItIsAWholeStrand) {
  EXPECT_TRUE(cut(strand({{0, 0, 5}, {0, 0, 0}, {2, 0, 0}, {2, 0, 5}}), {{0, 0, 1}, 1.9}).vertices.empty());
  EXPECT_FALSE(cut(strand({{0, 0, 5}, {0, 0, 0}, {2.3, 0, 0}, {2.3, 0, 5}}), {{0, 0, 1}, 1.9}).vertices.empty());
  EXPECT_EQ(cut(strand({{0, 0, 0}, {1, 0, 0}}), kPlane).vertices.size(), 2U);
}

TEST(CutVeins, ABranchGoesWithItsStrandUpToThePlane) {
  Vasculature veins = strand({{0, 0, 0}, {4, 0, 0}, {8, 0, 0}});
  add_strand(veins, {{4, 0, 1.9}, {5, 0, 2.3}, {6, 0, 2.9}, {7, 0, 5}}, 1);
  veins.second_connections = {{2, 1, 0, 1.0}, {2, 6, 0, 1.0}};
  const Vasculature kept = cut(veins, kPlane);
  ASSERT_EQ(kept.vertices.size(), 5U);
  EXPECT_NEAR(length(kept.vertices[4].position - Vec3{4.25, 0, 2}), 0.0, 1e-12);
  ASSERT_EQ(kept.second_connections.size(), 1U);  // the other leads to what is gone
  EXPECT_EQ(kept.second_connections[0].from, 2U);
}

TEST(CutVeins, WhatIsOnOneSideStaysAsItIs) {
  const Vasculature veins = strand({{0, 0, 0}, {1, 0, 1}, {2, 3, 0}});
  EXPECT_EQ(places(cut(veins, kPlane)), places(veins));
  EXPECT_TRUE(cut(veins, {{0, 0, -1}, -2.0}).vertices.empty());
  EXPECT_TRUE(cut(Vasculature{}, kPlane).vertices.empty());
}

}  // namespace
}  // namespace anthesis
