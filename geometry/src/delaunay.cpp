#include "anthesis/geometry/delaunay.h"

#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <cstdint>

namespace anthesis {
namespace {

using Diagram = boost::polygon::voronoi_diagram<double>;

struct GridPoint {
  std::int32_t x;
  std::int32_t y;
};

constexpr double kGrid = 0x1p28;

/// Twice the signed area, exactly: coordinates below 2^29 leave products below 2^60.
std::int64_t twice_area(GridPoint a, GridPoint b, GridPoint c) {
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) - (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

}  // namespace
}  // namespace anthesis

namespace boost::polygon {
template <>
struct geometry_concept<anthesis::GridPoint> {
  using type = point_concept;
};
template <>
struct point_traits<anthesis::GridPoint> {
  using coordinate_type = std::int32_t;
  static coordinate_type get(const anthesis::GridPoint& point, orientation_2d orient) {
    return orient == HORIZONTAL ? point.x : point.y;
  }
};
}  // namespace boost::polygon

namespace anthesis {

std::vector<Triangle> delaunay(std::span<const Vec2> points) {
  std::vector<GridPoint> grid;
  grid.reserve(points.size());
  for (const Vec2 p : points) {
    // Centred, so that mirror images about x = 1/2 are mirror images on the grid too.
    grid.push_back({static_cast<std::int32_t>(std::lround((p.x - 0.5) * kGrid)),
                    static_cast<std::int32_t>(std::lround((p.y - 0.5) * kGrid))});
  }
  Diagram diagram;
  boost::polygon::construct_voronoi(grid.begin(), grid.end(), &diagram);

  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> ring;
  for (const auto& vertex : diagram.vertices()) {
    // The cells around a Voronoi vertex, in turn, are the points of one empty circle.
    ring.clear();
    const auto* edge = vertex.incident_edge();
    do {
      ring.push_back(static_cast<std::uint32_t>(edge->cell()->source_index()));
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const std::int32_t xa = std::abs(grid[a].x);
      const std::int32_t xb = std::abs(grid[b].x);
      if (xa != xb) {
        return xa < xb;
      }
      return grid[a].y != grid[b].y ? grid[a].y < grid[b].y : a < b;
    };
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), before), ring.end());
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
      Triangle triangle{ring[0], ring[i], ring[i + 1]};
      const std::int64_t area = twice_area(grid[triangle[0]], grid[triangle[1]], grid[triangle[2]]);
      if (area == 0) {
        continue;
      }
      if (area < 0) {
        std::swap(triangle[1], triangle[2]);
      }
      // One spelling of each triangle, whatever order the diagram was built in.
      std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
      triangles.push_back(triangle);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

}  // namespace anthesis
