#include "anthesis/corolla/polygonization.h"

#include <gtest/gtest.h>

#include <map>

namespace anthesis {
namespace {

TEST(VertexRows, MeetEquation1BetweenEachTwo) {
  const FunctionGraph spacing({{0.0, 0.3}, {0.5, 0.15}, {1.0, 0.05}});
  const std::vector<double> rows = vertex_rows(spacing, 1.0);
  EXPECT_EQ(rows.front(), 0.0);
  EXPECT_EQ(rows.back(), 1.0);
  std::vector<double> integrals;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    constexpr int kSteps = 4000;
    double sum = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      sum += (rows[i + 1] - rows[i]) / kSteps / spacing(rows[i] + (rows[i + 1] - rows[i]) * (k + 0.5) / kSteps);
    }
    integrals.push_back(sum);
  }
  for (const double integral : integrals) {
    EXPECT_NEAR(integral, integrals[0], 1e-6);
    EXPECT_NEAR(integral, 1.0, 0.12);  // a whole number of intervals has to fit
  }
}

TEST(VertexRows, SmallChangesOfSpacingMoveRowsLittle) {
  const auto a = vertex_rows(FunctionGraph({{0.0, 0.1}, {1.0, 0.2}}), 1.0);
  const auto b = vertex_rows(FunctionGraph({{0.0, 0.1001}, {1.0, 0.2}}), 1.0);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i], b[i], 1e-3);
  }
}

TEST(Polygonize, HasCeilEtaVerticesInEachRowAndPointedEnds) {
  const FunctionGraph vertices({{0.0, 2.2}, {0.6, 4.9}, {1.0, 1.0}});
  const FlatMesh mesh = polygonize(FunctionGraph({{0.0, 0.2}, {1.0, 0.2}}), vertices, 1.0);
  std::map<double, int> in_row;
  for (const Vec2 uv : mesh.uvs) {
    ++in_row[uv.y];
  }
  for (const auto& [v, count] : in_row) {
    EXPECT_EQ(count, static_cast<int>(std::ceil(vertices(v)))) << v;
  }
  EXPECT_EQ(in_row[1.0], 1);
}

TEST(Polygonize, DetailTwoHasAboutFourTimesTheTriangles) {
  const FunctionGraph spacing({{0.0, 0.1}, {1.0, 0.1}});
  const FunctionGraph vertices({{0.0, 5.0}, {1.0, 5.0}});
  const double coarse = static_cast<double>(polygonize(spacing, vertices, 1.0).triangles.size());
  const double fine = static_cast<double>(polygonize(spacing, vertices, 2.0).triangles.size());
  EXPECT_NEAR(fine / coarse, 4.0, 0.4);
}

TEST(Polygonize, FillsTheParameterSquareOnce) {
  const FlatMesh mesh =
      polygonize(FunctionGraph({{0.0, 0.17}, {1.0, 0.05}}), FunctionGraph({{0.0, 2.0}, {0.5, 9.0}, {1.0, 3.0}}), 1.0);
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const double one = 0.5 * cross(mesh.uvs[t[1]] - mesh.uvs[t[0]], mesh.uvs[t[2]] - mesh.uvs[t[0]]);
    EXPECT_GT(one, 0.0);
    area += one;
  }
  EXPECT_NEAR(area, 1.0, 1e-12);
}

}  // namespace
}  // namespace anthesis
