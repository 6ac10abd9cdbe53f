#pragma once
#include <span>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Frames along a polyline that turn as little as possible, one for each segment: the image of +x is the segment's
/// direction, the image of +y starts as near to `reference` as it can be.
///
/// O16's construction: from one segment to the next the frame turns about the axis perpendicular to both, by the angle
/// between them. On a polyline that is exactly rotation minimising; double reflection (Wang et al. 2008), the usual
/// choice on smooth curves, approximates the same thing from samples and would be undone by the blending of corners.
/// A segment of zero length keeps its predecessor's direction. A corner of 180 degrees turns about the frame's +y.
std::vector<Quaternion> rotation_minimising_frames(std::span<const Vec3> points, Vec3 reference);

}  // namespace anthesis
