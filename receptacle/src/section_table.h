#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "anthesis/geometry/bspline.h"
#include "anthesis/receptacle/growing_receptacle.h"

namespace anthesis::detail {

/// Nodes and weights of Gauss and Legendre on [-1, 1], and the way from values at the nodes to Legendre coefficients.
struct GaussTable {
  static constexpr std::size_t kNodes = 10;
  std::array<double, kNodes> node{};
  std::array<double, kNodes> weight{};
  std::array<std::array<double, kNodes>, kNodes> legendre{};  ///< [m][j]: share of value j in coefficient m
};
const GaussTable& gauss_table();

/// All sections as polynomials in s over common intervals: a blend of sections is then a blend of coefficients.
struct SectionTable {
  std::size_t sections = 0;
  std::size_t terms = 0;            ///< coefficients of a polynomial: 2 for chords
  std::vector<double> breaks;       ///< in s, 0 to 1; one more than intervals
  std::vector<std::size_t> coarse;  ///< the interval that s = i / coarse.size() lies in, to begin the search at
  std::vector<double> x;            ///< Chebyshev coefficients [section][interval][term]
  std::vector<double> y;

  /// Pieces of the length of a blend: sum over i of |sum over k of B_k (dx, dy)[k][i]|.
  std::size_t pieces = 0;
  std::vector<double> dx;
  std::vector<double> dy;

  std::size_t intervals() const { return breaks.size() - 1; }
  std::size_t interval_of(double s) const;

  /// Place within an interval, -1 to 1.
  double local(std::size_t interval, double s) const {
    return (2.0 * s - breaks[interval] - breaks[interval + 1]) / (breaks[interval + 1] - breaks[interval]);
  }

  Vec2 blend(const BasisFunctions& weights, double s) const;
  double length(const BasisFunctions& weights) const;
};

SectionTable make_section_table(std::span<const DigitisedSection> sections, double scale, SectionLookup lookup);

}  // namespace anthesis::detail
