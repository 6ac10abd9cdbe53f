#pragma once
#include <optional>
#include <string_view>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/render/scene.h"

namespace anthesis {

/// From where to look. The camera's distance and aim follow from the scene.
struct View {
  double azimuth_rad = 0.0;       ///< of the camera about +z, from +x
  double elevation_rad = 0.0;     ///< of the camera above the level, [-pi/2, pi/2]
  double focal_length_mm = 70.0;  ///< on film 36 mm high or wide, whichever side is shorter; [10, 1000]
  double margin = 0.06;           ///< empty share of the picture at each edge, [0, 0.45]
  double f_number = 0.0;          ///< 0: all is sharp; else the lens's stop, for a scene one film high: blur with depth

  static View top();            ///< straight down; +y is up in the picture
  static View side();           ///< level
  static View front();          ///< 25 degrees above the level
  static View three_quarter();  ///< 45 degrees above the level
  static View bottom();         ///< straight up, from below; -y is up in the picture, +x to the right as from the top
};

/// "top", "side", "front", "three-quarter" or "bottom"; any other name is kUnknownParameter with the nearest.
Expected<View> parse_view(std::string_view name);

/// What is wrong with `view`, if anything.
std::optional<Error> check(const View& view);

/// A pinhole or thin lens somewhere in the world.
struct Camera {
  Vec3 position_mm;
  Vec3 right = {1, 0, 0};  ///< unit, as are the next two
  Vec3 up = {0, 1, 0};
  Vec3 back = {0, 0, 1};        ///< from the scene to the camera
  double tan_half_width = 0.3;  ///< tangent of half the angle of view across
  double tan_half_height = 0.3;
  double focus_mm = 100.0;      ///< distance of the sharp plane along the axis
  double lens_radius_mm = 0.0;  ///< 0: all is sharp

  /// Where a point shows: x and y in [0, 1] across and down the picture, z the distance along the axis.
  Vec3 project(Vec3 point_mm) const;
};

/// The nearest camera in the direction of `view` that holds every vertex of every framed instance of `scene` inside the
/// margins. Exact: the bounding box of what is seen touches two opposite margins. O(instances * vertices). A scene with
/// nothing framed is looked at as if it were a ball of radius 1.
///
/// Preconditions: check(view) and check(scene) find nothing (asserted), width and height > 0.
Camera frame(const Scene& scene, const View& view, double width, double height);

/// Light for a portrait, set up about the camera: a soft warm key from the upper left, a cool wide sky as fill, and a
/// back light from the right that shines through petals.
Lighting studio_lighting(const Camera& camera);

}  // namespace anthesis
