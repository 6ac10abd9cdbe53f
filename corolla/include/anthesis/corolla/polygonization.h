#pragma once
#include <cstddef>
#include <vector>

#include "anthesis/geometry/function_graph.h"
#include "anthesis/geometry/mesh.h"

namespace anthesis {

/// A polygonization in parameter space: topology and (u, v) of each vertex, good for every stage of development.
struct FlatMesh {
  std::vector<double> rows;         ///< the v of the vertex rows, 0 first, 1 last
  std::vector<Vec2> uvs;            ///< row after row, u ascending
  std::vector<Triangle> triangles;  ///< counter-clockwise in (u, v)
};

/// Rows of vertices v_0 = 0, v_1, .., v_n = 1 between which the integral of dv / lambda(v) is equal (O16 eq. 1). The
/// number of intervals is that integral over [0, 1], times `detail`, rounded to at least 1, so the last row is the tip.
/// Precondition: lambda > 0.
std::vector<double> vertex_rows(const FunctionGraph& spacing, double detail);

/// Number of vertices across at v: ceil(eta(v)) as O16 defines it, with the intervals between them scaled by `detail`.
/// 1 where eta(v) <= 1, which is allowed at base and tip: the petal ends in a point there.
int vertices_across(double eta, double detail);

/// How many vertices polygonize makes, without making them.
std::size_t count_vertices(const FunctionGraph& spacing, const FunctionGraph& vertices, double detail);

/// The polygonization of O16 section 2: rows by lambda(v), ceil(eta(v)) equidistant vertices in each, Delaunay in (u,
/// v) with v stretched so that rows are one unit of u apart: triangles then join neighbouring rows only. Interior rows
/// have at least two vertices, so that both margins are edges of the mesh.
FlatMesh polygonize(const FunctionGraph& spacing, const FunctionGraph& vertices, double detail);

}  // namespace anthesis
