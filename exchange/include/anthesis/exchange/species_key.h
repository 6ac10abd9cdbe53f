#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "anthesis/base/error.h"
#include "anthesis/inflorescence/species.h"

namespace anthesis {

/// The whole name of a key of species files: "vasculature.sector_weight" for "sector_weight" and, by its symbol in
/// O24's Table SMD1, for "mu_sec" (so mu_age, delta or delta_step, tau_m, tau_d, r_G, r_V, kappa, n). Names that do not
/// begin with a table are looked for in [vasculature].
std::string whole_key(std::string_view key);

/// Sets a number of a species by its key: "head.active_ring.last_ring", "head.active_ring.sections[2].ring",
/// "head.active_ring.knots[4]", "organs.ray.layering_deg", "vasculature.depth_course[0][1]" (what the first point of a
/// function has as its second number), "mu_sec". A whole function or course becomes constant, a range a single value.
/// eta, gamma_max and rho are numbers of all kinds of strands: probability and strength of jitter, diameters of tips.
/// Rules between several keys are left to check(Species).
///
/// Errors: kUnknownParameter, with the nearest key; kInvalidParameter for a value out of range and a key that is not a
/// number. The species is then as it was.
std::optional<Error> set_number(Species& species, std::string_view key, double value);

/// Multiplies a number by a factor; and, which a single value cannot say, all numbers of a list or a range, all values
/// of a function or course (its times stay), all points of a curve: "head.active_ring.threshold_mm",
/// "head.active_ring.sections[9].points". Whole numbers must stay whole. Errors: as above.
std::optional<Error> scale_number(Species& species, std::string_view key, double factor);

}  // namespace anthesis
