#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <utility>
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

/// The same over given interior knots: ascending, inside (0, 1), none more than `degree` times. There are
/// inner_knots.size() + degree + 1 control points. At a knot, the piece after it. Precondition: the knots are so.
BasisFunctions clamped_basis(std::span<const double> inner_knots, int degree, double t);

/// Clamped B-spline curve through the plane or space, parametrised over [0, 1]. Control points may coincide.
///
/// A knot that is repeated `degree` times is a corner that the curve passes through: Bezier curves joined end to end
/// are a B-spline with such knots (bezier_chain).
template <class Point>
struct BSplineCurve {
  int degree = 3;
  std::vector<Point> controls;           ///< at least degree + 1
  std::vector<double> inner_knots = {};  ///< empty: equally spaced; else controls.size() - degree - 1, ascending

  BasisFunctions basis(double t) const {
    return inner_knots.empty() ? clamped_basis(static_cast<int>(controls.size()), degree, t)
                               : clamped_basis(inner_knots, degree, t);
  }

  Point at(double t) const {
    const BasisFunctions basis = this->basis(t);
    Point sum{};
    for (int i = 0; i < basis.count; ++i) {
      sum += basis.weight[i] * controls[basis.first + i];
    }
    return sum;
  }

  Point derivative(double t) const;  ///< with respect to t; at a corner, of the piece after it

  /// The parameters where the polynomial pieces meet, 0 and 1 included; each once.
  std::vector<double> knots() const;

  /// Control points of the polynomial pieces as Bezier curves, degree + 1 for each stretch between two of knots().
  std::vector<Point> bezier_controls() const;

 private:
  /// Knot i of the whole vector, its degree + 1 zeros in front and as many ones behind.
  double full_knot(int i) const {
    const int inner = i - degree - 1;
    const int count = static_cast<int>(controls.size()) - degree - 1;
    if (inner < 0) {
      return 0.0;
    }
    if (inner >= count) {
      return 1.0;
    }
    return inner_knots.empty() ? static_cast<double>(inner + 1) / (count + 1) : inner_knots[inner];
  }
};

/// Parameters where the pieces of a clamped uniform B-spline meet, 0 and 1 included.
std::vector<double> clamped_knots(int control_points, int degree);

/// Where each control point of a clamped uniform B-spline acts most: the means of its knots (Greville 1964). With these
/// as the abscissae of its control points the graph of a function is drawn at its own parameter, x(t) = t.
std::vector<double> greville_places(int control_points, int degree);

/// Control points of the clamped uniform B-spline that takes the given values at its Greville places. O(n^2).
/// Precondition: more values than `degree`, which is at least 1.
std::vector<Vec2> interpolating_controls(std::vector<Vec2> values, int degree);

/// Interior knots of `pieces` Bezier curves of one degree joined end to end, each over an equal share of [0, 1].
std::vector<double> bezier_chain_knots(int pieces, int degree);

/// Bezier curves of one degree joined end to end as one curve. The end of each is the start of the next and is given
/// once: pieces * degree + 1 control points. Precondition: there are so many, and at least one piece.
template <class Point>
BSplineCurve<Point> bezier_chain(std::vector<Point> controls, int degree) {
  ANTHESIS_ASSERT(degree >= 1 && controls.size() > 1 && (controls.size() - 1) % degree == 0);
  const int pieces = (static_cast<int>(controls.size()) - 1) / degree;
  return {degree, std::move(controls), bezier_chain_knots(pieces, degree)};
}

template <class Point>
std::vector<double> BSplineCurve<Point>::knots() const {
  std::vector<double> knots = clamped_knots(static_cast<int>(controls.size()), degree);
  if (!inner_knots.empty()) {
    std::copy(inner_knots.begin(), inner_knots.end(), knots.begin() + 1);
    knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  }
  return knots;
}

template <class Point>
std::vector<Point> BSplineCurve<Point>::bezier_controls() const {
  // The blossom of a piece at a mix of its two ends is a Bezier control point of it (Ramshaw 1987).
  std::vector<Point> result;
  std::array<Point, kMaxDegree + 1> d;
  for (int span = degree; span < static_cast<int>(controls.size()); ++span) {
    const double from = full_knot(span);
    const double to = full_knot(span + 1);
    if (!(from < to)) {
      continue;
    }
    for (int ends = 0; ends <= degree; ++ends) {  // how many of the arguments are `to`
      std::copy(controls.begin() + (span - degree), controls.begin() + (span + 1), d.begin());
      for (int r = 1; r <= degree; ++r) {
        const double x = r <= ends ? to : from;
        for (int i = degree; i >= r; --i) {
          const double left = full_knot(span - degree + i);
          const double right = full_knot(span + 1 + i - r);
          d[i] = ((right - x) / (right - left)) * d[i - 1] + ((x - left) / (right - left)) * d[i];
        }
      }
      result.push_back(d[degree]);
    }
  }
  return result;
}

template <class Point>
Point BSplineCurve<Point>::derivative(double t) const {
  // The derivative is a B-spline of one degree less; its control points are the differences of neighbours over the
  // knots that the difference spans. Those that are not zero at t come from the basis of the lower degree.
  const int n = static_cast<int>(controls.size());
  if (inner_knots.empty()) {
    const int pieces = n - degree;
    const auto knot = [&](int i) {  // with degree + 1 copies of 0 in front
      const int interior = i - degree;
      return interior <= 0 ? 0.0 : interior >= pieces ? 1.0 : static_cast<double>(interior) / pieces;
    };
    if (degree == 1) {
      const BasisFunctions ends = clamped_basis(n, 1, t);
      return static_cast<double>(pieces) * (controls[ends.first + 1] - controls[ends.first]);
    }
    const BasisFunctions lower = clamped_basis(n - 1, degree - 1, t);
    Point sum{};
    for (int i = 0; i < lower.count; ++i) {
      const int k = lower.first + i;
      sum += (lower.weight[i] * degree / (knot(k + degree + 1) - knot(k + 1))) * (controls[k + 1] - controls[k]);
    }
    return sum;
  }
  // With given knots a corner makes the lower spline discontinuous, which is no curve of this kind: de Boor's triangle
  // on the piece instead.
  const int span = basis(t).first + degree;
  t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
  std::array<Point, kMaxDegree + 1> d;
  for (int i = 1; i <= degree; ++i) {
    const int k = span - degree + i;
    d[i] = (degree / (full_knot(k + degree) - full_knot(k))) * (controls[k] - controls[k - 1]);
  }
  for (int r = 1; r < degree; ++r) {
    for (int i = degree; i > r; --i) {
      const double left = full_knot(span - degree + i);
      const double right = full_knot(span + i - r);
      d[i] = ((right - t) / (right - left)) * d[i - 1] + ((t - left) / (right - left)) * d[i];
    }
  }
  return d[degree];
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
