#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "anthesis/contact/continuous.h"

namespace anthesis {

/// Rounding of one operation, relative: half the distance from 1 to the next double.
inline constexpr double kUnitRoundoff = 0.5 * std::numeric_limits<double>::epsilon();

inline double sum_of_sizes(Vec3 v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

/// How many of the four points belong to the first primitive: 1 for vertex and triangle, 2 for two edges.
template <int FirstCount>
double width_along(const std::array<Vec3, 4>& points, Vec3 direction) {
  double first = std::numeric_limits<double>::infinity();
  double second = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4; ++i) {
    // Relative to the last point: what is common to all cancels before it can round.
    const double height = dot(direction, points[i] - points[3]);
    if (i < FirstCount) {
      first = std::min(first, height);
    } else {
      second = std::max(second, height);
    }
  }
  return first - second;
}

/// The largest coordinate of the points relative to the last one.
inline double extent(const std::array<Vec3, 4>& points) {
  double size = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 r = points[i] - points[3];
    size = std::max({size, std::abs(r.x), std::abs(r.y), std::abs(r.z)});
  }
  return size;
}

/// A lower bound of the distance between the two primitives, rounding included: a slab across `direction` that lies
/// between them is at least this thick. May be negative. For nearest.difference it comes close to the distance.
template <int FirstCount>
double distance_at_least(const std::array<Vec3, 4>& points, Vec3 direction) {
  const double size = length(direction);
  if (!(size > 0.0)) {
    return 0.0;
  }
  // Differences and products round by at most 8 units each of the largest product; twice that to be generous.
  const double rounding =
      16.0 * kUnitRoundoff * (std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z)) * extent(points);
  const double width = width_along<FirstCount>(points, direction) - rounding;
  return width / size * (width > 0.0 ? 1.0 - 8.0 * kUnitRoundoff : 1.0 + 8.0 * kUnitRoundoff);
}

}  // namespace anthesis
