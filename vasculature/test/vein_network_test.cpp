#include "vein_network.h"

#include <gtest/gtest.h>

#include <cmath>

namespace anthesis::veins {
namespace {

std::uint32_t add(VeinNetwork& network, Vec3 position, std::uint32_t parent, VeinKind kind = VeinKind::kAbaxial) {
  NewVertex vertex;
  vertex.position = position;
  vertex.parent = parent;
  vertex.kind = kind;
  return network.add(vertex);
}

/// Ring vertices 0 and 1; a strand up from 0 that forks into three tips of two kinds.
VeinNetwork fork() {
  VeinNetwork network;
  add(network, {0, 0, 0}, kNoVertex);
  add(network, {4, 0, 0}, kNoVertex);
  add(network, {0, 0, 1}, 0);                       // 2
  add(network, {1, 0, 2}, 2, VeinKind::kFloret);    // 3
  add(network, {-1, 0, 2}, 2, VeinKind::kAbaxial);  // 4
  add(network, {0, 0, 2}, 2, VeinKind::kAbaxial);   // 5
  add(network, {4, 0, 1}, 1);                       // 6, a strand of its own
  network.sort();
  return network;
}

TEST(VeinNetwork, SortsParentsBeforeChildren) {
  VeinNetwork network = fork();
  network.split(0.5);  // the new vertices have larger indices than their children
  network.sort();
  std::vector<std::size_t> place(network.size());
  for (std::size_t i = 0; i < network.order.size(); ++i) {
    place[network.order[i]] = i;
  }
  ASSERT_EQ(network.order.size(), network.size());
  for (std::uint32_t v = 0; v < network.size(); ++v) {
    if (network.parent[v] != kNoVertex) {
      EXPECT_LT(place[network.parent[v]], place[v]);
    }
  }
}

TEST(VeinNetwork, HalvesLongEdgesOnceAndKeepsTheirLength) {
  VeinNetwork network = fork();
  network.split(1.2);  // the two slanting edges, sqrt(2) long
  ASSERT_EQ(network.size(), 9u);
  EXPECT_EQ(network.parent[3], 7u);
  EXPECT_EQ(network.parent[7], 2u);
  EXPECT_EQ(network.kind[7], VeinKind::kFloret);
  EXPECT_EQ(network.position[7], (Vec3{0.5, 0.0, 1.5}));
}

TEST(VeinNetwork, AddsUpResistanceFromTheRingByAge) {
  VeinNetwork network = fork();
  network.age = {100, 100, 100, 50, 0, 100, 100};
  network.update_resistance(2, 6.0, 100, 1.0);
  EXPECT_DOUBLE_EQ(network.resistance[2], 1.0);                         // mature
  EXPECT_DOUBLE_EQ(network.resistance[3], 1.0 + 3.5 * std::sqrt(2.0));  // half way from 6 to 1
  EXPECT_DOUBLE_EQ(network.resistance[4], 1.0 + 6.0 * std::sqrt(2.0));  // fresh: like ground
  network.update_resistance(2, 6.0, 0, 1.0);
  EXPECT_DOUBLE_EQ(network.resistance[4], 1.0 + std::sqrt(2.0));  // mature at once
}

TEST(VeinNetwork, WhatCarriesAnAdaxialStrandIsAdaxialUnlessABractsStrand) {
  VeinNetwork network = fork();
  network.kind[2] = VeinKind::kFloret;
  network.kind[4] = VeinKind::kAdaxial;
  network.relabel();
  EXPECT_EQ(network.kind[2], VeinKind::kAdaxial);
  EXPECT_EQ(network.kind[3], VeinKind::kFloret);
  EXPECT_EQ(network.kind[0], VeinKind::kAbaxial);
}

TEST(VeinNetwork, CountsEdgesBetweenVerticesOfOneTree) {
  const VeinNetwork network = fork();
  EXPECT_EQ(network.edges_between(3, 3), 0);
  EXPECT_EQ(network.edges_between(3, 4), 2);
  EXPECT_EQ(network.edges_between(0, 5), 2);
  EXPECT_EQ(network.edges_between(5, 0), 2);
  EXPECT_EQ(network.edges_between(3, 6), -1);
}

TEST(VeinNetwork, LeadsTowardsTheRingAlongSecondWaysToo) {
  VeinNetwork network = fork();
  EXPECT_TRUE(network.leads(3, 0));
  EXPECT_FALSE(network.leads(0, 3));
  EXPECT_FALSE(network.leads(3, 1));
  network.add_second_way({3, 6, 3, 0, kNoVertex});
  EXPECT_TRUE(network.leads(3, 1));
}

TEST(Diameters, ObeyMurraysLawAtEveryJoint) {
  VeinParams params;
  params.murray_exponent = 3.0;
  params.tip_diameter_mm = {0.1, 0.2, 0.3};
  const VeinNetwork network = fork();
  const Diameters d = diameters(network, params, 2);
  EXPECT_NEAR(d.vertices[3], 0.1, 1e-15);
  EXPECT_NEAR(d.vertices[4], 0.2, 1e-15);
  EXPECT_NEAR(d.vertices[2], std::cbrt(0.001 + 0.008 + 0.008), 1e-15);
  EXPECT_NEAR(d.vertices[0], d.vertices[2], 1e-15);
}

TEST(Diameters, SplitUnevenlyAndLoseNothing) {
  VeinParams params;
  params.murray_exponent = 3.0;
  params.tip_diameter_mm = {0.1, 0.2, 0.3};
  params.second_share = 0.25;
  VeinNetwork network = fork();
  network.add_second_way({2, 6, 2, 0, kNoVertex});
  const Diameters d = diameters(network, params, 2);
  const auto cube = [](double x) { return x * x * x; };
  const double in = 0.001 + 0.008 + 0.008;
  EXPECT_NEAR(cube(d.vertices[2]), 0.75 * in, 1e-15);
  EXPECT_NEAR(cube(d.second_ways[0]), 0.25 * in, 1e-15);
  EXPECT_NEAR(cube(d.vertices[0]) + cube(d.vertices[1]), in, 1e-15);  // what comes in at the tips goes out at the ring
  EXPECT_NEAR(d.vertices[6], d.second_ways[0], 1e-15);  // where a second strand comes in from above it is no tip
}

TEST(Diameters, ByKindCountTipsAndGiveSecondStrandsHalfMore) {
  VeinParams params;
  params.diameter_rule = DiameterRule::kMurrayByKind;
  params.murray_exponent = 2.0;
  params.tip_diameter_mm = {0.1, 0.2, 0.3};
  VeinNetwork network = fork();
  network.add_second_way({2, 6, 2, 0, kNoVertex});
  const Diameters d = diameters(network, params, 2);
  EXPECT_DOUBLE_EQ(d.vertices[3], 0.1);
  EXPECT_DOUBLE_EQ(d.vertices[2], 0.2 * std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(d.vertices[6], 0.2 * std::sqrt(1.0 + 1.5));  // itself a tip, and half of three
}

}  // namespace
}  // namespace anthesis::veins
