#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis {

/// An organ of a pattern on a surface of revolution about z.
struct PatternOrgan {
  double azimuth_rad = 0.0;  ///< counter-clockwise seen from +z, any turn
  double s_mm = 0.0;         ///< along the profile, from the apex
  double radius_mm = 0.0;    ///< distance from the axis, > 0
  double height_mm = 0.0;    ///< only drawings use it
};

/// Organs out of positions alone, as a digitised head gives them, in the same order; the axis is z, the apex is the end
/// of the profile with the smaller mean radius. Distances along the profile are measured on a curve laid through the
/// positions in the (radius, height) half plane, smoothed over about two organs' spacing. Positions that are not finite
/// give organs that are not finite. O(n log n).
std::vector<PatternOrgan> pattern_organs(std::span<const Vec3> positions_mm);

struct ParastichyOptions {
  /// Organ i was born i-th. Otherwise only places count, and what needs the order is NaN or 0 in the answer.
  bool in_order_of_birth = true;

  /// A stretch whose regularity is below this has no consistent pair and is reported as irregular; in [0, 1].
  double least_regularity = 0.4;
};

/// Which way a parastichy turns on its way out from the apex, seen from +z.
enum class ParastichyTurn : std::int8_t {
  kClockwise = -1,
  kStraight = 0,  ///< an orthostichy: less than a hundredth of its step
  kCounterClockwise = 1,
};

/// What a pair of parastichy numbers belongs to.
enum class ParastichySeries {
  kFibonacci,    ///< neighbours in 1, 2, 3, 5, 8, 13 ...
  kLucas,        ///< neighbours in 1, 3, 4, 7, 11, 18 ...
  kMultijugate,  ///< `jugacy` >= 2 times neighbours in the Fibonacci sequence; bijugate for 2
  kWhorled,      ///< two equal numbers: whorls, each turned by half a step
  kOther,        ///< a regular pair of any other series, see `seeds`
  kIrregular,    ///< no consistent pair
};

/// "fibonacci", "lucas", "multijugate", "whorled", "other", "irregular".
const char* series_name(ParastichySeries series);

/// The series of the pair {m, n}, whatever the order, by contraction: (m, n) becomes (n - m, m) as long as that is a
/// pair of the same series. `jugacy` is the greatest common divisor; `seeds` what is left, over the jugacy: (1, 2) for
/// Fibonacci, (1, 3) for Lucas, (1, 1) for whorls.
struct SeriesOfPair {
  ParastichySeries series = ParastichySeries::kIrregular;
  std::uint32_t jugacy = 0;
  std::array<std::uint32_t, 2> seeds{};
};
SeriesOfPair series_of_pair(std::uint32_t m, std::uint32_t n);

/// A family of parastichies: all the spirals of one direction.
struct ParastichyFamily {
  std::uint32_t number = 0;  ///< spirals that a loop around the axis crosses, counted
  ParastichyTurn turn = ParastichyTurn::kStraight;
  double step_azimuth_rad = 0.0;       ///< from an organ to the next on its parastichy, outwards
  double step_mm = 0.0;                ///< distance to that one
  double evenness = 0.0;               ///< how evenly they are spread around the axis: 1 perfectly, 0 not at all
  std::uint32_t index_difference = 0;  ///< the commonest difference of birth between such neighbours; 0: order unknown
  double index_share = 0.0;            ///< share of such neighbours that have it
};

/// A stretch of the surface with one visible opposed pair.
struct ParastichyRegion {
  double from_mm = 0.0;  ///< along the profile, from the apex
  double to_mm = 0.0;
  std::size_t organs = 0;
  ParastichyFamily m;      ///< the smaller number of the pair; in irregular stretches the commonest
  ParastichyFamily n;      ///< the larger; the two turn in opposite senses
  ParastichyFamily third;  ///< m + n or n - m, whichever has the shorter step
  SeriesOfPair kind;
  double regularity = 0.0;         ///< 1 a perfect lattice, 0 no order: the lesser evenness of the two, averaged
  double divergence_rad = 0.0;     ///< of the lattice, in [0, pi / jugacy]; NaN where irregular
  double plastochron_ratio = 1.0;  ///< factor per organ of the distance from the centre, the surface mapped to a disc
  std::size_t dislocations = 0;    ///< within
};

/// Where the visible pair changes along the surface.
struct ParastichyTransition {
  double s_mm = 0.0;
  std::array<std::uint32_t, 2> inside{};   ///< the pair on the apex side
  std::array<std::uint32_t, 2> outside{};  ///< the pair on the base side
  bool continuous = false;  ///< one number goes on and the other is its sum or difference: the same lattice, sheared
};

/// A place where parastichies begin or end. It sits between a 5- and a 7-coordinated organ.
struct ParastichyDislocation {
  double s_mm = 0.0;
  double azimuth_rad = 0.0;              ///< in [0, 2 pi)
  std::uint32_t organ = 0;               ///< the nearest
  std::array<std::uint32_t, 2> pair{};   ///< numbers of the two families there
  std::array<std::int32_t, 2> gained{};  ///< how many more there are of each on the base side
};

/// Two neighbours on the surface.
struct ParastichyLink {
  std::array<std::uint32_t, 2> organs{};  ///< the first nearer the apex
  std::uint8_t family = 0;                ///< 1 the smaller number of the pair there, 2 the larger, 0 neither
  std::uint32_t number = 0;               ///< parastichies in that family; 0 with family 0
  bool contact = false;                   ///< false for the long diagonal of a nearly square cell
};

/// What was found about one organ.
struct ParastichyOrgan {
  double u = std::numeric_limits<double>::quiet_NaN();  ///< conformal coordinate, docs/parastichies.md; NaN: left out
  double divergence_rad = std::numeric_limits<double>::quiet_NaN();  ///< from the one born before, in (-pi, pi]
  std::uint32_t coordination = 0;  ///< neighbours, one diagonal of each cell among them
  std::uint32_t contacts = 0;      ///< neighbours without the long diagonals of nearly square cells
  std::uint32_t region = 0;        ///< index into Parastichies::regions
};

/// The sequence of divergence angles of organs in order of birth.
struct DivergenceStatistics {
  ParastichyTurn turn = ParastichyTurn::kStraight;             ///< the genetic spiral's, in order of birth
  double mean_rad = std::numeric_limits<double>::quiet_NaN();  ///< circular mean, measured along `turn`, in [0, pi]
  double deviation_rad = std::numeric_limits<double>::quiet_NaN();      ///< root mean square about it
  double plastochron_ratio = std::numeric_limits<double>::quiet_NaN();  ///< >= 1; geometric mean over the sequence
};

/// All that was found, from the apex outwards.
struct Parastichies {
  std::vector<ParastichyRegion> regions;  ///< without gaps; empty for fewer than 8 usable organs
  std::vector<ParastichyTransition> transitions;
  std::vector<ParastichyDislocation> dislocations;
  std::vector<ParastichyLink> links;
  std::vector<ParastichyOrgan> organs;  ///< in the order given
  DivergenceStatistics divergence;
  std::size_t left_out = 0;  ///< organs not finite, on the axis, or at the place of another
};

/// Finds the parastichies of a pattern from where its organs are; see docs/parastichies.md.
///
/// A mirrored pattern gives the same numbers with the turns exchanged. Nothing is said where there are too few organs
/// to go around the axis. O(n log n): 100,000 organs in 0.6 s on one thread. Same answer for any number of threads.
Parastichies analyse_parastichies(std::span<const PatternOrgan> organs, const ParastichyOptions& options = {});

}  // namespace anthesis
