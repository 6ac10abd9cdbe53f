#pragma once
#include <span>
#include <vector>

#include "anthesis/geometry/mesh.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Triangles of a simple polygon given counter-clockwise, without new points: n - 2 of them, by ears. A polygon that
/// crosses itself gives triangles too, some of them turned over.
std::vector<Triangle> triangulate_polygon(std::span<const Vec2> polygon);

}  // namespace anthesis
