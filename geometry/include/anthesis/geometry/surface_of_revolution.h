#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "anthesis/base/error.h"
#include "anthesis/geometry/arc_length.h"
#include "anthesis/geometry/bspline.h"
#include "anthesis/geometry/cumulative_integral.h"

namespace anthesis {

/// A point of a surface with its directions: a right-handed orthonormal frame (meridian, parallel, normal).
struct SurfaceFrame {
  Vec3 position_mm;
  Vec3 meridian;  ///< along the generating curve, away from the apex
  Vec3 parallel;  ///< counter-clockwise about the axis, seen from +z
  Vec3 normal;    ///< outwards: +z at the apex of a dome
};

/// A surface made by turning a plane curve (radius, height) about the z axis: meristem, receptacle, cone (O16 fig. 10).
/// The curve runs from the apex (t = 0) to the base (t = 1); s in [0, 1] is the share of its arc length.
class SurfaceOfRevolution {
 public:
  /// Precondition: check_profile(controls) finds nothing and there are more controls than `degree`.
  SurfaceOfRevolution(std::vector<Vec2> controls_mm, int degree);

  /// A profile with knots of its own, such as a chain of Bezier curves (bezier_chain).
  /// Precondition: check_profile(profile_mm) finds nothing.
  explicit SurfaceOfRevolution(BSplineCurve<Vec2> profile_mm);

  const BSplineCurve<Vec2>& profile_mm() const { return profile_; }
  double length_mm() const { return length_.total_mm(); }
  double area_mm2() const { return area_.total(); }

  double t_from_s(double s) const { return length_.t_from_s(s); }
  double s_from_t(double t) const { return length_.s_from_t(t); }

  /// Area between the apex and t, relative error below 1e-12 of the total, and its inverse.
  double area_from_apex_mm2(double t) const { return area_.at(t); }
  double t_from_area_mm2(double area_mm2) const { return area_.inverse(area_mm2); }

  double radius_mm(double t) const { return profile_.at(t).x; }
  SurfaceFrame frame(double t, double azimuth_rad) const;

  /// Length of the generating curve's derivative at t: ds/dt in millimetres.
  double speed_mm(double t) const;

 private:
  BSplineCurve<Vec2> profile_;
  ArcLength length_;
  CumulativeIntegral area_;
};

/// At least two finite points with radius >= 0, not all on the axis and not all equal.
std::optional<Error> check_profile(std::string_view where, std::span<const Vec2> controls_mm);

/// The same, and 1 <= degree <= kMaxDegree with more controls than that; interior knots none, or as many as the
/// controls ask for, ascending inside (0, 1), none more than `degree` times.
std::optional<Error> check_profile(std::string_view where, const BSplineCurve<Vec2>& profile_mm);

}  // namespace anthesis
