#include "anthesis/render/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"
#include "view_axes.h"

namespace anthesis {

namespace {

constexpr double kFilm_mm = 36.0;

/// The eight greatest and least values that framing needs, in the camera's axes.
struct Extremes {
  double left = -std::numeric_limits<double>::infinity();
  double right = left;
  double bottom = left;
  double top = left;
  double nearest = left;
  double farthest = left;
  bool any = false;

  void include(double x, double y, double z, double slope_x, double slope_y) {
    right = std::max(right, x + slope_x * z);
    left = std::max(left, -x + slope_x * z);
    top = std::max(top, y + slope_y * z);
    bottom = std::max(bottom, -y + slope_y * z);
    nearest = std::max(nearest, z);
    farthest = std::max(farthest, -z);
    any = true;
  }
};

}  // namespace

ViewAxes axes_of(const View& view) {
  const auto [sin_azimuth, cos_azimuth] = math::sin_cos(view.azimuth_rad);
  const auto [sin_elevation, cos_elevation] = math::sin_cos(view.elevation_rad);
  ViewAxes axes;
  axes.back = {cos_elevation * cos_azimuth, cos_elevation * sin_azimuth, sin_elevation};
  axes.right = {-sin_azimuth, cos_azimuth, 0.0};
  axes.up = cross(axes.back, axes.right);
  return axes;
}

View View::top() {
  return {.azimuth_rad = -math::kPi / 2.0, .elevation_rad = math::kPi / 2.0};
}
View View::side() {
  return {.azimuth_rad = -math::kPi / 2.0, .elevation_rad = 0.0};
}
View View::front() {
  return {.azimuth_rad = -math::kPi / 2.0, .elevation_rad = math::radians(25.0)};
}
View View::three_quarter() {
  return {.azimuth_rad = math::radians(-60.0), .elevation_rad = math::radians(45.0)};
}
View View::bottom() {
  return {.azimuth_rad = -math::kPi / 2.0, .elevation_rad = -math::kPi / 2.0};
}

Expected<View> parse_view(std::string_view name) {
  constexpr std::string_view kNames[] = {"top", "side", "front", "three-quarter", "bottom"};
  constexpr View (*kViews[])() = {View::top, View::side, View::front, View::three_quarter, View::bottom};
  for (std::size_t i = 0; i < std::size(kNames); ++i) {
    if (name == kNames[i]) {
      return kViews[i]();
    }
  }
  std::string message = "must be top, side, front, three-quarter or bottom, got " + std::string(name.substr(0, 64));
  const std::string_view nearest = nearest_name(name, kNames, std::size(kNames));
  if (!nearest.empty()) {
    message += "; did you mean " + std::string(nearest) + "?";
  }
  return unexpected(Error{ErrorCode::kUnknownParameter, "view", message});
}

std::optional<Error> check(const View& view) {
  if (!std::isfinite(view.azimuth_rad) || std::abs(view.azimuth_rad) > 1e6) {
    return invalid_parameter("azimuth_rad", "must be finite and reasonable", view.azimuth_rad);
  }
  if (!(std::abs(view.elevation_rad) <= math::kPi / 2.0 + 1e-9)) {
    return invalid_parameter("elevation_rad", "must be from -pi/2 to pi/2", view.elevation_rad);
  }
  if (!(view.focal_length_mm >= 10.0 && view.focal_length_mm <= 1000.0)) {
    return invalid_parameter("focal_length_mm", "must be from 10 to 1000", view.focal_length_mm);
  }
  if (!(view.margin >= 0.0 && view.margin <= 0.45)) {
    return invalid_parameter("margin", "must be from 0 to 0.45", view.margin);
  }
  if (!(view.f_number == 0.0 || (view.f_number >= 0.5 && view.f_number <= 1000.0))) {
    return invalid_parameter("f_number", "must be 0 or from 0.5 to 1000", view.f_number);
  }
  return std::nullopt;
}

Vec3 Camera::project(Vec3 point_mm) const {
  const Vec3 p = point_mm - position_mm;
  const double distance = -dot(p, back);
  return {0.5 + 0.5 * dot(p, right) / (distance * tan_half_width),
          0.5 - 0.5 * dot(p, up) / (distance * tan_half_height), distance};
}

Camera frame(const Scene& scene, const View& view, double width, double height) {
  ANTHESIS_ASSERT(!check(view));
  ANTHESIS_ASSERT(width > 0.0 && height > 0.0);
  const ViewAxes axes = axes_of(view);
  Camera camera;
  camera.back = axes.back;
  camera.right = axes.right;
  camera.up = axes.up;
  const double tan_short = 0.5 * kFilm_mm / view.focal_length_mm;
  camera.tan_half_width = tan_short * std::max(1.0, width / height);
  camera.tan_half_height = tan_short * std::max(1.0, height / width);

  // A point is inside the picture when it is inside four planes through the camera. Seen along the axes of the camera
  // each plane's distance is fixed by one extreme point; the two of a pair place the camera sideways and tell how far
  // back it must stand.
  const double slope_x = camera.tan_half_width * (1.0 - 2.0 * view.margin);
  const double slope_y = camera.tan_half_height * (1.0 - 2.0 * view.margin);
  Extremes extremes;
  for (const Instance& instance : scene.instances) {
    if (!instance.framed) {
      continue;
    }
    const Placement& placement = instance.world_from_mesh;
    // The camera's axes in the mesh's own frame: one rotation for all vertices.
    const Quaternion mesh_from_world = conjugate(placement.rotation);
    const Vec3 x = placement.scale * rotate(mesh_from_world, camera.right);
    const Vec3 y = placement.scale * rotate(mesh_from_world, camera.up);
    const Vec3 z = placement.scale * rotate(mesh_from_world, camera.back);
    const Vec3 origin = {dot(placement.position_mm, camera.right), dot(placement.position_mm, camera.up),
                         dot(placement.position_mm, camera.back)};
    for (const Vec3& p : scene.meshes[instance.mesh].mesh.positions_mm) {
      extremes.include(origin.x + dot(p, x), origin.y + dot(p, y), origin.z + dot(p, z), slope_x, slope_y);
    }
  }
  if (!extremes.any) {
    for (int corner = 0; corner < 8; ++corner) {
      extremes.include(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0, slope_x, slope_y);
    }
  }
  const double centre_x = 0.5 * (extremes.right - extremes.left);
  const double centre_y = 0.5 * (extremes.top - extremes.bottom);
  double distance =
      std::max(0.5 * (extremes.right + extremes.left) / slope_x, 0.5 * (extremes.top + extremes.bottom) / slope_y);
  // Scenes flat towards the camera would put it on top of them.
  const double depth = extremes.nearest + extremes.farthest;
  distance = std::max(distance, extremes.nearest + 0.05 * depth + 1e-3);
  camera.position_mm = centre_x * camera.right + centre_y * camera.up + distance * camera.back;
  camera.focus_mm = distance - (extremes.nearest - 0.3 * depth);
  if (view.f_number > 0.0) {
    // Scaled as a close-up at life size on film: the same stop gives the same look whatever the plant's size.
    const double life_size = camera.focus_mm * 2.0 * tan_short / kFilm_mm;
    camera.lens_radius_mm = 0.5 * view.focal_length_mm / view.f_number * life_size * 0.25;
  }
  return camera;
}

Lighting studio_lighting(const Camera& camera) {
  const auto direction = [&](double right, double up, double back) {
    return normalized(right * camera.right + up * camera.up + back * camera.back);
  };
  Lighting lighting;
  lighting.lamps = {
      {.towards = direction(-0.62, 0.72, 0.55), .half_angle_rad = 0.14, .irradiance = {2.80, 2.66, 2.42}},
      {.towards = direction(0.55, 0.60, -0.62), .half_angle_rad = 0.20, .irradiance = {1.80, 1.75, 1.64}},
  };
  lighting.sky.up = direction(0.0, 0.90, 0.45);
  lighting.sky.zenith = {0.32, 0.34, 0.37};
  lighting.sky.horizon = {0.19, 0.20, 0.22};
  lighting.sky.nadir = {0.07, 0.07, 0.07};
  lighting.sky.glows = {{direction(-0.5, 0.4, 0.75), 2, {0.32, 0.31, 0.29}},
                        {direction(0.8, -0.1, 0.6), 2, {0.10, 0.11, 0.13}}};
  return lighting;
}

}  // namespace anthesis
