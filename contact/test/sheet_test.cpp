#include "anthesis/contact/sheet.h"

#include <gmock/gmock.h>

#include <cmath>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

using testing::ElementsAre;

TEST(MakeSheet, HasEachEdgeOnceAndAHingeWhereTwoTrianglesMeet) {
  // 3---2
  // | \ |     0 1 3 and 1 2 3 share the edge 1 3
  // 0---1
  const Sheet sheet = make_sheet(4, std::vector<Triangle>{{0, 1, 3}, {1, 2, 3}});
  EXPECT_EQ(sheet.vertex_count, 4u);
  EXPECT_THAT(sheet.edges, ElementsAre(ElementsAre(0, 1), ElementsAre(0, 3), ElementsAre(1, 2), ElementsAre(1, 3),
                                       ElementsAre(2, 3)));
  // The triangle 0 1 3 runs from 1 to 3, the other one back.
  EXPECT_THAT(sheet.hinges, ElementsAre(ElementsAre(1, 3, 0, 2)));
  EXPECT_THAT(sheet.edge_stiffness, ElementsAre(1.0, 1.0, 1.0, 1.0, 1.0));
  EXPECT_THAT(sheet.hinge_stiffness, ElementsAre(1.0));
  EXPECT_TRUE(sheet.attached.empty());
}

TEST(MakeSheet, ObeysEulersFormulaOnATube) {
  // A tube of 7 x 5 vertices has as many vertices and triangles as edges, and all but its two rims are hinges.
  std::vector<Triangle> triangles;
  constexpr std::uint32_t kAround = 7;
  constexpr std::uint32_t kRows = 5;
  for (std::uint32_t r = 0; r + 1 < kRows; ++r) {
    for (std::uint32_t c = 0; c < kAround; ++c) {
      const std::uint32_t a = r * kAround + c;
      const std::uint32_t b = r * kAround + (c + 1) % kAround;
      triangles.push_back({a, b, b + kAround});
      triangles.push_back({a, b + kAround, a + kAround});
    }
  }
  const Sheet sheet = make_sheet(kAround * kRows, triangles);
  EXPECT_EQ(sheet.vertex_count + triangles.size(), sheet.edges.size());
  EXPECT_EQ(sheet.hinges.size(), sheet.edges.size() - 2 * kAround);
  EXPECT_TRUE(std::is_sorted(sheet.edges.begin(), sheet.edges.end()));
}

TEST(MakeSheet, HingesThreeTrianglesAtOneEdgeInTurn) {
  const Sheet sheet = make_sheet(5, std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  EXPECT_THAT(sheet.hinges, ElementsAre(ElementsAre(0, 1, 2, 3), ElementsAre(1, 0, 3, 4)));
}

TEST(MakeSheet, OfNothingHasNothing) {
  const Sheet sheet = make_sheet(0, {});
  EXPECT_TRUE(sheet.edges.empty());
  EXPECT_TRUE(sheet.hinges.empty());
}

/// The angle of two triangles on the y axis: the one towards -x lies flat, the other one rises by `rise_rad`.
double angle_of(double rise_rad) {
  // The first triangle runs from the first to the second vertex of the edge counter-clockwise seen from +z.
  return hinge_angle_rad({0, 0, 0}, {0, 2, 0}, {-1, 1, 0}, {math::cos(rise_rad), 0.5, math::sin(rise_rad)});
}

TEST(HingeAngle, IsHowFarTheTrianglesTurnOutOfOnePlane) {
  EXPECT_EQ(angle_of(0.0), 0.0);
  EXPECT_NEAR(std::abs(angle_of(math::kPi / 2)), math::kPi / 2, 1e-15);
  EXPECT_NEAR(std::abs(angle_of(3.0)), 3.0, 1e-15);
  // Folded shut it is half a turn, either way.
  EXPECT_NEAR(std::abs(angle_of(math::kPi)), math::kPi, 1e-15);
}

TEST(HingeAngle, IsPositiveWhereTheApexesLieBehindTheNormals) {
  // The normals point towards +z. A ridge has its apexes below, a valley above.
  EXPECT_NEAR(angle_of(-0.5), 0.5, 1e-15);
  EXPECT_NEAR(angle_of(0.5), -0.5, 1e-15);
}

TEST(HingeAngle, DoesNotDependOnWhichTriangleComesFirst) {
  const Vec3 a{0.3, 0.1, -0.2};
  const Vec3 b{0.5, 2.0, 0.1};
  const Vec3 c{-1.0, 0.7, 0.4};
  const Vec3 d{1.2, 0.9, 0.8};
  EXPECT_DOUBLE_EQ(hinge_angle_rad(a, b, c, d), hinge_angle_rad(b, a, d, c));
}

TEST(HingeAngle, KeepsAllItsDigitsWhereTheTrianglesAreAlmostFlat) {
  // acos of the normals' product would give 0 for the last ones, and a relative error of 1e-8 / angle before.
  for (const double rise_rad : {1e-3, 1e-6, 1e-9, 1e-12}) {
    EXPECT_NEAR(angle_of(-rise_rad) / rise_rad, 1.0, 1e-14) << rise_rad;
  }
}

}  // namespace
}  // namespace anthesis
