#pragma once
#include <cstddef>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis {

/// A quantity over the development of a head, from 0 to 1: the broken line through points (time, value) of ascending
/// time. Two points at one time are a step, which belongs to what follows it. Outside the points the nearest value.
struct TimeCourse {
  std::vector<Vec2> points = {{0.0, 0.0}};  ///< at least one

  double at(double time) const {
    if (time < points.front().x) {
      return points.front().y;
    }
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (time < points[i].x) {
        const Vec2 a = points[i - 1];
        const Vec2 b = points[i];
        return a.y + (b.y - a.y) * ((time - a.x) / (b.x - a.x));
      }
    }
    return points.back().y;
  }
};

}  // namespace anthesis
