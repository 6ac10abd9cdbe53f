#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/geometry/vec.h"

// Primordia that keep others away (Douady and Couder 1992, 1996). See docs/inhibition.md.
//
// Organs are born on a ring about the axis and carried away from it. Lengths are in radii of the ring, times in the
// time it takes to move one radius at the speed that an organ has on the ring.

namespace anthesis {

namespace detail {
class ConformalProfile;
}

/// When an organ is born. Where is always the same: at the least inhibited place of the ring.
enum class BirthRule {
  kPeriod,     ///< one every period (Hofmeister 1868)
  kThreshold,  ///< when the inhibition there has fallen to 1 (Snow and Snow 1932); several may come at once: whorls
};

/// How organs are carried away from the ring.
enum class RingTransport {
  kExponentialDisc,  ///< on a flat disc, radius = exp(age): all lengths grow alike
  kSteadyDisc,       ///< on a flat disc, radius = 1 + age
  kCylinder,         ///< down a cylinder, depth = age
  kSurface,  ///< down a surface of revolution, the conformal distance, integral of ds / radius, = age; below its
             ///< base on a cylinder. On a disc that is kExponentialDisc, on a cylinder kCylinder.
};

/// Inhibition E at the straight distance d of an organ with the range a; inhibitions of all organs add up.
enum class InhibitionLaw {
  kPower,        ///< (a / d)^exponent
  kExponential,  ///< exp(1 - d / a)
};

struct InhibitionParams {
  BirthRule rule = BirthRule::kPeriod;
  RingTransport transport = RingTransport::kExponentialDisc;
  std::vector<Vec2> profile = {};  ///< kSurface only: (radius, height) apex to base, B-spline of degree min(3, n - 1)
  double ring_s = 0.5;             ///< kSurface only: share of its length, from the apex, in [0, 1]; radius > 0 below
  InhibitionLaw law = InhibitionLaw::kPower;
  int exponent = 3;  ///< of kPower, in [1, 12]

  /// Period of births at first and at last, G = V0 T / R0 of Douady and Couder; each in [0.001, 100]. kPeriod only.
  std::array<double, 2> period = {1.0, 0.1};
  /// Range a at first and at last, each in [0.01, 10]. With kPeriod it only matters to kExponential.
  std::array<double, 2> range = {0.5, 0.5};
  /// Period and range go from first to last in equal ratios over so many births, then stay. At most 1e6.
  std::size_t ramp = 200;
  std::size_t count = 300;  ///< organs, in [1, 100000]

  /// How far the second organ is put from the place it would take, opposite to the first: without it nothing ever says
  /// left or right. In (-pi, pi); its sign also decides between places that are equally good.
  double nudge_rad = 1e-3;
  /// Organs farther from the axis, or deeper below the ring, no longer inhibit, but for the youngest; in [2, 1000].
  double horizon = 50.0;
};

std::optional<Error> check(const InhibitionParams& params);

struct RingBirth {
  double time = 0.0;            ///< the first organ is born at 0
  double azimuth_rad = 0.0;     ///< in [0, 2 pi)
  double divergence_rad = 0.0;  ///< from the one before, in [0, 2 pi); 0 for the first
  double inhibition = 0.0;      ///< felt at birth
};

/// Where an organ is in relation to the ring.
struct RingPlace {
  double radius = 1.0;  ///< distance from the axis
  double depth = 0.0;   ///< below the ring
};

/// The way of an organ from the ring on, the same for all.
class RingTrack {
 public:
  /// Precondition: check(params) finds nothing. kSurface tabulates its profile: relative error about 1e-7.
  explicit RingTrack(const InhibitionParams& params);

  RingPlace at(double age) const;
  double conformal_distance(double age) const;  ///< integral of ds / radius from the ring

 private:
  RingTransport transport_;
  double ring_radius_mm_ = 1.0;
  double ring_height_mm_ = 0.0;
  std::shared_ptr<const detail::ConformalProfile> profile_;
};

/// Organs in order of birth. Each place is the least of the whole ring: a subdivision that bounds the inhibition from
/// below on every part of it, by its derivatives, leaves no part unsearched that could hold a lesser value (up to
/// 1e-12 of it), and Newton's method ends in what is certified convex; so angles are good to about 1e-12 where the
/// minimum is not flat. O(organs within the horizon) a try, some hundred tries an organ: at a period of 0.1 about
/// 0.1 ms an organ. Errors: those of check, kCancelled; kTooLarge if 1000 organs or more within the horizon leave the
/// ring above the threshold for a time of 1000.
Expected<std::vector<RingBirth>> grow_by_inhibition(const InhibitionParams& params, const Progress& progress = {});

/// The births in conformal coordinates at the time of the last one: x turns, y circumferences away from the ring, for
/// measure_pattern of cylinder_lattice.h.
std::vector<Vec2> unrolled_births(const RingTrack& track, std::span<const RingBirth> births);

}  // namespace anthesis
