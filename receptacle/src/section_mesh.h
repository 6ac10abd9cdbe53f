#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis {

inline constexpr double kMergeDistance = 1e-5;  ///< of control points, as a share of the section's size

/// The larger of width and height.
double section_size(std::span<const Vec2> controls);

/// The control points without those that become one with another, ascending.
std::vector<std::uint32_t> distinct_controls(std::span<const Vec2> controls);

}  // namespace anthesis
