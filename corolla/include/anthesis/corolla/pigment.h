#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Linear light, Rec. 709 primaries; 0 to 1.
struct Colour {
  double r = 0.0;
  double g = 0.0;
  double b = 0.0;

  friend constexpr Colour operator+(Colour p, Colour q) { return {p.r + q.r, p.g + q.g, p.b + q.b}; }
  friend constexpr Colour operator*(double k, Colour p) { return {k * p.r, k * p.g, k * p.b}; }
  friend constexpr bool operator==(Colour, Colour) = default;
};

/// "#rrggbb" in sRGB to linear light; nothing else is accepted.
Expected<Colour> parse_colour(std::string_view text);
std::string to_hex(Colour colour);  ///< the nearest "#rrggbb"
double srgb_from_linear(double linear);
double linear_from_srgb(double srgb);

/// A colour at a place between base (0) and tip (1).
struct ColourStop {
  double at = 0.0;
  Colour colour;
};

/// How the surface of an organ is coloured and meets light. All of it is a function of (u, v) and of the organ.
struct Pigment {
  std::string name;
  std::vector<ColourStop> colour = {{0.0, {0.5, 0.5, 0.5}}};  ///< base to tip, `at` ascending, at least one
  std::optional<Colour> underside;             ///< mixed half and half into the lower side; none: both sides alike
  std::optional<Colour> margin;                ///< colour towards the edges u = 0 and u = 1
  double margin_width = 0.15;                  ///< share of the half width that the margin's colour fades over, (0, 1]
  int veins = 0;                               ///< veins across the whole width, 0 to 64
  double vein_depth = 0.15;                    ///< how much darker a vein is, 0 to 1
  double mottle = 0.05;                        ///< strength of fine random patches, 0 to 1
  std::array<double, 2> hue_deg = {0.0, 0.0};  ///< range of the organ's own turn of hue
  std::array<double, 2> value = {1.0, 1.0};    ///< range of the organ's own factor of brightness
  double roughness = 0.6;                      ///< 0 mirror to 1 matt
  double specular = 0.3;                       ///< strength of the clear reflection, 0 to 1
  double sheen = 0.1;                          ///< velvet at grazing angles, 0 to 1
  double translucency = 0.0;                   ///< share of the diffuse light that passes through, 0 to 1
};

/// Whose colours: a number per organ, constant over its life, equal for equal seeds.
struct PigmentVariation {
  double hue_rad = 0.0;
  double value = 1.0;
  std::uint32_t pattern = 0;  ///< seeds the mottle
};

PigmentVariation vary(const Pigment& pigment, std::uint64_t seed, std::uint64_t organ);

/// Diffuse colour at (u, v) in [0, 1]^2 of the upper or lower side. A pure function, about 150 ns.
Colour colour_at(const Pigment& pigment, const PigmentVariation& variation, Vec2 uv, bool upper_side);

}  // namespace anthesis
