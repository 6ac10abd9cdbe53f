#pragma once
#include <optional>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/phyllotaxis/cylinder_lattice.h"

namespace anthesis {

/// Which of two equal ways a divergence goes when organs straight above each other part.
enum class PressureSide { kTowardsSmaller, kTowardsLarger };

/// What contact pressure makes of a lattice whose rise is held.
struct PressedLattice {
  double rise = 0.0;            ///< in circumferences
  double divergence_rad = 0.0;  ///< in [0, 2 pi)
  double distance = 0.0;        ///< least distance between organs, in circumferences
  int m = 0;                    ///< families in contact that hold the divergence, m <= n; m = 0: the ring around the
  int n = 0;                    ///< cylinder; both 0: nothing touches but it, and the divergence is free
};

/// Adler's contact pressure (1974) at one rise: the divergence moves uphill on the least distance between organs, from
/// where it is to the nearest maximum. Each move is the root of a quadratic equation, so the maximum is exact to
/// rounding (about 1e-13 turns). O(1 / sqrt(rise)) a contact met. Precondition: rise in [1e-6, 1e3], divergence finite.
PressedLattice press(double divergence_rad, double rise, PressureSide side = PressureSide::kTowardsSmaller);

/// Pressure kept up while the rise falls, in equal ratios.
struct ContactPressureParams {
  double first_divergence_rad = 2.0;  ///< before the first contact, finite
  double first_rise = 0.5;            ///< where pressure begins, in [1e-6, 1e3]
  double last_rise = 0.001;           ///< in [1e-6, first_rise]
  int steps = 200;                    ///< number of lattices, in [1, 100000]
};
std::optional<Error> check(const ContactPressureParams& params);

/// One lattice a step. A divergence above half a turn at first stays there: the mirror image of one below. See
/// docs/contact-pressure.md. Errors: those of check, kCancelled.
Expected<std::vector<PressedLattice>> contact_pressure(const ContactPressureParams& params,
                                                       const Progress& progress = {});

}  // namespace anthesis
