#include "anthesis/corolla/pigment.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/base/random.h"

namespace anthesis {

namespace {

/// Colours are mixed as square roots of linear light. Steps are then nearly even to the eye (a display's curve is close
/// to a square root), red into yellow stays clean, and a square root is exact on every processor. A perceptual space
/// with cube roots would look the same here and cost ten times as much.
Colour root(Colour c) {
  return {std::sqrt(c.r), std::sqrt(c.g), std::sqrt(c.b)};
}
Colour square(Colour c) {
  return {c.r * c.r, c.g * c.g, c.b * c.b};
}
Colour mix(Colour a, Colour b, double t) {
  return (1.0 - t) * a + t * b;
}

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// A well mixed 32 bit hash of two lattice coordinates and a seed, as a number in [0, 1).
double lattice(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = seed;
  h ^= static_cast<std::uint32_t>(x) * 0x9E3779B1u;
  h = (h ^ (h >> 15)) * 0x85EBCA77u;
  h ^= static_cast<std::uint32_t>(y) * 0xC2B2AE3Du;
  h = (h ^ (h >> 13)) * 0x27D4EB2Fu;
  h ^= h >> 16;
  return static_cast<double>(h) * 0x1p-32;
}

/// Smooth noise in [0, 1) with mean one half: values on a lattice, eased between.
double noise(double x, double y, std::uint32_t seed) {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto ix = static_cast<std::int32_t>(fx);
  const auto iy = static_cast<std::int32_t>(fy);
  const double tx = smooth_step(x - fx);
  const double ty = smooth_step(y - fy);
  const double low = (1.0 - tx) * lattice(ix, iy, seed) + tx * lattice(ix + 1, iy, seed);
  const double high = (1.0 - tx) * lattice(ix, iy + 1, seed) + tx * lattice(ix + 1, iy + 1, seed);
  return (1.0 - ty) * low + ty * high;
}

double noise(double x, std::int32_t row, std::uint32_t seed) {
  const double fx = std::floor(x);
  const auto ix = static_cast<std::int32_t>(fx);
  const double t = smooth_step(x - fx);
  return (1.0 - t) * lattice(ix, row, seed) + t * lattice(ix + 1, row, seed);
}

/// Base to tip, in roots of linear light.
Colour gradient(const std::vector<ColourStop>& stops, double v) {
  std::size_t next = 0;
  while (next < stops.size() && stops[next].at <= v) {
    ++next;
  }
  if (next == 0) {
    return root(stops.front().colour);
  }
  if (next == stops.size()) {
    return root(stops.back().colour);
  }
  const ColourStop& a = stops[next - 1];
  const ColourStop& b = stops[next];
  return mix(root(a.colour), root(b.colour), smooth_step((v - a.at) / (b.at - a.at)));
}

/// How much of a vein lies at (u, v), 0 to 1. Each vein keeps to its own strip of the width, so that one strip is all
/// there is to look at; strips converge where the petal narrows, as the surface's own u lines do.
double vein_at(int veins, Vec2 uv, std::uint32_t seed) {
  const double x = uv.x * veins;
  const auto strip = std::clamp(static_cast<std::int32_t>(std::floor(x)), 0, veins - 1);
  const double shift = 0.16 * (lattice(strip, 1, seed) - 0.5);
  const double wave = 0.18 * (noise(uv.y * 5.0, 4 * strip + 2, seed) - 0.5);
  const double centre = strip + 0.5 + shift + wave;
  const double strength = 0.7 + 0.3 * lattice(strip, 2, seed);
  const double half_width = (0.10 + 0.10 * noise(uv.y * 7.0, 4 * strip + 3, seed)) * (1.0 - 0.45 * uv.y);
  const double profile = 1.0 - smooth_step(std::abs(x - centre) / half_width);
  const double end = 0.75 + 0.35 * lattice(strip, 3, seed);  // veins do not all reach equally far
  const double fade = 1.0 - smooth_step((uv.y - 0.35 * end) / (0.65 * end));
  return profile * strength * fade;
}

/// A turn about the axis of greys, which leaves greys and the mean of the channels as they are.
Colour turn_hue(Colour c, double hue_rad) {
  const auto [sine, cosine] = math::sin_cos(hue_rad);
  const double mean = (c.r + c.g + c.b) / 3.0;
  const double side = sine * 0.57735026918962576;  // 1 / sqrt(3)
  return {mean + cosine * (c.r - mean) + side * (c.b - c.g), mean + cosine * (c.g - mean) + side * (c.r - c.b),
          mean + cosine * (c.b - mean) + side * (c.g - c.r)};
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') {
    return c - '0';
  }
  if (c >= 'a' && c <= 'f') {
    return c - 'a' + 10;
  }
  if (c >= 'A' && c <= 'F') {
    return c - 'A' + 10;
  }
  return -1;
}

}  // namespace

double linear_from_srgb(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : math::pow((srgb + 0.055) / 1.055, 2.4);
}

double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * math::pow(linear, 1.0 / 2.4) - 0.055;
}

Expected<Colour> parse_colour(std::string_view text) {
  int digits[6] = {};
  bool good = text.size() == 7 && text[0] == '#';
  for (std::size_t i = 0; good && i < 6; ++i) {
    digits[i] = hex_digit(text[i + 1]);
    good = digits[i] >= 0;
  }
  if (!good) {
    Error error = invalid_parameter("", "must be a colour \"#rrggbb\"", text.substr(0, 32));
    error.code = ErrorCode::kParse;
    return unexpected(error);
  }
  const auto channel = [&](int i) { return linear_from_srgb((16 * digits[i] + digits[i + 1]) / 255.0); };
  return Colour{channel(0), channel(2), channel(4)};
}

std::string to_hex(Colour colour) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text = "#";
  for (const double linear : {colour.r, colour.g, colour.b}) {
    const double srgb = srgb_from_linear(std::clamp(linear, 0.0, 1.0));
    const int byte = static_cast<int>(std::floor(srgb * 255.0 + 0.5));
    text += kDigits[byte / 16];
    text += kDigits[byte % 16];
  }
  return text;
}

PigmentVariation vary(const Pigment& pigment, std::uint64_t seed, std::uint64_t organ) {
  Rng rng(seed, organ, RandomPurpose::kColour);
  PigmentVariation variation;
  variation.hue_rad = math::radians(rng.uniform(pigment.hue_deg[0], pigment.hue_deg[1]));
  variation.value = rng.uniform(pigment.value[0], pigment.value[1]);
  variation.pattern = rng.bits();
  return variation;
}

Colour colour_at(const Pigment& pigment, const PigmentVariation& variation, Vec2 uv, bool upper_side) {
  uv = {std::clamp(uv.x, 0.0, 1.0), std::clamp(uv.y, 0.0, 1.0)};
  Colour colour = gradient(pigment.colour, uv.y);
  if (pigment.underside && !upper_side) {
    colour = mix(colour, root(*pigment.underside), 0.5);
  }
  if (pigment.margin) {
    const double from_edge = 2.0 * std::min(uv.x, 1.0 - uv.x);  // 0 at the edge, 1 at the midrib
    colour = mix(colour, root(*pigment.margin), 1.0 - smooth_step(from_edge / pigment.margin_width));
  }
  if (variation.hue_rad != 0.0) {
    colour = turn_hue(colour, variation.hue_rad);
    colour = {std::max(colour.r, 0.0), std::max(colour.g, 0.0), std::max(colour.b, 0.0)};
  }
  colour = square(colour);

  double light = variation.value;
  if (pigment.mottle > 0.0) {
    // Cells of living tissue run along the organ: broad patches, and fine streaks four times as long as wide.
    const double patches = noise(uv.x * 5.0, uv.y * 6.0, variation.pattern) - 0.5;
    const double streaks = noise(uv.x * 34.0, uv.y * 9.0, variation.pattern ^ 0x68E31DA4u) - 0.5;
    light *= 1.0 + pigment.mottle * (patches + streaks);
  }
  colour = light * colour;
  if (pigment.veins > 0 && pigment.vein_depth > 0.0) {
    // The strongest channel gives way less than the others: a vein is deeper in colour, not grey.
    const double depth = pigment.vein_depth * vein_at(pigment.veins, uv, variation.pattern ^ 0xB5297A4Du);
    const double strongest = std::max({colour.r, colour.g, colour.b, 1e-9});
    const auto deepen = [&](double c) { return c * (1.0 - depth * (1.0 - 0.3 * c / strongest)); };
    colour = {deepen(colour.r), deepen(colour.g), deepen(colour.b)};
  }
  const auto unit = [](double c) { return std::clamp(c, 0.0, 1.0); };
  return {unit(colour.r), unit(colour.g), unit(colour.b)};
}

}  // namespace anthesis
