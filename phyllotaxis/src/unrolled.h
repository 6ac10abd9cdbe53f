#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/phyllotaxis/parastichies.h"

namespace anthesis::detail {

/// A triangle of neighbours on the unrolled surface. `side[k]` runs from corner k to the next; the three add to zero.
struct Cell {
  std::array<std::uint32_t, 3> rank{};  ///< counter-clockwise: azimuth to the right, u upwards
  std::array<Vec2, 3> side{};
};

/// A surface of revolution unrolled without change of angles: azimuth against u, the integral of ds / r. Organs are
/// known by their rank from the apex outwards.
struct Unrolled {
  std::vector<std::uint32_t> organ;  ///< index as given, by rank
  std::vector<Vec2> place;           ///< (azimuth in [0, 2 pi), u)
  std::vector<double> spacing;       ///< square root of the area of an organ here, in units of `place`
  std::vector<Cell> cells;           ///< each triangle of the periodic Delaunay triangulation once

  std::size_t size() const { return organ.size(); }
};

Unrolled unroll(std::span<const PatternOrgan> organs);

}  // namespace anthesis::detail
