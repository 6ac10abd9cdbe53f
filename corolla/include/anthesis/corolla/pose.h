#pragma once
#include <span>
#include <vector>

#include "anthesis/corolla/petal.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// A polyline by its own measures: where it starts and heads, how long its segments are, how each turns from the last.
struct IntrinsicPolyline {
  Vec3 base_mm;
  Quaternion heading;              ///< frame of the first segment, see geometry/frames.h
  std::vector<double> lengths_mm;  ///< one for each segment
  std::vector<Quaternion> turns;   ///< from each segment to the next, in the frame of the former
};

IntrinsicPolyline to_intrinsic(std::span<const Vec3> points_mm);
void from_intrinsic(const IntrinsicPolyline& polyline, std::span<Vec3> points_mm);

/// O16 section 2, after Sederberg et al. 1993: lengths linearly, rotations spherically, the base linearly.
/// Every segment of the blend has exactly the interpolated length. Equal numbers of segments; share in [0, 1].
IntrinsicPolyline blend(const IntrinsicPolyline& a, const IntrinsicPolyline& b, double share);

/// The key poses of a petal, blended along the polylines of control points that run from base to tip.
class PoseBlend {
 public:
  /// Precondition: at least one mesh, equal topology, stages ascending in [0, 1].
  PoseBlend(std::vector<double> stages, std::vector<ControlMesh> meshes);

  int across() const { return meshes_.front().across; }
  int along() const { return meshes_.front().along; }

  /// The control mesh at `stage`; a pose exactly at its own stage, the nearest pose before the first and after the
  /// last.
  ///
  /// Columns blended one by one need not meet again in the tip of a pointed petal. Where all poses are pointed, each
  /// column's small miss against the middle one is spread over its length, so that the margins do not cross at the tip.
  ControlMesh at(double stage) const;

 private:
  std::vector<double> stages_;
  std::vector<ControlMesh> meshes_;
  std::vector<std::vector<IntrinsicPolyline>> columns_;  ///< by pose, by column
  bool pointed_ = true;                                  ///< the last row is one point in every pose
};

}  // namespace anthesis
