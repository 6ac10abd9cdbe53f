#include "anthesis/render/picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anthesis/base/assert.h"

namespace anthesis {

namespace {

/// sRGB of linear light by table and line: 8 bits do not show the difference, and a power for each channel of each
/// pixel would cost more than the rest of the development.
class SrgbTable {
 public:
  SrgbTable() {
    for (int i = 0; i <= kSteps; ++i) {
      const double root = static_cast<double>(i) / kSteps;
      values_[i] = static_cast<float>(srgb_from_linear(root * root));
    }
  }

  /// 0 to 255.
  float byte(float linear) const {
    const float at = std::sqrt(std::clamp(linear, 0.0F, 1.0F)) * kSteps;
    const int i = std::min(static_cast<int>(at), kSteps - 1);
    const float t = at - static_cast<float>(i);
    return 255.0F * ((1.0F - t) * values_[i] + t * values_[i + 1]);
  }

 private:
  static constexpr int kSteps = 1024;
  std::array<float, kSteps + 1> values_;
};

/// Noise of a fixed place, triangular over one step, [-0.5, 0.5]: bands in soft backdrops dissolve.
float dither(std::uint32_t x, std::uint32_t y, std::uint32_t channel) {
  std::uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ channel * 0xC2B2AE3Du;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  h ^= h >> 15;
  return (static_cast<float>(h & 0xFFFFu) + static_cast<float>(h >> 16)) * (0.5F / 65535.0F) - 0.5F;
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

}  // namespace

Colour tone(Colour exposed) {
  constexpr double kShoulder = 0.60;  // straight up to here, but for the toe
  constexpr double kToe = 0.06;       // deepest shadows give way a little: contrast where the eye looks for it
  const double strongest = std::max({exposed.r, exposed.g, exposed.b, 0.0});
  if (!(strongest > 0.0)) {
    return {};
  }
  double bent = strongest * (strongest + 0.25 * kToe) / (strongest + kToe);
  if (bent > kShoulder) {
    const double over = (bent - kShoulder) / (1.0 - kShoulder);
    bent = kShoulder + (1.0 - kShoulder) * over / (1.0 + over);
  }
  Colour colour = (bent / strongest) * exposed;
  // Beyond twice white a lamp's reflection would keep the petal's colour: there, and only there, go towards white.
  const double pale = std::clamp((strongest - 2.0) / 8.0, 0.0, 1.0) * 0.8;
  colour = (1.0 - pale) * colour + pale * Colour{bent, bent, bent};
  const auto unit = [](double c) { return std::clamp(c, 0.0, 1.0); };
  return {unit(colour.r), unit(colour.g), unit(colour.b)};
}

Image develop(const Picture& picture) {
  static const SrgbTable table;
  const Backdrop& backdrop = picture.backdrop;
  Image image;
  image.width = picture.width;
  image.height = picture.height;
  image.channels = backdrop.transparent ? 4 : 3;
  image.bytes.resize(std::size_t(picture.width) * picture.height * image.channels);
  const double half_width = 0.5 * picture.width;
  const double half_height = 0.5 * picture.height;
  const double scale = 1.0 / std::sqrt(half_width * half_width + half_height * half_height);
  std::size_t at = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const float* pixel = &picture.rgba[4 * (std::size_t(y) * picture.width + x)];
      const double coverage = std::clamp<double>(pixel[3], 0.0, 1.0);
      Colour plant;
      if (coverage > 0.0) {
        plant = tone({pixel[0] / coverage, pixel[1] / coverage, pixel[2] / coverage});
      }
      const auto ux = static_cast<std::uint32_t>(x);
      const auto uy = static_cast<std::uint32_t>(y);
      if (backdrop.transparent) {
        image.bytes[at++] = to_byte(table.byte(static_cast<float>(plant.r)));
        image.bytes[at++] = to_byte(table.byte(static_cast<float>(plant.g)));
        image.bytes[at++] = to_byte(table.byte(static_cast<float>(plant.b)));
        image.bytes[at++] = to_byte(static_cast<float>(255.0 * coverage));
        continue;
      }
      // The bright middle sits a little above the centre, as a light behind the plant would.
      const double dx = (x + 0.5 - half_width) * scale;
      const double dy = (y + 0.5 - 0.9 * half_height) * scale;
      const double d = std::min(1.0, dx * dx + dy * dy);
      const double t = d * (1.5 - 0.5 * d);
      const Colour shown = coverage * plant + (1.0 - coverage) * ((1.0 - t) * backdrop.centre + t * backdrop.corner);
      image.bytes[at++] = to_byte(table.byte(static_cast<float>(shown.r)) + dither(ux, uy, 0));
      image.bytes[at++] = to_byte(table.byte(static_cast<float>(shown.g)) + dither(ux, uy, 1));
      image.bytes[at++] = to_byte(table.byte(static_cast<float>(shown.b)) + dither(ux, uy, 2));
    }
  }
  return image;
}

Image contact_sheet(std::span<const Image> images, int columns) {
  const Image& first = images.front();
  const int rows = (static_cast<int>(images.size()) + columns - 1) / columns;
  const auto pixel = static_cast<std::size_t>(first.channels);
  const std::size_t line = pixel * first.width;
  Image sheet{first.width * columns, first.height * rows, first.channels, {}};
  sheet.bytes.resize(line * columns * first.height * rows);
  for (std::size_t i = 0; i < sheet.bytes.size(); ++i) {
    sheet.bytes[i] = images.back().bytes[i % pixel];
  }
  for (std::size_t k = 0; k < images.size(); ++k) {
    ANTHESIS_ASSERT(images[k].bytes.size() == line * first.height);
    const std::size_t left = line * (k % columns);
    const std::size_t top = first.height * (k / columns);
    for (std::size_t y = 0; y < static_cast<std::size_t>(first.height); ++y) {
      std::copy_n(images[k].bytes.begin() + static_cast<std::ptrdiff_t>(y * line), line,
                  sheet.bytes.begin() + static_cast<std::ptrdiff_t>((top + y) * line * columns + left));
    }
  }
  return sheet;
}

Expected<std::string> encode_png(const Image& image, std::vector<PngText> texts) {
  if (image.width <= 0 || image.height <= 0) {
    return unexpected(invalid_parameter("image", "must not be empty", image.width));
  }
  PngOptions options;
  options.texts = std::move(texts);
  return encode_png(std::span<const std::uint8_t>(image.bytes), static_cast<std::uint32_t>(image.width),
                    static_cast<std::uint32_t>(image.height), image.channels, options);
}

Expected<std::string> encode_png(const Picture& picture, std::vector<PngText> texts) {
  if (picture.width <= 0 || picture.height <= 0 ||
      picture.rgba.size() != std::size_t(picture.width) * picture.height * 4) {
    return unexpected(invalid_parameter("picture", "must hold four floats a pixel", picture.width));
  }
  return encode_png(develop(picture), std::move(texts));
}

}  // namespace anthesis
