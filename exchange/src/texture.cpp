#include "texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "anthesis/base/png.h"

namespace anthesis::detail {
namespace {

bool same_across(const Pigment& pigment) {
  return !pigment.margin && (pigment.veins == 0 || pigment.vein_depth == 0.0) && pigment.mottle == 0.0;
}

std::uint8_t byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
}

/// Between its ranges' ends: what an organ that does not stand out looks like.
PigmentVariation typical(const Pigment& pigment) {
  constexpr double kRadPerDeg = 0.017453292519943295;
  return {.hue_rad = 0.5 * kRadPerDeg * (pigment.hue_deg[0] + pigment.hue_deg[1]),
          .value = 0.5 * (pigment.value[0] + pigment.value[1]),
          .pattern = 1};
}

}  // namespace

std::optional<Colour> plain_colour(const Pigment& pigment) {
  const bool one_stop = std::all_of(pigment.colour.begin(), pigment.colour.end(), [&](const ColourStop& stop) {
    return stop.colour == pigment.colour.front().colour;
  });
  if (!one_stop || !same_across(pigment)) {
    return std::nullopt;
  }
  return colour_at(pigment, typical(pigment), {0.5, 0.5}, true);
}

Expected<Atlas> bake_atlas(std::span<const Pigment* const> pigments) {
  constexpr std::uint32_t kHeight = 256;
  constexpr std::uint32_t kRoughnessHeight = 4;
  // Beside a neighbour each tile repeats its edge, so that filtering does not mix pigments.
  const std::uint32_t gutter = pigments.size() > 1 ? 4 : 0;
  std::vector<std::uint32_t> widths;
  std::uint32_t whole = 0;
  for (const Pigment* pigment : pigments) {
    widths.push_back(same_across(*pigment) ? 8 : 128);
    whole += widths.back() + 2 * gutter;
  }
  // A power of two, as some engines want it: the last tile's gutter takes up the rest.
  const std::uint32_t rest = std::bit_ceil(whole) - whole;
  whole += rest;

  Atlas atlas;
  std::vector<std::uint8_t> colours(std::size_t{3} * whole * kHeight);
  std::vector<std::uint8_t> roughness(std::size_t{3} * whole * kRoughnessHeight);
  bool differ = false;
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < pigments.size(); ++i) {
    const Pigment& pigment = *pigments[i];
    const PigmentVariation variation = typical(pigment);
    const std::uint32_t width = widths[i] + 2 * gutter + (i + 1 == pigments.size() ? rest : 0);
    for (std::uint32_t column = 0; column < width; ++column) {
      const double u = std::clamp((column + 0.5 - gutter) / widths[i], 0.0, 1.0);
      for (std::uint32_t row = 0; row < kHeight; ++row) {
        const Colour colour = colour_at(pigment, variation, {u, (row + 0.5) / kHeight}, true);
        std::uint8_t* const pixel = &colours[std::size_t{3} * (std::size_t{row} * whole + first + column)];
        pixel[0] = byte(srgb_from_linear(colour.r));
        pixel[1] = byte(srgb_from_linear(colour.g));
        pixel[2] = byte(srgb_from_linear(colour.b));
      }
      for (std::uint32_t row = 0; row < kRoughnessHeight; ++row) {
        // Green is roughness; red is unused, and blue is metallic.
        roughness[std::size_t{3} * (std::size_t{row} * whole + first + column) + 1] = byte(pigment.roughness);
      }
    }
    differ = differ || pigment.roughness != pigments.front()->roughness;
    atlas.tiles.push_back({static_cast<double>(first + gutter) / whole, static_cast<double>(widths[i]) / whole});
    first += width;
  }

  // glTF says itself that base colours are sRGB; a chunk that says so too is a "feature" to the validator.
  const PngOptions options{.texts = {}, .srgb_chunk = false};
  Expected<std::string> png = encode_png(colours, whole, kHeight, 3, options);
  if (!png) {
    return unexpected(png.error());
  }
  atlas.colour_png = std::move(*png);
  if (differ) {
    png = encode_png(roughness, whole, kRoughnessHeight, 3, options);
    if (!png) {
      return unexpected(png.error());
    }
    atlas.roughness_png = std::move(*png);
  }
  return atlas;
}

}  // namespace anthesis::detail
