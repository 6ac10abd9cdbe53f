#include "anthesis/contact/elastic_batch.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"

namespace anthesis {
namespace {

constexpr std::uint32_t kColumns = 5;
constexpr std::uint32_t kRows = 12;

/// A petal of 3 by 1.2 mm, curled along its length and cupped across; its first two rows are attached.
Sheet petal_sheet() {
  std::vector<Triangle> triangles;
  for (std::uint32_t row = 0; row + 1 < kRows; ++row) {
    for (std::uint32_t column = 0; column + 1 < kColumns; ++column) {
      const std::uint32_t a = row * kColumns + column;
      triangles.push_back({a, a + 1, a + kColumns});
      triangles.push_back({a + 1, a + 1 + kColumns, a + kColumns});
    }
  }
  Sheet sheet = make_sheet(kColumns * kRows, triangles);
  for (std::uint32_t v = 0; v < 2 * kColumns; ++v) {
    sheet.attached.push_back(v);
    sheet.attachment_stiffness.push_back(1.0);
  }
  return sheet;
}

std::vector<Vec3> petal(double curl_rad, double cup, double size = 1.0) {
  std::vector<Vec3> positions;
  for (std::uint32_t v = 0; v < kColumns * kRows; ++v) {
    const double across = 1.2 * (static_cast<double>(v % kColumns) / (kColumns - 1) - 0.5);
    const double along = 3.0 * static_cast<double>(v / kColumns) / (kRows - 1);
    const double radius = 3.0 / curl_rad;
    const Vec3 at = {across, radius * math::sin(along / radius),
                     radius * (1.0 - math::cos(along / radius)) + cup * across * across};
    positions.push_back(size * at);
  }
  return positions;
}

/// The petal `shape` with its attached rows where `target` has them.
std::vector<Vec3> planted(std::vector<Vec3> shape, const std::vector<Vec3>& target) {
  std::copy_n(target.begin(), 2 * kColumns, shape.begin());
  return shape;
}

double angle_at(const std::array<std::uint32_t, 4>& hinge, const std::vector<Vec3>& positions) {
  return hinge_angle_rad(positions[hinge[0]], positions[hinge[1]], positions[hinge[2]], positions[hinge[3]]);
}

struct Residual {
  double length = 0.0;  ///< largest relative error of an edge
  double angle_rad = 0.0;
};

Residual residual(const Sheet& sheet, const std::vector<Vec3>& positions, const std::vector<Vec3>& targets) {
  Residual worst;
  for (const auto& [a, b] : sheet.edges) {
    const double ratio = length(positions[b] - positions[a]) / length(targets[b] - targets[a]);
    worst.length = std::max(worst.length, std::abs(ratio - 1.0));
  }
  for (const auto& hinge : sheet.hinges) {
    worst.angle_rad = std::max(worst.angle_rad, std::abs(angle_at(hinge, positions) - angle_at(hinge, targets)));
  }
  return worst;
}

constexpr std::uint32_t kFirstOrgan[] = {0};

std::vector<Vec3> swept(const Sheet& sheet, const std::vector<Vec3>& targets, std::vector<Vec3> positions, int sweeps) {
  ElasticBatch batch(sheet);
  batch.set_rest(targets, kFirstOrgan);
  batch.load(positions);
  batch.sweep(sweeps);
  batch.store(positions);
  return positions;
}

std::vector<Vec3> settled(const Sheet& sheet, const std::vector<Vec3>& targets, std::vector<Vec3> positions,
                          int sweeps) {
  ElasticBatch batch(sheet);
  batch.set_rest(targets, kFirstOrgan);
  batch.load(positions);
  batch.settle(sweeps);
  batch.store(positions);
  return positions;
}

Vec3 sum(const std::vector<Vec3>& positions) {
  Vec3 total;
  for (const Vec3 position : positions) {
    total += position;
  }
  return total;
}

/// Two triangles over the edge from (0, 0, 0) to (0, 1, 0), the second one turned by `angle_rad` out of their plane.
std::vector<Vec3> wings(double angle_rad, double span = 0.8) {
  return {{0.0, 0.0, 0.0},
          {0.0, 1.0, 0.0},
          {-0.7, 0.4, 0.0},
          {span * math::cos(angle_rad), 0.7, -span * math::sin(angle_rad)}};
}

Sheet wing_sheet() {
  const Triangle triangles[] = {{0, 1, 2}, {1, 0, 3}};
  return make_sheet(4, triangles);
}

TEST(ElasticBatch, LeavesAnOrganAtRestUntouched) {
  const std::vector<Vec3> target = petal(1.2, 0.5);
  EXPECT_EQ(swept(petal_sheet(), target, target, 100), target);
  EXPECT_EQ(settled(petal_sheet(), target, target, 100), target);
}

TEST(ElasticBatch, AFullShareGivesAnEdgeItsLengthAndHalfAShareTakesHalfTheError) {
  Sheet sheet;
  sheet.vertex_count = 2;
  sheet.edges = {{0, 1}};
  const std::vector<Vec3> target = {{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}};
  const std::vector<Vec3> stretched = {{1.0, 1.0, 1.0}, {1.0, 4.0, 5.0}};
  for (const auto& [stiffness, expected] : {std::pair{1.0, 2.0}, std::pair{0.5, 3.5}, std::pair{0.0, 5.0}}) {
    sheet.edge_stiffness = {stiffness};
    const std::vector<Vec3> after = swept(sheet, target, stretched, 1);
    EXPECT_NEAR(length(after[1] - after[0]), expected, 1e-14);
    EXPECT_NEAR(length(sum(after) - sum(stretched)), 0.0, 1e-14);
  }
}

TEST(ElasticBatch, AFullAttachmentMeetsItsPlaceToTheLastBitAndATenthGoesATenth) {
  Sheet sheet;
  sheet.vertex_count = 1;
  sheet.attached = {0};
  const std::vector<Vec3> place = {{0.1, 0.2, 0.3}};
  const std::vector<Vec3> far = {{1e6 + 0.1, 0.2, 0.3}};
  sheet.attachment_stiffness = {1.0};
  EXPECT_EQ(swept(sheet, place, far, 1), place);
  sheet.attachment_stiffness = {0.1};
  EXPECT_NEAR(swept(sheet, place, far, 1)[0].x, 9e5 + 0.1, 1e-9);
}

TEST(ElasticBatch, AHingeMovesAgainstTheGradientOfItsAngle) {
  Sheet sheet = wing_sheet();
  sheet.edge_stiffness.assign(sheet.edges.size(), 0.0);
  for (const double angle_rad : {-2.6, -1.0, -0.3, 0.0, 0.4, 1.5, 2.8}) {
    const std::vector<Vec3> start = wings(angle_rad);
    const double error = 0.01;
    const std::vector<Vec3> after = swept(sheet, wings(angle_rad - error), start, 1);
    std::array<Vec3, 4> gradient;
    double square = 0.0;
    for (std::size_t v = 0; v < 4; ++v) {
      for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
        constexpr double kStep = 1e-5;
        std::vector<Vec3> more = start;
        std::vector<Vec3> less = start;
        more[v].*axis += kStep;
        less[v].*axis -= kStep;
        gradient[v].*axis = (angle_at(sheet.hinges[0], more) - angle_at(sheet.hinges[0], less)) / (2.0 * kStep);
      }
      square += dot(gradient[v], gradient[v]);
    }
    for (std::size_t v = 0; v < 4; ++v) {
      EXPECT_NEAR(length(after[v] - start[v] + error / square * gradient[v]), 0.0, 1e-11)
          << angle_rad << " vertex " << v;
    }
  }
}

TEST(ElasticBatch, AHingeBendsToItsOwnSide) {
  const Sheet sheet = wing_sheet();
  ASSERT_NEAR(angle_at(sheet.hinges[0], wings(0.5)), 0.5, 1e-15);
  for (const double rest_rad : {0.5, -0.5, 2.5, -2.5, 3.0}) {
    const std::vector<Vec3> after = settled(sheet, wings(rest_rad), wings(0.0), 400);
    EXPECT_NEAR(angle_at(sheet.hinges[0], after), rest_rad, 1e-9);
  }
}

TEST(ElasticBatch, AHingeTakesTheShorterWay) {
  // From 2.9 to -2.9 rad it is 0.48 rad through the fold, and 5.8 rad through the plane.
  Sheet sheet = wing_sheet();
  const std::vector<Vec3> after = swept(sheet, wings(-2.9), wings(2.9), 1);
  const double angle_rad = angle_at(sheet.hinges[0], after);
  EXPECT_TRUE(angle_rad > 2.9 || angle_rad < 0.0) << angle_rad;
}

TEST(ElasticBatch, AFoldedHingeOpensByAnEighthOfPiAtMost) {
  Sheet sheet = wing_sheet();
  sheet.edge_stiffness.assign(sheet.edges.size(), 0.0);
  const std::vector<Vec3> folded = wings(3.1);
  const std::vector<Vec3> after = swept(sheet, wings(0.0), folded, 1);
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_LE(length(after[v] - folded[v]), 0.8 * math::kPi / 8.0);
  }
  EXPECT_LT(angle_at(sheet.hinges[0], after), 3.0);
}

TEST(ElasticBatch, TrianglesWithoutAnAreaHaveNoAngle) {
  Sheet sheet = wing_sheet();
  const std::vector<Vec3> sound = wings(0.5);
  std::vector<Vec3> flat = sound;
  flat[3] = {0.0, 2.0, 1e-13};  // in line with the edge but for rounding
  std::vector<Vec3> point = sound;
  point[1] = point[0];
  for (const std::vector<Vec3>& collapsed : {flat, point}) {
    for (const Vec3 position : settled(sheet, sound, collapsed, 10)) {
      EXPECT_TRUE(std::isfinite(position.x + position.y + position.z));
    }
    EXPECT_EQ(settled(sheet, collapsed, collapsed, 10), collapsed);
  }
  sheet.edge_stiffness.assign(sheet.edges.size(), 0.0);
  EXPECT_EQ(swept(sheet, flat, sound, 1), sound);
  EXPECT_EQ(swept(sheet, sound, flat, 1), flat);
}

TEST(ElasticBatch, ABentAndStretchedPetalSettlesInItsRestShape) {
  const Sheet sheet = petal_sheet();
  const std::vector<Vec3> target = petal(1.2, 0.5);
  for (const auto& start : {petal(1.2, 0.5, 1.1), petal(0.3, 0.5), petal(1e-3, 0.0, 0.8), petal(-1.2, -0.5, 0.95)}) {
    const std::vector<Vec3> after = settled(sheet, target, planted(start, target), 1000);
    const Residual left = residual(sheet, after, target);
    EXPECT_LT(left.length, 1e-6);
    EXPECT_LT(left.angle_rad, 1e-6);
    for (std::size_t v = 0; v < target.size(); ++v) {
      EXPECT_LT(length(after[v] - target[v]), 1e-5);
    }
    EXPECT_TRUE(std::equal(target.begin(), target.begin() + 2 * kColumns, after.begin()));
  }
}

TEST(ElasticBatch, MomentumSavesSweeps) {
  const Sheet sheet = petal_sheet();
  const std::vector<Vec3> target = petal(1.2, 0.5);
  const std::vector<Vec3> start = planted(petal(0.3, 0.5), target);
  EXPECT_LT(residual(sheet, settled(sheet, target, start, 300), target).angle_rad,
            0.1 * residual(sheet, swept(sheet, target, start, 1000), target).angle_rad);
}

TEST(ElasticBatch, MomentumSurvivesTakingPositionsOutAndIn) {
  const Sheet sheet = petal_sheet();
  const std::vector<Vec3> target = petal(1.2, 0.5);
  std::vector<Vec3> positions = planted(petal(0.3, 0.5), target);
  const std::vector<Vec3> at_once = settled(sheet, target, positions, 20);
  ElasticBatch batch(sheet);
  batch.set_rest(target, kFirstOrgan);
  for (int i = 0; i < 4; ++i) {
    batch.load(positions);
    batch.settle(5);
    batch.store(positions);
  }
  EXPECT_EQ(positions, at_once);
}

TEST(ElasticBatch, AnUnattachedPetalKeepsItsCentre) {
  Sheet sheet = petal_sheet();
  sheet.attached.clear();
  sheet.attachment_stiffness.clear();
  const std::vector<Vec3> start = petal(0.3, 0.2, 1.1);
  EXPECT_NEAR(length(sum(swept(sheet, petal(1.2, 0.5), start, 50)) - sum(start)), 0.0, 1e-11);
  EXPECT_NEAR(length(sum(settled(sheet, petal(1.2, 0.5), start, 50)) - sum(start)), 0.0, 1e-11);
}

TEST(ElasticBatch, AHingeExertsNoTorque) {
  Sheet sheet = wing_sheet();
  sheet.edge_stiffness.assign(sheet.edges.size(), 0.0);
  const std::vector<Vec3> start = wings(0.9);
  const std::vector<Vec3> after = swept(sheet, wings(0.6), start, 1);
  Vec3 torque;
  for (std::size_t v = 0; v < 4; ++v) {
    torque += cross(start[v], after[v] - start[v]);
  }
  EXPECT_NEAR(length(torque), 0.0, 1e-15);
}

TEST(ElasticBatch, ATurnedPetalGivesTheTurnedResult) {
  const Sheet sheet = petal_sheet();
  const Placement turn = {{4.0, -2.0, 7.0}, rotation_about(normalized(Vec3{1.0, 2.0, -0.5}), 2.1)};
  const std::vector<Vec3> target = petal(1.2, 0.5);
  const std::vector<Vec3> start = planted(petal(0.5, 0.3, 1.05), target);
  std::vector<Vec3> turned_target;
  std::vector<Vec3> turned_start;
  for (std::size_t v = 0; v < target.size(); ++v) {
    turned_target.push_back(apply(turn, target[v]));
    turned_start.push_back(apply(turn, start[v]));
  }
  const std::vector<Vec3> after = swept(sheet, target, start, 20);
  const std::vector<Vec3> turned_after = swept(sheet, turned_target, turned_start, 20);
  for (std::size_t v = 0; v < target.size(); ++v) {
    EXPECT_NEAR(length(turned_after[v] - apply(turn, after[v])), 0.0, 1e-12);
  }
}

/// Eleven petals in one array, each with a shape of its own; organs are its petals 10, 9, ... 0.
struct Crowd {
  std::vector<Vec3> targets;
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> first_vertex;
};

Crowd crowd() {
  Crowd made;
  for (std::uint32_t i = 0; i < 11; ++i) {
    const std::vector<Vec3> target = petal(0.2 + 0.2 * i, 0.1 * i);
    const std::vector<Vec3> start = planted(petal(0.1 + 0.25 * i, 0.5 - 0.1 * i, 0.9 + 0.02 * i), target);
    made.first_vertex.insert(made.first_vertex.begin(), static_cast<std::uint32_t>(made.targets.size()));
    made.targets.insert(made.targets.end(), target.begin(), target.end());
    made.positions.insert(made.positions.end(), start.begin(), start.end());
  }
  return made;
}

std::vector<Vec3> settled(const Sheet& sheet, const Crowd& crowd, std::span<const std::uint32_t> organs) {
  ElasticBatch batch(sheet);
  std::vector<Vec3> positions = crowd.positions;
  batch.set_rest(crowd.targets, organs);
  batch.load(positions);
  batch.sweep(3);
  batch.settle(40);
  batch.store(positions);
  return positions;
}

TEST(ElasticBatch, TheCompanyOfOthersDoesNotMatter) {
  const Sheet sheet = petal_sheet();
  const Crowd all = crowd();
  const std::vector<Vec3> together = settled(sheet, all, all.first_vertex);
  EXPECT_NE(together, all.positions);
  for (const std::uint32_t first : all.first_vertex) {
    std::vector<Vec3> expected = all.positions;  // and nothing but the chosen organ changes
    std::copy_n(together.begin() + first, sheet.vertex_count, expected.begin() + first);
    EXPECT_EQ(settled(sheet, all, std::span(&first, 1)), expected);
  }
}

TEST(ElasticBatch, MayChooseOtherOrgansAgain) {
  const Sheet sheet = petal_sheet();
  const Crowd all = crowd();
  const std::span<const std::uint32_t> organs(all.first_vertex);
  ElasticBatch batch(sheet);
  for (const std::size_t count : {11, 0, 9, 1, 8}) {
    std::vector<Vec3> positions = all.positions;
    batch.set_rest(all.targets, organs.last(count));
    batch.load(positions);
    batch.sweep(3);
    batch.settle(40);
    batch.store(positions);
    EXPECT_EQ(positions, settled(sheet, all, organs.last(count))) << count;
  }
}

TEST(ElasticBatch, ForgetsABrokenOrganWithTheNextChoice) {
  const Sheet sheet = petal_sheet();
  const Crowd all = crowd();
  const std::span<const std::uint32_t> one = std::span(all.first_vertex).first(1);
  std::vector<Vec3> positions(all.positions.size(), Vec3{std::nan(""), 0.0, 0.0});
  ElasticBatch batch(sheet);
  batch.set_rest(all.targets, one);
  batch.load(positions);
  batch.settle(3);
  batch.set_rest(all.targets, one);
  positions = all.positions;
  batch.load(positions);
  batch.sweep(3);
  batch.settle(40);
  batch.store(positions);
  EXPECT_EQ(positions, settled(sheet, all, one));
}

TEST(ElasticBatch, GivesTheSameBitsForAnyNumberOfThreads) {
  const Sheet sheet = petal_sheet();
  const Crowd all = crowd();
  std::vector<Vec3> alone;
  {
    const ThreadLimit limit(1);
    alone = settled(sheet, all, all.first_vertex);
  }
  const ThreadLimit limit(4);
  EXPECT_EQ(settled(sheet, all, all.first_vertex), alone);
}

TEST(ElasticBatch, GivesTheSameBitsForEveryInstructionSet) {
  const Sheet sheet = petal_sheet();
  const Crowd all = crowd();
  const std::vector<Vec3> widest = settled(sheet, all, all.first_vertex);
  std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS;
  EXPECT_GE(std::popcount(static_cast<std::uint64_t>(left)), 2);
  for (; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    EXPECT_EQ(settled(sheet, all, all.first_vertex), widest) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace anthesis
