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

/// Outlines at `wanted` times out of outlines at `times` (ascending, one for each frame), linear between two frames.
/// Precondition: times.size() == outlines.frames(), at least 1.
OutlineSequence outlines_at(const OutlineSequence& outlines, std::span<const double> times,
                            std::span<const double> wanted);

/// Which outline frame f of the vein model sees, where primordia are born at frame = step of the model of phyllotaxis.
enum class FrameClock {
  kAsPublished,  ///< outline f of the sequence, whatever its time: the two models' clocks differ
  kConsistent,   ///< the outline of the time of step f, at which the primordia of frame f were placed
};

/// The outlines that the frames of the vein model see: as many as given. `step` is the time of one step.
OutlineSequence outlines_of_frames(OutlineSequence outlines, std::span<const double> times, FrameClock clock,
                                   double step = 0.0005);

}  // namespace anthesis
