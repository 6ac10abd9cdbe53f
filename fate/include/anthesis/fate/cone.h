#pragma once
#include <limits>
#include <span>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis {

/// For each floret the distance to the nearest other floret within its cone, infinite where the cone is empty
/// (O16 section 5, eqs. 4 and 5, fig. 14).
///
/// The cone of floret P opens away from the head's centre O, by `cone_rad` in (0, pi) to either side of OP: Q is inside
/// when the cosine between PQ and OP exceeds cos(cone_rad). (The paper prints the inequality the other way round, which
/// selects the complement.) Places are projections on the head's plane. A floret on the centre has no outward
/// direction: its cone is the whole plane. O(n log n) in all for heads; never all pairs.
std::vector<double> nearest_in_cone_mm(std::span<const Vec2> florets_mm, Vec2 centre_mm, double cone_rad);

/// Number of florets with an empty cone: ray florets in the simplest rule (fig. 14c).
std::size_t count_with_room(std::span<const Vec2> florets_mm, Vec2 centre_mm, double cone_rad);

}  // namespace anthesis
