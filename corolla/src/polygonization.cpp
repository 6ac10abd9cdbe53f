#include "anthesis/corolla/polygonization.h"

#include <algorithm>
#include <cmath>

#include "anthesis/geometry/cumulative_integral.h"
#include "anthesis/geometry/delaunay.h"

namespace anthesis {

std::vector<double> vertex_rows(const FunctionGraph& spacing, double detail) {
  std::vector<double> breaks = {0.0};
  for (const double v : spacing.breaks()) {
    if (v > 0.0 && v < 1.0) {
      breaks.push_back(v);
    }
  }
  breaks.push_back(1.0);
  const CumulativeIntegral steps([&](double v) { return 1.0 / spacing(v); }, breaks, 1e-12);
  const int intervals = std::max(1, static_cast<int>(std::lround(steps.total() * detail)));
  std::vector<double> rows;
  for (int i = 0; i <= intervals; ++i) {
    rows.push_back(i == 0 ? 0.0 : i == intervals ? 1.0 : steps.inverse(steps.total() * i / intervals));
  }
  return rows;
}

int vertices_across(double eta, double detail) {
  const double intervals = std::ceil(eta) - 1.0;
  return intervals <= 0.0 ? 1 : std::max(2, 1 + static_cast<int>(std::lround(intervals * detail)));
}

namespace {

int vertices_in_row(const std::vector<double>& rows, std::size_t row, const FunctionGraph& vertices, double detail) {
  const bool end = row == 0 || row + 1 == rows.size();
  return std::max(vertices_across(vertices(rows[row]), detail), end ? 1 : 2);
}

}  // namespace

std::size_t count_vertices(const FunctionGraph& spacing, const FunctionGraph& vertices, double detail) {
  const std::vector<double> rows = vertex_rows(spacing, detail);
  std::size_t count = 0;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    count += static_cast<std::size_t>(vertices_in_row(rows, j, vertices, detail));
  }
  return count;
}

FlatMesh polygonize(const FunctionGraph& spacing, const FunctionGraph& vertices, double detail) {
  FlatMesh mesh;
  mesh.rows = vertex_rows(spacing, detail);
  // The triangulation is found with the rows moved one unit of u apart. Then no circle through neighbours in two rows
  // reaches a third, whatever lambda and eta are; with the bare v, rows close together near a pointed tip would be
  // skipped by long triangles that fold over where the petal curls.
  const auto intervals = static_cast<double>(mesh.rows.size() - 1);
  std::vector<Vec2> apart;
  for (std::size_t j = 0; j < mesh.rows.size(); ++j) {
    const int across = vertices_in_row(mesh.rows, j, vertices, detail);
    for (int i = 0; i < across; ++i) {
      const double u = across == 1 ? 0.5 : static_cast<double>(i) / (across - 1);
      mesh.uvs.push_back({u, mesh.rows[j]});
      apart.push_back({0.5 + (u - 0.5) / intervals, static_cast<double>(j) / intervals});
    }
  }
  mesh.triangles = delaunay(apart);
  return mesh;
}

}  // namespace anthesis
