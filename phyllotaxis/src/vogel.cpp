#include "anthesis/phyllotaxis/vogel.h"

#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"

namespace anthesis {

std::optional<Error> check(const SpiralParams& params) {
  if (!std::isfinite(params.spacing_mm) || params.spacing_mm <= 0.0) {
    return invalid_parameter("spacing_mm", "must be finite and > 0", params.spacing_mm);
  }
  if (!std::isfinite(params.divergence_rad)) {
    return invalid_parameter("divergence_rad", "must be finite", params.divergence_rad);
  }
  return std::nullopt;
}

double spiral_azimuth_rad(std::size_t k, double divergence_rad) {
  const double turns = static_cast<double>(k) * (divergence_rad / math::kTurnRad);
  const double azimuth = (turns - std::floor(turns)) * math::kTurnRad;
  return azimuth < math::kTurnRad ? azimuth : 0.0;
}

void place_spiral(const SpiralParams& params, std::span<Vec2> centres_mm) {
  ANTHESIS_ASSERT(!check(params));
  for (std::size_t i = 0; i < centres_mm.size(); ++i) {
    const double k = static_cast<double>(i);
    const double radius = params.spacing_mm * std::sqrt(k + 0.5);
    // A product, not a running sum: floret k must not inherit the rounding of those before it.
    const auto [sine, cosine] = math::sin_cos(k * params.divergence_rad);
    centres_mm[i] = {radius * cosine, radius * sine};
  }
}

}  // namespace anthesis
