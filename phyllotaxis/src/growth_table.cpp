#include "growth_table.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"

namespace anthesis {

GrowthTable::GrowthTable(const GrowthFunction& growth) : growth_(growth) {
  if (growth.given_by_rate()) {
    return;
  }
  double largest = 0.0;
  const std::vector<double>& breaks = growth.breaks();
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    add(breaks[i], breaks[i + 1], largest, 0);
  }
}

void GrowthTable::add(double from, double to, double& largest, int depth) {
  constexpr int kDeepest = 40;
  const double half = 0.5 * (to - from);
  const double middle = 0.5 * (to + from);
  std::array<double, kNodes> value;
  for (int j = 0; j < kNodes; ++j) {
    value[j] = growth_(middle + half * math::cos(math::kPi * (j + 0.5) / kNodes));
    largest = std::max(largest, std::abs(value[j]));
  }
  Piece piece{from, to, {}};
  for (int k = 0; k < kNodes; ++k) {
    double sum = 0.0;
    for (int j = 0; j < kNodes; ++j) {
      sum += value[j] * math::cos(math::kPi * k * (j + 0.5) / kNodes);
    }
    piece.coefficient[k] = (k == 0 ? 1.0 : 2.0) * sum / kNodes;
  }
  const double tail = std::abs(piece.coefficient[kNodes - 1]) + std::abs(piece.coefficient[kNodes - 2]);
  if (tail > 1e-14 * largest && depth < kDeepest && half > 1e-13 * std::max(std::abs(from), std::abs(to))) {
    add(from, middle, largest, depth + 1);
    add(middle, to, largest, depth + 1);
    return;
  }
  pieces_.push_back(piece);
}

double GrowthTable::operator()(double x) const {
  if (pieces_.empty() || x <= pieces_.front().from || x >= pieces_.back().to) {
    return growth_(x);
  }
  const auto after =
      std::upper_bound(pieces_.begin(), pieces_.end(), x, [](double y, const Piece& piece) { return y < piece.from; });
  const Piece& piece = *(after - 1);
  const double local = (2.0 * x - piece.from - piece.to) / (piece.to - piece.from);
  double b1 = 0.0;  // Clenshaw's sum
  double b2 = 0.0;
  for (int k = kNodes - 1; k > 0; --k) {
    const double b0 = piece.coefficient[k] + 2.0 * local * b1 - b2;
    b2 = b1;
    b1 = b0;
  }
  return piece.coefficient[0] + local * b1 - b2;
}

}  // namespace anthesis
