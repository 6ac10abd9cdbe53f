#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "anthesis/geometry/vec.h"

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

/// The bounds of all points within `reach` of `point`.
inline Slabs slabs_around(Vec3 point, double reach) {
  // Products and sums round by at most 3 units each, the directions' length by one more.
  const double slack = reach + 4.0 * std::numeric_limits<double>::epsilon() *
                                   (std::abs(point.x) + std::abs(point.y) + std::abs(point.z) + reach);
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
