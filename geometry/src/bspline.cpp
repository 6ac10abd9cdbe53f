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

}  // namespace anthesis
