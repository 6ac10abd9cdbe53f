#pragma once
#include <array>
#include <span>
#include <vector>

#include "anthesis/base/assert.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Highest degree of a curve or surface here. Degree n - 1 on n control points is a Bezier curve.
inline constexpr int kMaxDegree = 15;

/// The basis functions of a clamped uniform B-spline that are not zero at one parameter.
struct BasisFunctions {
  int first = 0;  ///< index of the control point that weight[0] belongs to
  int count = 0;  ///< degree + 1
  std::array<double, kMaxDegree + 1> weight{};
};

/// Basis at t in [0, 1] over `control_points` points; interior knots equally spaced, end knots repeated so that the
/// curve starts and ends at its first and last point. Weights are >= 0 and sum to 1. Cox and de Boor's recursion,
/// O(degree^2). Precondition: 1 <= degree <= kMaxDegree, control_points > degree.
BasisFunctions clamped_basis(int control_points, int degree, double t);

/// Clamped B-spline curve through the plane or space, parametrised over [0, 1]. Control points may coincide.
template <class Point>
struct BSplineCurve {
  int degree = 3;
  std::vector<Point> controls;  ///< at least degree + 1

  Point at(double t) const {
    const BasisFunctions basis = clamped_basis(static_cast<int>(controls.size()), degree, t);
    Point sum{};
    for (int i = 0; i < basis.count; ++i) {
      sum += basis.weight[i] * controls[basis.first + i];
    }
    return sum;
  }

  Point derivative(double t) const;  ///< with respect to t

  /// The parameters where the polynomial pieces meet, 0 and 1 included.
  std::vector<double> knots() const;
};

/// Parameters where the pieces of a clamped uniform B-spline meet, 0 and 1 included.
std::vector<double> clamped_knots(int control_points, int degree);

template <class Point>
std::vector<double> BSplineCurve<Point>::knots() const {
  return clamped_knots(static_cast<int>(controls.size()), degree);
}

template <class Point>
Point BSplineCurve<Point>::derivative(double t) const {
  // The derivative is a clamped B-spline of one degree less on the same interior knots; its control points are the
  // differences of neighbours over the knots that the difference spans.
  const int n = static_cast<int>(controls.size());
  const int pieces = n - degree;
  const auto knot = [&](int i) {  // with degree + 1 copies of 0 in front
    const int interior = i - degree;
    return interior <= 0 ? 0.0 : interior >= pieces ? 1.0 : static_cast<double>(interior) / pieces;
  };
  if (degree == 1) {
    const BasisFunctions ends = clamped_basis(n, 1, t);
    return static_cast<double>(pieces) * (controls[ends.first + 1] - controls[ends.first]);
  }
  const BasisFunctions basis = clamped_basis(n - 1, degree - 1, t);
  Point sum{};
  for (int i = 0; i < basis.count; ++i) {
    const int k = basis.first + i;
    sum += (basis.weight[i] * degree / (knot(k + degree + 1) - knot(k + 1))) * (controls[k + 1] - controls[k]);
  }
  return sum;
}

/// Point of the tensor-product surface of control points stored row after row (`across` points in each row, one row for
/// each step along): u runs across, v along; both in [0, 1].
template <class Point>
Point surface_at(std::span<const Point> controls, const BasisFunctions& u, const BasisFunctions& v, int across) {
  Point sum{};
  for (int j = 0; j < v.count; ++j) {
    const Point* row = controls.data() + static_cast<std::size_t>(v.first + j) * across + u.first;
    Point line{};
    for (int i = 0; i < u.count; ++i) {
      line += u.weight[i] * row[i];
    }
    sum += v.weight[j] * line;
  }
  return sum;
}

}  // namespace anthesis
