#include "anthesis/geometry/cumulative_integral.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"

namespace anthesis {
namespace {

/// Sum of c[k] T_k(x) by Clenshaw's recurrence.
template <std::size_t N>
double chebyshev_sum(const std::array<double, N>& c, double x) {
  double b1 = 0.0;
  double b2 = 0.0;
  for (std::size_t k = N - 1; k > 0; --k) {
    const double b0 = c[k] + 2.0 * x * b1 - b2;
    b2 = b1;
    b1 = b0;
  }
  return c[0] + x * b1 - b2;
}

template <int N>
struct ChebyshevTable {
  std::array<double, N> node{};                   ///< zeros of T_N
  std::array<std::array<double, N>, N> cosine{};  ///< T_k at node j
  ChebyshevTable() {
    for (int j = 0; j < N; ++j) {
      for (int k = 0; k < N; ++k) {
        cosine[k][j] = math::cos(math::kPi * k * (j + 0.5) / N);
      }
      node[j] = cosine[1][j];
    }
  }
};

}  // namespace

CumulativeIntegral::CumulativeIntegral(const std::function<double(double)>& f, std::span<const double> breaks,
                                       double tolerance) {
  ANTHESIS_ASSERT(breaks.size() >= 2);
  double largest = 0.0;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    add(f, breaks[i], breaks[i + 1], tolerance, largest, 0);
  }
}

void CumulativeIntegral::add(const std::function<double(double)>& f, double from, double to, double tolerance,
                             double& largest, int depth) {
  constexpr int kNodes = kDegree + 1;
  constexpr int kDeepest = 40;
  static const ChebyshevTable<kNodes> table;
  const double half = 0.5 * (to - from);
  const double middle = 0.5 * (to + from);
  std::array<double, kNodes> value;
  for (int j = 0; j < kNodes; ++j) {
    value[j] = f(middle + half * table.node[j]);
    largest = std::max(largest, std::abs(value[j]));
  }
  Piece piece;
  piece.from = from;
  piece.to = to;
  for (int k = 0; k < kNodes; ++k) {
    double sum = 0.0;
    for (int j = 0; j < kNodes; ++j) {
      sum += value[j] * table.cosine[k][j];
    }
    piece.density[k] = (k == 0 ? 1.0 : 2.0) * sum / kNodes;
  }
  const double tail = std::abs(piece.density[kDegree]) + std::abs(piece.density[kDegree - 1]);
  // A short piece may be coarser: what counts is its error against the whole.
  if (tail > tolerance * largest && depth < kDeepest && half > 1e-13 * std::max(std::abs(from), std::abs(to))) {
    add(f, from, middle, tolerance, largest, depth + 1);
    add(f, middle, to, tolerance, largest, depth + 1);
    return;
  }
  // Integral of T_k is (T_{k+1}/(k+1) - T_{k-1}/(k-1)) / 2.
  for (int k = 1; k <= kDegree + 1; ++k) {
    const double lower = k == 1 ? 2.0 * piece.density[0] : piece.density[k - 1];
    const double upper = k + 1 <= kDegree ? piece.density[k + 1] : 0.0;
    piece.integral[k] = half * (lower - upper) / (2.0 * k);
  }
  piece.integral[0] = 0.0;
  piece.integral[0] = -chebyshev_sum(piece.integral, -1.0);
  piece.amount = chebyshev_sum(piece.integral, 1.0);
  piece.before = total();
  pieces_.push_back(piece);
}

double CumulativeIntegral::at(double x) const {
  const auto after =
      std::upper_bound(pieces_.begin(), pieces_.end(), x, [](double y, const Piece& p) { return y < p.from; });
  const Piece& piece = after == pieces_.begin() ? pieces_.front() : *(after - 1);
  const double local = std::clamp((2.0 * x - piece.from - piece.to) / (piece.to - piece.from), -1.0, 1.0);
  return piece.before + chebyshev_sum(piece.integral, local);
}

double CumulativeIntegral::inverse(double amount) const {
  const auto after =
      std::upper_bound(pieces_.begin(), pieces_.end(), amount, [](double a, const Piece& p) { return a < p.before; });
  const Piece& piece = after == pieces_.begin() ? pieces_.front() : *(after - 1);
  const double target = amount - piece.before;
  if (target <= 0.0) {
    return piece.from;
  }
  if (target >= piece.amount) {
    return piece.to;
  }
  const double half = 0.5 * (piece.to - piece.from);
  double low = -1.0;
  double high = 1.0;
  double x = 2.0 * target / piece.amount - 1.0;
  for (int step = 0; step < 100; ++step) {  // Newton inside a bracket; halving where Newton leaves it
    // Both series in one loop: each waits for its own last term, so two cost little more than one.
    double integral1 = piece.integral[kDegree + 1];
    double integral2 = 0.0;
    double density1 = 0.0;
    double density2 = 0.0;
    for (int k = kDegree; k > 0; --k) {
      const double integral0 = piece.integral[k] + 2.0 * x * integral1 - integral2;
      const double density0 = piece.density[k] + 2.0 * x * density1 - density2;
      integral2 = integral1;
      integral1 = integral0;
      density2 = density1;
      density1 = density0;
    }
    const double excess = piece.integral[0] + x * integral1 - integral2 - target;
    const double slope = half * (piece.density[0] + x * density1 - density2);
    (excess < 0.0 ? low : high) = x;
    double next = slope > 0.0 ? x - excess / slope : low;
    const bool newton = next > low && next < high;
    if (!newton) {
      next = 0.5 * (low + high);
    }
    const double moved = std::abs(next - x);
    x = next;
    // Newton's error is about the square of its last step, so a step of 1e-9 has arrived.
    if (moved <= (newton ? 1e-9 : 1e-15)) {
      break;
    }
  }
  return std::clamp(0.5 * (piece.from + piece.to) + half * x, piece.from, piece.to);
}

}  // namespace anthesis
