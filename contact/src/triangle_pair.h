#pragma once
#include <array>
#include <cstdint>

#include "anthesis/geometry/predicates.h"

namespace anthesis::detail {

/// A triangle with its corners and its plane at hand: two lines of the processor's cache. Corners at equal places, and
/// only they, have equal vertices.
struct alignas(64) PlacedTriangle {
  PlaneSide plane;
  std::array<std::uint32_t, 3> vertex;
  std::uint32_t index = 0;
  bool degenerate = false;  ///< without area
};

/// True if the three points lie in one line, exactly.
bool collinear(Vec3 a, Vec3 b, Vec3 c);

/// Whether two triangles cross as find_crossings means it, exactly; if so, a point near the crossing.
bool triangles_cross(const PlacedTriangle& one, const PlacedTriangle& other, Vec3& place);

}  // namespace anthesis::detail
