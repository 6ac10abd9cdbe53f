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

FlatMesh polygonize(const FunctionGraph& spacing, const FunctionGraph& vertices, double detail) {
  FlatMesh mesh;
  mesh.rows = vertex_rows(spacing, detail);
  // The triangulation is found with the rows moved one unit of u apart. Then no circle through neighbours in two rows
  // reaches a third, whatever lambda and eta are; with the bare v, rows close together near a pointed tip would be
  // skipped by long triangles that fold over where the petal curls.
  const auto intervals = static_cast<double>(mesh.rows.size() - 1);
  std::vector<Vec2> apart;
  for (std::size_t j = 0; j < mesh.rows.size(); ++j) {
    const bool end = j == 0 || j + 1 == mesh.rows.size();
    const int across = std::max(vertices_across(vertices(mesh.rows[j]), detail), end ? 1 : 2);
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
