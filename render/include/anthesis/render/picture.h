#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/png.h"
#include "anthesis/render/scene.h"

namespace anthesis {

/// Exposed linear light (Rec. 709 primaries), rows from the top, four floats a pixel: red, green, blue, each times
/// coverage, and coverage (0: backdrop alone, 1: plant or full shadow alone).
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;
  Backdrop backdrop;
};

/// 8 bit sRGB, rows from the top, 3 bytes a pixel, or 4 with straight alpha.
struct Image {
  int width = 0;
  int height = 0;
  int channels = 3;
  std::vector<std::uint8_t> bytes;
};

/// Display light for exposed light: a slight toe, then straight for most of the range, then a shoulder. The strongest
/// channel is bent and the others follow in proportion, so hue and saturation stay; only what is far too bright pales.
/// Returns values in [0, 1].
Colour tone(Colour exposed);

/// Tone, backdrop, and a fixed dither of half a step against bands.
Image develop(const Picture& picture);

/// Images of one size and kind in rows of `columns`, left to right and down; what is left over stays as the last
/// image's top left corner is, so that the sheet has one background. Precondition: at least one image, all alike,
/// columns > 0.
Image contact_sheet(std::span<const Image> images, int columns);

/// The bytes of a PNG file with the texts in order; no time stamp: equal pictures, equal bytes. See base/png.h for the
/// limits and errors.
Expected<std::string> encode_png(const Image& image, std::vector<PngText> texts = {});
Expected<std::string> encode_png(const Picture& picture, std::vector<PngText> texts = {});

}  // namespace anthesis
