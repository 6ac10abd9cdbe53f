#pragma once
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// The full turn divided by phi squared, about 137.508 degrees.
inline constexpr double kGoldenAngleRad = 2.0 * std::numbers::pi * (2.0 - std::numbers::phi);

/// Azimuth of organ k: k * divergence in [0, 2 pi). A product, not a running sum, so that it inherits no rounding.
double spiral_azimuth_rad(std::size_t k, double divergence_rad);

/// A flat spiral of florets about the centre of the flower head (Vogel 1979). See docs/phyllotaxis.md.
struct SpiralParams {
  double spacing_mm = 1.0;                  ///< Finite, > 0. Each floret gets pi * spacing^2 of the disc.
  double divergence_rad = kGoldenAngleRad;  ///< Finite. Counter-clockwise seen from +z.
};

/// What is wrong with `params`, if anything.
std::optional<Error> check(const SpiralParams& params);

/// Writes one centre per element of `centres_mm`, innermost first, in the plane z = 0.
///
/// Floret k lies at radius spacing * sqrt(k + 1/2) and angle k * divergence from +x, so the disc of radius
/// spacing * sqrt(n) holds exactly the first n. A longer span extends a shorter one unchanged. The span may be empty.
/// O(n), no allocation, no randomness, the same bits on every platform.
///
/// Precondition: check(params) finds nothing (asserted).
void place_spiral(const SpiralParams& params, std::span<Vec2> centres_mm);

}  // namespace anthesis
