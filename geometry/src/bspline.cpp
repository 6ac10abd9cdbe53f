#include "anthesis/geometry/bspline.h"

#include <algorithm>
#include <cmath>

namespace anthesis {

std::vector<double> clamped_knots(int control_points, int degree) {
  const int pieces = control_points - degree;
  std::vector<double> knots(static_cast<std::size_t>(pieces) + 1);
  for (int i = 0; i <= pieces; ++i) {
    knots[i] = static_cast<double>(i) / pieces;
  }
  return knots;
}

BasisFunctions clamped_basis(int control_points, int degree, double t) {
  ANTHESIS_ASSERT(degree >= 1 && degree <= kMaxDegree && control_points > degree);
  const int pieces = control_points - degree;
  t = std::clamp(t, 0.0, 1.0);
  const int piece = std::min(static_cast<int>(t * pieces), pieces - 1);
  const double x = t * pieces;  // knots at the integers 0 .. pieces, clamped outside
  const auto knot = [&](int i) { return static_cast<double>(std::clamp(i, 0, pieces)); };

  BasisFunctions basis;
  basis.first = piece;
  basis.count = degree + 1;
  basis.weight[0] = 1.0;
  for (int d = 1; d <= degree; ++d) {
    double carried = 0.0;
    for (int r = 0; r < d; ++r) {
      const double right = knot(piece + r + 1) - x;
      const double left = x - knot(piece + 1 - d + r);
      const double share = basis.weight[r] / (right + left);
      basis.weight[r] = carried + right * share;
      carried = left * share;
    }
    basis.weight[d] = carried;
  }
  return basis;
}

BasisFunctions clamped_basis(std::span<const double> inner_knots, int degree, double t) {
  ANTHESIS_ASSERT(degree >= 1 && degree <= kMaxDegree);
  t = std::clamp(t, 0.0, 1.0);
  const int count = static_cast<int>(inner_knots.size());
  // Knots not above t; none of them is 1, so t = 1 belongs to the last piece.
  const int piece = static_cast<int>(std::upper_bound(inner_knots.begin(), inner_knots.end(), t) - inner_knots.begin());
  const auto knot = [&](int i) { return i < 0 ? 0.0 : i >= count ? 1.0 : inner_knots[i]; };

  BasisFunctions basis;
  basis.first = piece;
  basis.count = degree + 1;
  basis.weight[0] = 1.0;
  for (int d = 1; d <= degree; ++d) {
    double carried = 0.0;
    for (int r = 0; r < d; ++r) {
      const double right = knot(piece + r) - t;
      const double left = t - knot(piece - d + r);
      const double share = basis.weight[r] / (right + left);
      basis.weight[r] = carried + right * share;
      carried = left * share;
    }
    basis.weight[d] = carried;
  }
  return basis;
}

std::vector<double> bezier_chain_knots(int pieces, int degree) {
  std::vector<double> knots;
  for (int i = 1; i < pieces; ++i) {
    knots.insert(knots.end(), static_cast<std::size_t>(degree), static_cast<double>(i) / pieces);
  }
  return knots;
}

std::vector<double> greville_places(int control_points, int degree) {
  std::vector<double> places;
  const auto knot = [&](int i) { return std::clamp(i - degree, 0, control_points - degree); };
  for (int i = 0; i < control_points; ++i) {
    int sum = 0;
    for (int k = 1; k <= degree; ++k) {
      sum += knot(i + k);
    }
    places.push_back(static_cast<double>(sum) / (degree * (control_points - degree)));
  }
  return places;
}

std::vector<Vec2> interpolating_controls(std::vector<Vec2> values, int degree) {
  ANTHESIS_ASSERT(degree >= 1 && static_cast<int>(values.size()) > degree);
  // Gauss without pivoting: the matrix is totally positive. Its band is as wide as there are functions at a place.
  const int count = static_cast<int>(values.size());
  const std::vector<double> places = greville_places(count, degree);
  std::vector<std::vector<double>> rows(values.size(), std::vector<double>(values.size(), 0.0));
  for (int i = 0; i < count; ++i) {
    const BasisFunctions basis = clamped_basis(count, degree, places[i]);
    std::copy_n(basis.weight.begin(), basis.count, rows[i].begin() + basis.first);
  }
  for (int column = 0; column < count; ++column) {
    const int last = std::min(column + degree, count - 1);
    for (int row = column + 1; row <= last; ++row) {
      const double factor = rows[row][column] / rows[column][column];
      if (factor != 0.0) {
        for (int k = column; k <= last; ++k) {
          rows[row][k] -= factor * rows[column][k];
        }
        values[row] = values[row] - factor * values[column];
      }
    }
  }
  for (int row = count - 1; row >= 0; --row) {
    for (int k = row + 1; k <= std::min(row + degree, count - 1); ++k) {
      values[row] = values[row] - rows[row][k] * values[k];
    }
    values[row] = values[row] / rows[row][row];
  }
  return values;
}

}  // namespace anthesis
