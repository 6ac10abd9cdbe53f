#pragma once
#include "anthesis/geometry/vec.h"
#include "anthesis/render/camera.h"

namespace anthesis {

/// The directions of the camera of a view, unit.
struct ViewAxes {
  Vec3 right;
  Vec3 up;
  Vec3 back;  ///< from the scene to the camera
};

ViewAxes axes_of(const View& view);

}  // namespace anthesis
