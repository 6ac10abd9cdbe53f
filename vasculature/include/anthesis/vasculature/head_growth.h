#pragma once
#include <cstddef>
#include <functional>
#include <span>

#include "anthesis/geometry/vec.h"

namespace anthesis {

/// How the inside of a head grows: what the vein model needs to know of the model of growth (O24, G-model).
///
/// A head is a body of revolution about +z. Its half section is given frame by frame as points (distance from the axis,
/// height), all in one unit of length, in which the lengths of VeinParams are meant too.
struct HeadGrowth {
  std::size_t frames = 0;  ///< at least 2

  /// The outline of frame `frame`, apex first, rim of the base last; the base itself is level from the rim to the axis.
  /// At least two points, radii >= 0, some length. Stays valid while the growth lives.
  std::function<std::span<const Vec2>(std::size_t frame)> outline;

  /// Moves points of the half section with the tissue, from frame `from` to a later frame `to`. Points slightly outside
  /// are allowed. A point must move the same whatever other points there are; radii must stay >= 0.
  std::function<void(std::size_t from, std::size_t to, std::span<Vec2> points)> move;
};

}  // namespace anthesis
