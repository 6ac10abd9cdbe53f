#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/corolla/pigment.h"

namespace anthesis::detail {

/// The colour of a pigment that is the same everywhere on an organ, if it is.
std::optional<Colour> plain_colour(const Pigment& pigment);

/// Where a pigment lies in an atlas: texture u = offset + scale * u of the organ; v stays.
struct AtlasTile {
  double offset = 0.0;
  double scale = 1.0;
};

/// Pigments side by side in one picture.
struct Atlas {
  std::string colour_png;     ///< upper sides of a typical organ in sRGB, v downwards as glTF's coordinates go
  std::string roughness_png;  ///< glTF's metallic-roughness texture; empty if all pigments are equally rough
  std::vector<AtlasTile> tiles;
};

/// A pigment that varies along v alone is a narrow strip.
Expected<Atlas> bake_atlas(std::span<const Pigment* const> pigments);

}  // namespace anthesis::detail
