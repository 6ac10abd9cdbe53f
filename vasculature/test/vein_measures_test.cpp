#include "anthesis/vasculature/vein_measures.h"

#include <gtest/gtest.h>

#include <limits>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

VeinVertex vertex(Vec3 position, std::uint32_t parent, std::uint32_t primordium) {
  VeinVertex v;
  v.position = position;
  v.parent = parent;
  v.primordium = primordium;
  return v;
}

/// Two ring vertices. Strand 10 goes up from the first, 11 joins it half way, 12 joins 11; 13 goes up from the second
/// ring vertex, and 14 is not connected.
Vasculature small_head() {
  Vasculature veins;
  veins.ring_vertices = 2;
  veins.vertices = {vertex({1, 0, 0}, kNoVertex, kNoPrimordium),
                    vertex({-1, 0, 0}, kNoVertex, kNoPrimordium),
                    vertex({1, 0, 1}, 0, 10),    // 2
                    vertex({1, 0, 2}, 2, 10),    // 3, surface of 10
                    vertex({1, 0, 1.5}, 2, 11),  // 4: 0.5 from strand 10
                    vertex({0, 1, 1.5}, 4, 11),  // 5, surface of 11
                    vertex({1, 0, 2.5}, 4, 12),  // 6, surface of 12
                    vertex({-1, 0, 3}, 1, 13),   // 7, surface of 13
                    vertex({0, 0, 9}, kNoVertex, 14)};
  veins.vertices[8].resistance = std::numeric_limits<double>::infinity();
  veins.primordia = {3, 5, 6, 7, 8, kNoVertex};
  return veins;
}

TEST(Measure, CountsBundlesTipsAndJoints) {
  const VasculatureMeasures m = measure(small_head());
  EXPECT_EQ(m.bundles, 2u);
  EXPECT_EQ(m.tips, 4u);
  EXPECT_EQ(m.joints, 2u);
  EXPECT_NEAR(m.total_length, 1 + 1 + 0.5 + std::sqrt(2.0) + 1 + 3, 1e-15);
}

TEST(Measure, OrdersStrandsByWhatTheyJoin) {
  const VasculatureMeasures m = measure(small_head());
  ASSERT_EQ(m.strands.size(), 6u);
  EXPECT_EQ(m.strands[0].order, 1);
  EXPECT_EQ(m.strands[1].order, 2);
  EXPECT_EQ(m.strands[2].order, 3);
  EXPECT_EQ(m.strands[3].order, 1);
  EXPECT_FALSE(m.strands[4].connected);
  EXPECT_EQ(m.strands[5].vertex, kNoVertex);
  EXPECT_EQ(m.highest_order, 3);
}

TEST(Measure, GivesStrahlersNumbers) {
  const VasculatureMeasures m = measure(small_head());
  EXPECT_EQ(m.strahler[6], 1);
  EXPECT_EQ(m.strahler[4], 2);  // two tips meet
  EXPECT_EQ(m.strahler[2], 2);  // a tip joins: no more
  EXPECT_EQ(m.strahler[7], 1);
}

TEST(Measure, FollowsAStrandToTheRing) {
  const VasculatureMeasures m = measure(small_head(), 8);
  const StrandMeasures& strand = m.strands[1];
  EXPECT_NEAR(strand.own_length, std::sqrt(2.0) + 0.5, 1e-15);
  EXPECT_NEAR(strand.length_to_ring, std::sqrt(2.0) + 1.5, 1e-15);
  EXPECT_EQ(strand.bundle, 0u);
  EXPECT_NEAR(strand.turned_rad, -0.5 * math::kPi, 1e-15);  // from 90 degrees to 0
  EXPECT_EQ(strand.sectors_crossed, 2);                     // of 45 degrees
  EXPECT_EQ(m.strands[0].sectors_crossed, 0);
}

TEST(Measure, DoesNotTakeJitterForTurning) {
  // A strand that goes straight down beside the border of a sector, a little to one side and the other.
  Vasculature veins;
  veins.ring_vertices = 1;
  veins.vertices = {vertex({-1, 0, 0}, kNoVertex, kNoPrimordium)};
  for (std::uint32_t v = 1; v <= 20; ++v) {
    veins.vertices.push_back(vertex({-1, v % 2 == 0 ? 0.01 : -0.01, 0.1 * v}, v - 1, 3));
  }
  veins.primordia = {20};
  EXPECT_EQ(measure(veins, 34).strands[0].sectors_crossed, 0);
  // Out to the next sector and back again: one.
  veins.vertices[10].position = {-1, -0.2, 1};
  EXPECT_EQ(measure(veins, 34).strands[0].sectors_crossed, 1);
}

TEST(Measure, CountsLoopsWithAndWithoutTheRing) {
  Vasculature veins = small_head();
  veins.second_connections.push_back({3, 6, 10, 0.1});  // within one tree
  veins.second_connections.push_back({5, 7, 11, 0.1});  // from one tree to the other: a loop only through the ring
  VasculatureMeasures m = measure(veins);
  EXPECT_EQ(m.loops, 1u);
  EXPECT_EQ(m.loops_through_ring, 2u);
  veins.second_connections.push_back({3, 7, 10, 0.1});  // a second one between the trees closes another loop
  m = measure(veins);
  EXPECT_EQ(m.loops, 2u);
  EXPECT_EQ(m.loops_through_ring, 3u);
}

}  // namespace
}  // namespace anthesis
