#pragma once
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/bspline.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// A function drawn as a curve: y over x along a clamped B-spline of degree 3 (less with fewer than four points) whose
/// control points have ascending x. It passes through the first and the last point and stays within the range of the
/// points' y. O16 calls these graphically defined functions.
class FunctionGraph {
 public:
  FunctionGraph() : FunctionGraph(std::vector<Vec2>{{0.0, 0.0}, {1.0, 0.0}}) {}

  /// Precondition: check(points) finds nothing.
  explicit FunctionGraph(std::vector<Vec2> points);

  double first() const { return curve_.controls.front().x; }
  double last() const { return curve_.controls.back().x; }

  /// Value at x; outside [first(), last()] the value at the nearer end. Error below 1e-14 of the x range.
  double operator()(double x) const;

  /// Where the polynomial pieces meet, first() and last() included; ascending.
  const std::vector<double>& breaks() const { return breaks_; }

 private:
  BSplineCurve<Vec2> curve_;
  std::vector<double> breaks_;
};

/// At least two points, finite, x ascending and not all equal.
std::optional<Error> check_function(std::string_view where, std::span<const Vec2> points);

/// The same, with all values within [low, high].
std::optional<Error> check_function_values(std::string_view where, std::span<const Vec2> points, double low,
                                           double high);

}  // namespace anthesis
