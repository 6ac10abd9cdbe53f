#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "anthesis/geometry/vec.h"
#include "nearest.h"

namespace anthesis {

/// Bounds between eight pairs of parallel planes (a 16-DOP), in single precision. The first eight numbers are the
/// largest heights along the directions, the other eight the largest heights the opposite way.
struct alignas(64) Slabs {
  std::array<float, 16> highest;
};

/// Eight directions, at most 1 long, spread so that any other is within 34.2 degrees of one or its opposite.
inline constexpr std::array<std::array<double, 8>, 3> kSlabDirections = {{
    {0.6415, 0.3130, -0.6095, -0.0246, 0.1996, 0.7845, -0.9742, -0.4057},
    {0.3750, -0.5505, -0.7267, -0.8358, 0.0097, -0.2726, 0.1298, 0.9094},
    {-0.6690, -0.7737, -0.3163, 0.5482, 0.9797, 0.5567, 0.1840, 0.0897},
}};

/// Four floats at a time in the compiler's own spelling: every x86-64 processor has these, and comparing or adding
/// floats gives the same bits however many are taken at once.
using Four [[gnu::vector_size(16), gnu::may_alias]] = float;

inline Four four_of(const Slabs& slabs, int first) {
  return *reinterpret_cast<const Four*>(&slabs.highest[first]);
}

/// How far out along the directions and the opposite ways.
using Heights = std::array<double, 16>;

/// How far any share of `way`, from 0 to 1, reaches.
inline Heights heights_of_way(Vec3 way) {
  Heights heights;
  for (int k = 0; k < 8; ++k) {
    const double height = kSlabDirections[0][k] * way.x + kSlabDirections[1][k] * way.y + kSlabDirections[2][k] * way.z;
    heights[k] = std::max(height, 0.0);
    heights[8 + k] = std::max(-height, 0.0);
  }
  return heights;
}

/// What of rounding is added to the bounds of something of this size. Products and sums round by at most 3 units of
/// each part, sums of parts and the directions' length by four more.
inline double slab_slack(double size) {
  return 5.0 * std::numeric_limits<double>::epsilon() * size;
}

/// The bounds of all points within `reach` of `point`.
inline Slabs slabs_around(Vec3 point, double reach) {
  const double slack = reach + slab_slack(sum_of_sizes(point) + reach);
  Slabs slabs;
  // Rounding to single precision keeps the order of numbers, and so cannot part what was not apart.
  for (int k = 0; k < 8; ++k) {
    const double height =
        kSlabDirections[0][k] * point.x + kSlabDirections[1][k] * point.y + kSlabDirections[2][k] * point.z;
    slabs.highest[k] = static_cast<float>(slack + height);
    slabs.highest[8 + k] = static_cast<float>(slack - height);
  }
  return slabs;
}

/// The same of all places that `point` gets to by a share of `way` and a share of what has the heights `ride`.
inline Slabs slabs_around(Vec3 point, double reach, Vec3 way, const Heights& ride, double size_of_ride) {
  const double slack = reach + slab_slack(sum_of_sizes(point) + sum_of_sizes(way) + size_of_ride + reach);
  Slabs slabs;
  for (int k = 0; k < 8; ++k) {
    const double height =
        kSlabDirections[0][k] * point.x + kSlabDirections[1][k] * point.y + kSlabDirections[2][k] * point.z;
    const double further =
        kSlabDirections[0][k] * way.x + kSlabDirections[1][k] * way.y + kSlabDirections[2][k] * way.z;
    slabs.highest[k] = static_cast<float>((slack + height) + (ride[k] + std::max(further, 0.0)));
    slabs.highest[8 + k] = static_cast<float>((slack - height) + (ride[8 + k] + std::max(-further, 0.0)));
  }
  return slabs;
}

/// The bounds of what either holds.
inline Slabs joined(const Slabs& a, const Slabs& b) {
  Slabs both;
  for (int k = 0; k < 16; k += 4) {
    const Four one = four_of(a, k);
    const Four other = four_of(b, k);
    *reinterpret_cast<Four*>(&both.highest[k]) = one > other ? one : other;
  }
  return both;
}

/// False only where a plane lies between the two. The sum of two floats never has the wrong sign.
inline bool overlap(const Slabs& a, const Slabs& b) {
  using Signs [[gnu::vector_size(16)]] = std::int64_t;
  const auto sum = [&](int k) { return reinterpret_cast<Signs>(four_of(a, k) + four_of(b, k ^ 8)); };
  const Signs signs = (sum(0) | sum(4)) | (sum(8) | sum(12));
  return ((signs[0] | signs[1]) & static_cast<std::int64_t>(0x8000000080000000)) == 0;
}

}  // namespace anthesis
