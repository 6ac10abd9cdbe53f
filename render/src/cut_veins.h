#pragma once
#include <limits>

#include "anthesis/geometry/vec.h"
#include "anthesis/vasculature/vasculature.h"

namespace anthesis {

/// The points beyond a plane are those with dot(normal, point) > distance.
struct CutPlane {
  Vec3 normal;  ///< unit
  double distance = 0.0;
};

struct VeinCutParams {
  double radius_factor = 1.0;                                      ///< of half the diameter, as of the tubes
  double most_reach_mm = std::numeric_limits<double>::infinity();  ///< a strand's radius counts as this at most
};

/// Takes away what is beyond the plane: strands are cut where their centre lines pass through it, with a vertex there.
///
/// A strand that comes out of the plane by less than its radius and goes back, or ends there, is not cut but laid into
/// the plane. What is cut off and nowhere lies deeper than its radius, or is not longer than six times as wide, is left
/// out: such pieces look like chips. So a strand along the plane is whole or absent, and no vertex is left beyond.
/// `primordia`, `ring_vertices` and attraction points of the result are empty. O(vertices).
Vasculature cut(const Vasculature& veins, const CutPlane& plane, const VeinCutParams& params = {});

}  // namespace anthesis
