#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/phyllotaxis/vogel.h"

// Regular lattices on a cylinder (van Iterson 1907). See docs/van-iterson.md.
//
// The cylinder is unrolled and all lengths are shares of its circumference: organ k stands at (k * divergence / turn,
// k * rise). With jugacy J each level carries a whorl of J organs, a J-th of a turn apart.

namespace anthesis {

struct CylinderLattice {
  double divergence_rad = kGoldenAngleRad;  ///< finite
  double rise = 0.05;                       ///< from one level to the next, in [1e-9, 1e6]
  int jugacy = 1;                           ///< organs at each level, in [1, 1000]
};

std::optional<Error> check(const CylinderLattice& lattice);

/// Spirals that join each organ to the one `count` later (a whorl's organs are counted one by one).
struct LatticeFamily {
  int count = 0;          ///< number of these spirals on the cylinder; 0: the ring around it
  double offset = 0.0;    ///< sideways step to the next organ of a spiral, counter-clockwise > 0
  double distance = 0.0;  ///< length of that step
};

/// The three shortest steps of a lattice, shortest first; steps equal within 1e-12 by ascending count. Touching circles
/// on the lattice have the first distance as their diameter, and the first two families are the contact parastichies.
struct ContactParastichies {
  std::array<LatticeFamily, 3> families;

  /// Counts of the first two, ascending: (5, 8).
  std::array<int, 2> pair() const;
  /// The first two run in opposite directions; a vertical one counts as opposed.
  bool opposed() const { return families[0].offset * families[1].offset <= 0.0; }
};

/// By Gauss's reduction, O(log(1 / rise)). Precondition: check(lattice) finds nothing.
ContactParastichies contact_parastichies(const CylinderLattice& lattice);

/// numerator / denominator in lowest terms, denominator > 0
struct Fraction {
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;

  double value() const { return static_cast<double>(numerator) / static_cast<double>(denominator); }
  friend bool operator==(Fraction, Fraction) = default;
};

/// A lattice in which the families m and n touch: van Iterson's diagram consists of these.
struct TouchingLattice {
  double divergence_rad = 0.0;  ///< in [0, pi] over the jugacy; the mirror image has the opposite sign
  double rise = 0.0;
  double radius = 0.0;   ///< of the touching circles
  bool opposed = false;  ///< m and n run in opposite directions
};

/// A hexagonal lattice, where the families m, n and m + n touch: one arc ends here and two begin.
struct HexagonalLattice {
  Fraction divergence_turns;  ///< exactly; in [0, 1/2] over the jugacy
  std::int64_t norm = 1;      ///< m^2 + m n + n^2: the rise is sqrt(3) / (2 norm), the radius 1 / (2 sqrt(norm))
};

/// The pair of parastichy numbers must have no greater common divisor than the jugacy it is divided by here: 1 <= m <=
/// n
/// <= 10,000, coprime, else kInvalidParameter.
std::optional<Error> check_parastichy_pair(int m, int n);

// The functions below take a coprime pair. A lattice of jugacy J with the pair (J m, J n) is the same one over J:
// divergence, rise and radius divided by J.

/// The fractions p/m and q/n of a turn between which the families m and n are opposed, lower first. They are neighbours
/// in a Farey sequence; for (1, 1) they are 0/1 and 1/1. Precondition of this and what follows: check_parastichy_pair.
std::array<Fraction, 2> opposed_interval(int m, int n);

/// Where m, n and m + n touch: the narrow end of the arc (m, n).
HexagonalLattice hexagonal_lattice(int m, int n);

/// Radii over which circles on a lattice touch along m and n and along no other family, ends (hexagonal) included:
/// narrow 1 / (2 sqrt(m^2 + m n + n^2)), wide 1 / (2 sqrt(m^2 - m n + n^2)).
std::array<double, 2> touching_radii(int m, int n);

/// In closed form. Radii are held to touching_radii(m, n).
TouchingLattice touching_lattice(int m, int n, double radius);

/// One arc of van Iterson's diagram, from its wide to its narrow end.
struct LatticeArc {
  int m = 1;
  int n = 1;
  std::vector<TouchingLattice> points;
  std::size_t first_opposed = 0;  ///< points from here on are opposed; an exact border is among the points
};

struct DiagramParams {
  double least_radius = 0.02;    ///< in [0.001, 0.5]: arcs are cut off here
  std::size_t arc_samples = 33;  ///< points of a whole arc, in [2, 1000]
};
std::optional<Error> check(const DiagramParams& params);

/// All arcs from (1, 1) down by bifurcation, (m, n) followed by (n, m + n) and (m, m + n), generation by generation.
/// Number of arcs about 0.09 / least_radius^2. Errors: those of check.
Expected<std::vector<LatticeArc>> van_iterson_diagram(const DiagramParams& params);

/// The branch that (1, 1), (1, 2), (2, 3), (3, 5)... form, and the lattice on it: what stays if the circles shrink and
/// no bifurcation is ever taken to a pair that is not opposed. Radius in [1e-4, 1/2].
struct FibonacciLattice {
  int m = 1;
  int n = 1;
  TouchingLattice lattice;
};
FibonacciLattice fibonacci_lattice(double radius);

/// What an arrangement of organs, given one by one in order of birth, shows to somebody who counts.
struct PatternMeasure {
  double divergence_rad = 0.0;  ///< circular mean of steps from organ to organ, in [0, 2 pi)
  double deviation_rad = 0.0;   ///< root mean square of their differences from it
  int m = 0;                    ///< commonest difference of index to the nearest neighbour on one side ...
  int n = 0;                    ///< ... and on the other, m <= n
  double agreement = 0.0;       ///< share of the organs whose own pair is (m, n)
  double distance = 0.0;        ///< mean distance to the nearest neighbour
};

/// Measures organs [first, last) of `unrolled` among all: x in turns (any), y in circumferences. On any surface of
/// revolution y is the integral of ds / (2 pi radius): the map is conformal, so neighbours stay neighbours and lengths
/// are shares of the local circumference. Needs two organs in the range. O(range * organs).
PatternMeasure measure_pattern(std::span<const Vec2> unrolled, std::size_t first, std::size_t last);

}  // namespace anthesis
