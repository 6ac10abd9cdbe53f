#pragma once
#include <array>

#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Nearest points of a vertex and a triangle, or of two edges, as signed weights: see Contact::weights.
struct Nearest {
  std::array<double, 4> weights = {};
  Vec3 difference;  ///< from the second nearest point to the first
  double distance = 0.0;
};

/// `points`: the vertex, then the triangle's corners. Degenerate triangles are taken as the segments or points they
/// are.
Nearest nearest_vertex_triangle(const std::array<Vec3, 4>& points);

/// `points`: the ends of the first edge, then those of the second. Parallel and degenerate edges included.
Nearest nearest_edge_edge(const std::array<Vec3, 4>& points);

/// What a motion in straight lines at constant speed leads to.
struct Touch {
  bool touches = false;
  double time = 1.0;       ///< in [0, 1]: free of contact before this time (a lower bound of the time of contact)
  bool undecided = false;  ///< counted as a touch because the refinement reached its limit
};

/// By planes that certainly separate the primitives for a while, one after the other until the end or the touch, and
/// where that takes too long by an interval test with a limited number of boxes; a test that reaches its limit is a
/// touch. Never answers "no touch" for a motion that touches, rounding included; may answer "touch" for one that passes
/// within `rounding` of it, 1e-14 of the primitives' extent and relative motion. Motions whose differences of positions
/// are not between 1e-100 and 1e100 in size are touches. About 0.1 us for a miss, 1 us for a touch, at
/// most half a millisecond. Vertex and triangle: `from`, `to` as in nearest_vertex_triangle. See
/// docs/contact-detection.md.
Touch first_touch_vertex_triangle(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to);
Touch first_touch_edge_edge(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to);

}  // namespace anthesis
