#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/math.h"
#include "anthesis/base/progress.h"
#include "anthesis/phyllotaxis/growing_profile.h"
#include "anthesis/phyllotaxis/primordium_kind.h"

namespace anthesis {

/// Primordia that appear on an active ring wherever there is room (O24, P-model). See docs/active-ring.md.
struct ActiveRingParams {
  /// Least distance D to all others at a time in [0, 1], in the profile's unit; > 0.
  std::function<double(double)> threshold;

  /// D stays what it is as soon as there are more primordia than this.
  std::size_t threshold_frozen_above = std::numeric_limits<std::size_t>::max();

  /// How fast a young primordium moves sideways to where it is D from its older neighbour, per unit of time; >= 0.
  double relaxation = 45.32;

  /// A primordium may move sideways as long as its s is below this many times the ring's; > 0.
  double mobile_zone = 1.5;

  double last_ring = 0.0025;  ///< no primordium appears once the ring's s is at or below this; in [0, 1]
  /// How much nearer to the apex a primordium stands, in material coordinates, than the place of the ring where it
  /// found room; in [0, 0.1]. Continuous model only: the published program rounds coordinates down to multiples of
  /// 0.001, which is a lag of 0.0005 on average, and has 2 % fewer primordia by it in the sunflower.
  double lag = 0.0;

  double first_azimuth_rad = math::kPi;  ///< of the first primordium, in [0, 2 pi)

  std::size_t bract_landmark = 0;  ///< outside it are bracts; 0: there are none
  std::size_t trans_landmark = 0;  ///< outside it, but not bracts, are trans florets; 0: there are none

  /// Of the search for the next primordium, in (0, 0.1]; the answer does not depend on it but for rounding and for gaps
  /// that open and close again within one step. As published: the step of the clock.
  double time_step = 0.0005;

  double angular_step_rad = 0.001;  ///< of the published scan, in [1e-6, 1]

  std::size_t most_primordia = 100'000;  ///< more are an error (kTooLarge)
};

/// So many primordia may stand round the ring, by its length and the threshold: the work grows with their square.
inline constexpr double kMostAroundRing = 2000.0;

/// What is wrong with the parameters for this profile, if anything.
std::optional<Error> check(const ActiveRingParams& params, const GrowingProfile& profile);

/// A primordium at one moment.
struct RingMoment {
  std::uint32_t step = 0;  ///< of the published clock, from 1; 0 in the continuous model
  double time = 0.0;
  double s = 0.0;
  double azimuth_rad = 0.0;  ///< in [0, 2 pi)
  PrimordiumKind kind = PrimordiumKind::kFloret;
};

struct RingPrimordium {
  RingMoment born;
  RingMoment stable;                          ///< when it stopped moving sideways; the last moment if it never did
  RingMoment last;                            ///< at time 1 (as published: at the last step)
  double material = 0.0;                      ///< its material coordinate u, for its way on the growing profile
  double threshold = 0.0;                     ///< D when it appeared
  std::array<std::uint32_t, 2> neighbours{};  ///< at birth: the one behind it in azimuth, the one ahead; itself if none
};

/// Lets primordia appear on the ring of a growing profile, in order of birth.
///
/// The continuous model: a primordium appears at the very moment and angle at which the arcs that others forbid on the
/// ring leave the first free point; sideways movement is an ordinary differential equation. Errors: check(params,
/// profile); a threshold that is not > 0, or too small for the ring; too many primordia; kCancelled. 500 primordia take
/// about 0.1 s on one thread.
Expected<std::vector<RingPrimordium>> grow_active_ring(const GrowingProfile& profile, const ActiveRingParams& params,
                                                       const Progress& progress = {});

/// The same by the rules of the program published with O24: a clock of steps of `time_step`, shorter near the apex, and
/// at each step a scan of the ring in angular steps from the first azimuth on, in which primordia appear at the first
/// angle of a gap. Angles that the others forbid are jumped over; the outcome is that of the full scan. `relaxation` is
/// meant per 1 of time, `relaxation * time_step` per step.
Expected<std::vector<RingPrimordium>> grow_active_ring_as_published(const GrowingProfile& profile,
                                                                    const ActiveRingParams& params,
                                                                    const Progress& progress = {});

/// Time of each step of the published clock, [0] at the start: steps of `step`, each 0.7 % shorter than the one before
/// while the ring's s is below 0.01 and the step above a tenth of `step`; until time 1.
std::vector<double> published_clock(const GrowingProfile& profile, double step = 0.0005);

/// The kind of a place among the landmarks at a time.
PrimordiumKind kind_of(const GrowingProfile& profile, const ActiveRingParams& params, double time, double s);

}  // namespace anthesis
