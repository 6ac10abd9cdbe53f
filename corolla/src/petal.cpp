#include "anthesis/corolla/petal.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"

namespace anthesis {
namespace {

/// The directions of one row of control points.
struct RowFrame {
  Vec3 forward;
  Vec3 left;
  Vec3 up;
};

/// The section every row has when the pose gives none: flat, with just enough points for the degree.
std::vector<SectionPoint> flat_section(int degree_across) {
  const int half = (degree_across + 2) / 2 + 1;  // midrib and to one side: 2 * half - 1 > degree
  std::vector<SectionPoint> section;
  for (int i = 0; i < half; ++i) {
    section.push_back({static_cast<double>(i) / (half - 1), 0.0, 0.0});
  }
  return section;
}

}  // namespace

ControlMesh control_mesh(const PetalPose& pose, int degree_across, const ShapeDeviation& deviation) {
  const int rows = static_cast<int>(pose.midrib_mm.size());
  const std::vector<SectionPoint> flat = flat_section(degree_across);
  const auto section_of = [&](int row) -> const std::vector<SectionPoint>& {
    return pose.sections.empty() ? flat : pose.sections.size() == 1 ? pose.sections[0] : pose.sections[row];
  };

  // The midrib is walked segment by segment, so that bends add up along it.
  std::vector<Vec3> midrib(rows);
  std::vector<RowFrame> segments;
  midrib[0] = {pose.midrib_mm[0].x, 0.0, pose.midrib_mm[0].y};
  Vec2 heading{0.0, 1.0};
  for (int j = 0; j + 1 < rows; ++j) {
    const Vec2 step = pose.midrib_mm[j + 1] - pose.midrib_mm[j];
    if (length(step) > 0.0) {
      heading = normalized(step);
    }
    const double share = pose.stage * (j + 0.5) / (rows - 1);
    const auto [curl_sine, curl_cosine] = math::sin_cos(share * deviation.curl_rad);
    const auto [sway_sine, sway_cosine] = math::sin_cos(share * deviation.sway_rad);
    // Backwards is from the upper side towards the lower: clockwise in the (outward, up) plane.
    const Vec2 bent{curl_cosine * heading.x + curl_sine * heading.y, curl_cosine * heading.y - curl_sine * heading.x};
    const Vec3 straight{bent.x, 0.0, bent.y};
    const Vec3 sideways{0.0, 1.0, 0.0};
    RowFrame frame;
    frame.forward = sway_cosine * straight + sway_sine * sideways;
    frame.left = sway_cosine * sideways - sway_sine * straight;
    frame.up = cross(frame.forward, frame.left);
    segments.push_back(frame);
    midrib[j + 1] = midrib[j] + length(step) * frame.forward;
  }

  ControlMesh mesh;
  mesh.along = rows;
  mesh.across = 2 * static_cast<int>(section_of(0).size()) - 1;
  mesh.points_mm.resize(static_cast<std::size_t>(mesh.along) * mesh.across);
  for (int j = 0; j < rows; ++j) {
    const RowFrame& before = segments[std::max(j - 1, 0)];
    const RowFrame& after = segments[std::min(j, rows - 2)];
    Vec3 forward = normalized(before.forward + after.forward);
    if (forward == Vec3{}) {
      forward = after.forward;  // the midrib turns back on itself: the row belongs to what follows
    }
    Vec3 left = before.left + after.left;
    left = normalized(left - dot(left, forward) * forward);
    Vec3 up = cross(forward, left);
    if (deviation.twist_rad != 0.0) {
      const double angle = pose.stage * deviation.twist_rad * j / (rows - 1);
      const Quaternion twist = rotation_about(forward, angle);
      left = rotate(twist, left);
      up = rotate(twist, up);
    }
    const double half_width = pose.half_width_mm[j] * lerp(1.0, deviation.width, pose.stage);
    const double side = pose.side_mm.empty() ? 0.0 : pose.side_mm[j] * lerp(1.0, deviation.width, pose.stage);
    const Vec3 centre = midrib[j] + side * left;
    const std::vector<SectionPoint>& section = section_of(j);
    const int middle = static_cast<int>(section.size()) - 1;
    for (int k = 0; k <= middle; ++k) {
      const Vec3 lifted = centre + half_width * (section[k].up * up + section[k].forward * forward);
      const Vec3 aside = half_width * section[k].across * left;
      mesh.at(j, middle - k) = lifted + aside;
      mesh.at(j, middle + k) = lifted - aside;
    }
  }
  return mesh;
}

ControlMesh reflected(const ControlMesh& petal) {
  ControlMesh image = petal;
  for (int j = 0; j < petal.along; ++j) {
    for (int i = 0; i < petal.across; ++i) {
      const Vec3 p = petal.at(j, petal.across - 1 - i);
      image.at(j, i) = {p.x, -p.y, p.z};
    }
  }
  return image;
}

void hold_in_symmetry_planes(ControlMesh& petal, int count, int fused) {
  const auto [sine, cosine] = math::sin_cos(math::kPi / count);
  for (int j = 0; j < std::min(fused, petal.along); ++j) {
    Vec3& left = petal.at(j, 0);
    Vec3& right = petal.at(j, petal.across - 1);
    const double left_radius = length(Vec2{left.x, left.y});
    const double right_radius = length(Vec2{right.x, right.y});
    // Both margins meet the neighbour's other margin, so they must agree on distance and height; a petal that is not
    // symmetric meets itself half way.
    const double radius = 0.5 * (left_radius + right_radius);
    const double height = 0.5 * (left.z + right.z);
    left = {radius * cosine, radius * sine, height};
    right = {radius * cosine, -radius * sine, height};
  }
}

void share_margin(ControlMesh& lateral, const ControlMesh& median, int fused) {
  ANTHESIS_ASSERT(lateral.along == median.along);
  for (int j = 0; j < std::min(fused, lateral.along); ++j) {
    lateral.at(j, lateral.across - 1) = median.at(j, 0);
  }
}

double fused_until(int along, int degree_along, int fused) {
  if (fused >= along) {
    return 1.0;
  }
  const int pieces = along - degree_along;
  // Piece p depends on the points p .. p + degree; at its very end the first of them no longer counts.
  const int whole_pieces = fused - degree_along;
  if (whole_pieces <= 0) {
    return fused >= 1 ? 0.0 : -1.0;
  }
  return static_cast<double>(std::min(whole_pieces, pieces)) / pieces;
}

}  // namespace anthesis
