#pragma once
#include <vector>

#include "anthesis/corolla/organ_shape.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Control points of a petal's clamped B-spline surface, row after row from base to tip. The first point of a row is
/// the petal's left margin (u = 0, towards +y), so that the surface's normal, du x dv, is on the upper (adaxial) side.
struct ControlMesh {
  int across = 0;  ///< points in a row (u)
  int along = 0;   ///< rows (v)
  std::vector<Vec3> points_mm;

  Vec3& at(int row, int column) { return points_mm[static_cast<std::size_t>(row) * across + column]; }
  const Vec3& at(int row, int column) const { return points_mm[static_cast<std::size_t>(row) * across + column]; }
};

/// What one individual adds to the form of its species; fixed numbers out of ShapeVariation's ranges.
struct ShapeDeviation {
  double curl_rad = 0.0;
  double twist_rad = 0.0;
  double sway_rad = 0.0;
  double width = 1.0;
};

/// The control mesh of a pose, for a petal at azimuth 0: its midrib in the plane y = 0 (without deviation), symmetric
/// about it unless the pose says otherwise. Deviations act in proportion to the pose's stage: buds are alike.
/// `degree_across` sets the number of points of a flat section. Precondition: check(OrganShape) finds nothing.
ControlMesh control_mesh(const PetalPose& pose, int degree_across, const ShapeDeviation& deviation = {});

/// The mirror image in the plane y = 0: its left margin is the image of the right one.
ControlMesh reflected(const ControlMesh& petal);

/// Moves the first `fused` boundary points of both margins into the planes of symmetry between the `count` petals of a
/// ring, at azimuths +pi/count and -pi/count, each at its own height and distance from the axis (O16 section 2).
void hold_in_symmetry_planes(ControlMesh& petal, int count, int fused);

/// Gives the right margin (u = 1) of `lateral` the first `fused` points of the left margin (u = 0) of `median`.
/// Precondition: equal numbers of rows.
void share_margin(ControlMesh& lateral, const ControlMesh& median, int fused);

/// The largest v up to which a margin depends on its first `fused` control points alone; negative if there is none.
double fused_until(int along, int degree_along, int fused);

}  // namespace anthesis
