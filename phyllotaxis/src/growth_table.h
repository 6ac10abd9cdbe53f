#pragma once
#include <array>
#include <vector>

#include "anthesis/phyllotaxis/growth.h"

namespace anthesis {

/// A growth function for many evaluations: a factor's graph is replaced by Chebyshev polynomials of degree 12 on pieces
/// that are halved until their last coefficients fall below 1e-14 of its largest value. 20 nanoseconds in place of one
/// or two microseconds; a growth function given by its rate is quick enough as it is.
class GrowthTable {
 public:
  explicit GrowthTable(const GrowthFunction& growth);

  double operator()(double x) const;

 private:
  static constexpr int kNodes = 13;
  struct Piece {
    double from = 0.0;
    double to = 0.0;
    std::array<double, kNodes> coefficient{};
  };
  void add(double from, double to, double& largest, int depth);

  const GrowthFunction& growth_;
  std::vector<Piece> pieces_;  ///< empty for a rate
};

}  // namespace anthesis
