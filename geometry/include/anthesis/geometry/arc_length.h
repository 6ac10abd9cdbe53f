#pragma once
#include "anthesis/geometry/bspline.h"
#include "anthesis/geometry/cumulative_integral.h"

namespace anthesis {

/// Arc length along a curve, both ways. The length of any stretch errs by less than 1e-12 of the whole; see
/// docs/geometry.md. Built once in some ten microseconds a knot span, then 0.1 microseconds a question.
class ArcLength {
 public:
  ArcLength() = default;

  template <class Point>
  explicit ArcLength(const BSplineCurve<Point>& curve)
      : length_([&](double t) { return length(curve.derivative(t)); }, curve.knots()) {}

  double total_mm() const { return length_.total(); }
  double length_at_mm(double t) const { return length_.at(t); }                  ///< from t = 0
  double t_at_mm(double length_mm) const { return length_.inverse(length_mm); }  ///< clamped to the curve

  /// The same as a share of the whole, in [0, 1].
  double s_from_t(double t) const { return length_.at(t) / length_.total(); }
  double t_from_s(double s) const { return length_.inverse(s * length_.total()); }

 private:
  CumulativeIntegral length_;
};

}  // namespace anthesis
