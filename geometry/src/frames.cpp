#include "anthesis/geometry/frames.h"

namespace anthesis {

std::vector<Quaternion> rotation_minimising_frames(std::span<const Vec3> points, Vec3 reference) {
  std::vector<Quaternion> frames;
  if (points.size() < 2) {
    return frames;
  }
  Vec3 direction{0.0, 0.0, 1.0};
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {  // the first segment with a direction rules those before it
    const Vec3 step = points[i + 1] - points[i];
    if (length(step) > 0.0) {
      direction = normalized(step);
      break;
    }
  }
  Vec3 side = reference - dot(reference, direction) * direction;
  side = length(side) > 1e-9 * length(reference) ? normalized(side) : any_perpendicular(direction);
  Quaternion frame = rotation_from_axes(direction, side, cross(direction, side));
  frames.push_back(frame);
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vec3 step = points[i + 1] - points[i];
    if (length(step) > 0.0) {
      const Vec3 next = normalized(step);
      const Vec3 from = rotate(frame, {1.0, 0.0, 0.0});
      frame = normalized(rotation_between(from, next, rotate(frame, {0.0, 1.0, 0.0})) * frame);
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace anthesis
