#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "anthesis/geometry/vec.h"

namespace anthesis::detail {

/// Whole steps along the two vectors of a lattice, or counts of such.
struct Steps {
  std::int32_t a = 0;
  std::int32_t b = 0;
  friend constexpr Steps operator+(Steps x, Steps y) { return {x.a + y.a, x.b + y.b}; }
  friend constexpr Steps operator-(Steps x, Steps y) { return {x.a - y.a, x.b - y.b}; }
  friend constexpr auto operator<=>(Steps, Steps) = default;
};

/// A lattice of the plane by its two shortest vectors, |a| <= |b|, the angle between them in [60, 120] degrees.
struct Lattice {
  Vec2 a;
  Vec2 b;

  /// `v` in steps, not rounded.
  Vec2 coordinates(Vec2 v) const {
    const double area = cross(a, b);
    return {cross(v, b) / area, cross(a, v) / area};
  }
  Steps nearest(Vec2 v) const;
};

/// The two shortest vectors of the lattice of `a` and `b` (Lagrange and Gauss). Both turned towards +y.
Lattice reduced(Vec2 a, Vec2 b);

/// 1 - 6 (mean squared distance of the coordinates from whole numbers), each coordinate squared apart: 1 if all `sides`
/// are vectors of the lattice, about 0 if they have nothing to do with it.
double agreement(const Lattice& lattice, std::span<const Vec2> sides);

/// The lattice that most of `sides` are vectors of: the best of `trials` (two sides of a triangle each, those that
/// span an area far from `area` left out), then least squares. Returns a lattice with a = b = 0 if no trial is left.
Lattice fit_lattice(std::span<const Vec2> sides, std::span<const std::array<Vec2, 2>> trials, double area);

}  // namespace anthesis::detail
