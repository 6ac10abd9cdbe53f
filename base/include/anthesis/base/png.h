#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "anthesis/base/error.h"

namespace anthesis {

/// A line of text inside a PNG, such as the seed it was made with.
struct PngText {
  std::string keyword;  ///< 1 to 79 printable Latin-1 characters: "Software", "Species"
  std::string text;     ///< UTF-8
};

struct PngOptions {
  std::vector<PngText> texts;  ///< written in this order
  bool srgb_chunk = true;      ///< states that the values are sRGB; glTF textures are so by definition and go without
  int compression = 6;         ///< of zlib, 0 to 9
};

/// The bytes of an 8-bit PNG. `pixels` holds the rows, top row first, `channels` (3: RGB, 4: RGBA) bytes a pixel,
/// without padding. Carries no time of writing: equal pixels and options give equal bytes.
///
/// Errors: kInvalidParameter if the size of `pixels` does not fit, kTooLarge above 65,535 pixels a side, kIo from
/// libpng.
Expected<std::string> encode_png(std::span<const std::uint8_t> pixels, std::uint32_t width, std::uint32_t height,
                                 int channels, const PngOptions& options = {});

}  // namespace anthesis
