#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "anthesis/geometry/vec.h"
#include "anthesis/vasculature/head_growth.h"

namespace anthesis {

/// The outline of a growing half section, sampled frame by frame at the same material points.
struct OutlineSequence {
  std::size_t points_per_frame = 0;
  std::vector<Vec2> points;  ///< (radius, height), frame after frame, apex first, rim of the base last

  std::size_t frames() const { return points_per_frame == 0 ? 0 : points.size() / points_per_frame; }
  std::span<const Vec2> frame(std::size_t i) const {
    return std::span(points).subspan(i * points_per_frame, points_per_frame);
  }
};

/// Growth whose displacement is the mean value interpolation (Floater 2003, Hormann and Floater 2006) of the outline's
/// own displacement, over the section closed by its base and mirrored at the axis. See docs/vasculature.md.
///
/// Linear along the outline, so that what lies on it stays on it. A move over several frames takes the coordinates of
/// its first frame. About 1 microsecond a point and 160 edges; parallel; the same bits for any number of threads.
/// Precondition: at least 2 frames of at least 2 points, finite, the apex on the axis.
HeadGrowth mean_value_growth(OutlineSequence outlines);

}  // namespace anthesis
