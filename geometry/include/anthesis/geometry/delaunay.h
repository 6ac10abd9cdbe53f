#pragma once
#include <span>
#include <vector>

#include "anthesis/geometry/mesh.h"

namespace anthesis {

/// Delaunay triangulation of points in the unit square [0, 1]^2: counter-clockwise triangles that fill the convex hull,
/// none degenerate (Boost.Polygon's exact Voronoi diagram on a grid of 2^-28).
///
/// Points that share a circle are fanned from the point nearest the line x = 1/2 (then the lowest), so that points
/// placed symmetrically about that line get symmetric triangles wherever they allow it. Points must differ by more than
/// 2^-27; fewer than three, or all on a line, give no triangles. O(n log n), the same triangles on every machine.
std::vector<Triangle> delaunay(std::span<const Vec2> points);

}  // namespace anthesis
