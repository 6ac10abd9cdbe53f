#pragma once
#include <array>
#include <functional>
#include <span>
#include <vector>

namespace anthesis {

/// The integral of a non-negative function f from the left end of an interval, as a function that can be evaluated and
/// inverted in well under a microsecond: arc length, area and number of organs along a curve all have this form.
///
/// f is approximated by Chebyshev polynomials of degree 12 on pieces that are halved until the last coefficients fall
/// below `tolerance` of the largest value of f; they are integrated exactly. The integral over any stretch h then errs
/// by at most about tolerance * max f * h, plus rounding of the total. See docs/geometry.md.
class CumulativeIntegral {
 public:
  CumulativeIntegral() = default;

  /// `breaks`: ascending, at least two; f must be smooth between neighbours. Pieces are no longer halved after 40
  /// times, so that an f with a corner inside a piece is still integrated, to the tolerance for all practical purposes.
  CumulativeIntegral(const std::function<double(double)>& f, std::span<const double> breaks, double tolerance = 1e-14);

  double total() const { return pieces_.empty() ? 0.0 : pieces_.back().before + pieces_.back().amount; }
  double first() const { return pieces_.front().from; }
  double last() const { return pieces_.back().to; }

  /// Integral from first() to x; x is clamped to the interval.
  double at(double x) const;

  /// The x where the integral reaches `amount`, clamped to the interval.
  double inverse(double amount) const;

 private:
  static constexpr int kDegree = 12;
  struct Piece {
    double from = 0.0;
    double to = 0.0;
    double before = 0.0;                         ///< integral up to `from`
    double amount = 0.0;                         ///< integral over the piece
    std::array<double, kDegree + 1> density{};   ///< Chebyshev coefficients of f over [-1, 1]
    std::array<double, kDegree + 2> integral{};  ///< of its integral from -1, scaled to the piece
  };
  void add(const std::function<double(double)>& f, double from, double to, double tolerance, double& largest,
           int depth);

  std::vector<Piece> pieces_;
};

}  // namespace anthesis
