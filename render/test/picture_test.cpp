#include "anthesis/render/picture.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace anthesis {
namespace {

Picture gradient(bool transparent) {
  Picture picture;
  picture.width = 37;
  picture.height = 23;
  picture.backdrop.transparent = transparent;
  for (int i = 0; i < 37 * 23; ++i) {
    const float coverage = static_cast<float>(i % 5) / 4.0F;
    picture.rgba.insert(picture.rgba.end(), {coverage * 0.9F, coverage * 0.5F, coverage * 0.05F, coverage});
  }
  return picture;
}

/// Reads a PNG in memory by libpng's simple interface, and its texts by the full one.
struct Read {
  std::vector<png_byte> pixels;
  int width = 0;
  int height = 0;
  std::vector<std::pair<std::string, std::string>> texts;
  bool time = false;
};

Read read(const std::string& bytes, int channels) {
  Read result;
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
  image.format = channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  result.width = static_cast<int>(image.width);
  result.height = static_cast<int>(image.height);
  result.pixels.resize(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, result.pixels.data(), 0, nullptr), 0);

  png_structp reader = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(reader);
  struct Source {
    const char* at;
  } source{bytes.data()};
  png_set_read_fn(reader, &source, [](png_structp png, png_bytep out, std::size_t count) {
    auto* from = static_cast<Source*>(png_get_io_ptr(png));
    std::memcpy(out, from->at, count);
    from->at += count;
  });
  png_read_png(reader, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_textp texts = nullptr;
  int count = 0;
  png_get_text(reader, info, &texts, &count);
  for (int i = 0; i < count; ++i) {
    result.texts.emplace_back(texts[i].key, texts[i].text);
  }
  result.time = png_get_valid(reader, info, PNG_INFO_tIME) != 0;
  png_destroy_read_struct(&reader, &info, nullptr);
  return result;
}

TEST(EncodePng, PixelsAndTextsComeBack) {
  for (const bool transparent : {false, true}) {
    const Picture picture = gradient(transparent);
    const Image image = develop(picture);
    const auto bytes = encode_png(picture, {{"Software", "Anthesis"}, {"Species", "Helianthus annuus"}});
    ASSERT_TRUE(bytes.has_value());
    const Read back = read(*bytes, image.channels);
    EXPECT_EQ(back.width, 37);
    EXPECT_EQ(back.height, 23);
    EXPECT_TRUE(std::ranges::equal(back.pixels, image.bytes));
    ASSERT_EQ(back.texts.size(), 2U);
    EXPECT_EQ(back.texts[1].first, "Species");
    EXPECT_EQ(back.texts[1].second, "Helianthus annuus");
    EXPECT_FALSE(back.time);
    EXPECT_EQ(*bytes, *encode_png(picture, {{"Software", "Anthesis"}, {"Species", "Helianthus annuus"}}));
  }
}

TEST(EncodePng, RefusesAnEmptyPicture) {
  EXPECT_FALSE(encode_png(Picture{}).has_value());
}

TEST(Develop, BackdropIsShownAsStatedAndAlphaIsCoverage) {
  Picture picture = gradient(false);
  std::ranges::fill(picture.rgba, 0.0F);
  picture.backdrop.centre = picture.backdrop.corner = *parse_colour("#8040c0");
  const Image image = develop(picture);
  for (std::size_t i = 0; i < image.bytes.size(); i += 3) {
    EXPECT_NEAR(image.bytes[i], 0x80, 1);
    EXPECT_NEAR(image.bytes[i + 1], 0x40, 1);
    EXPECT_NEAR(image.bytes[i + 2], 0xc0, 1);
  }
  const Image clear = develop(gradient(true));
  for (int i = 0; i < 37 * 23; ++i) {
    EXPECT_NEAR(clear.bytes[4 * i + 3], 255.0 * (i % 5) / 4.0, 1.0);
  }
}

TEST(Tone, RisesAndNeverPassesWhite) {
  double before = -1.0;
  for (double x = 0.0; x < 50.0; x = x * 1.1 + 0.001) {
    const double y = tone({x, x, x}).g;
    EXPECT_GE(y, before);
    EXPECT_LE(y, 1.0);
    before = y;
  }
  EXPECT_NEAR(tone({0.5, 0.5, 0.5}).g, 0.5, 0.06);
  EXPECT_GT(tone({1.6, 1.6, 1.6}).g, 0.85);
}

TEST(Tone, KeepsTheHueAndSaturationOfABrightYellow) {
  const Colour yellow = {1.6, 1.1, 0.02};
  const Colour shown = tone(yellow);
  EXPECT_NEAR(shown.g / shown.r, 1.1 / 1.6, 1e-9);
  EXPECT_NEAR(shown.b / shown.r, 0.02 / 1.6, 1e-9);
}

TEST(ContactSheet, PutsImagesInRowsAndFillsTheRest) {
  std::vector<Image> images;
  for (std::uint8_t shade = 1; shade <= 3; ++shade) {
    images.push_back({2, 1, 3, {shade, shade, shade, 9, 9, shade}});
  }
  const Image sheet = contact_sheet(images, 2);
  EXPECT_EQ(sheet.width, 4);
  EXPECT_EQ(sheet.height, 2);
  EXPECT_EQ(sheet.bytes, (std::vector<std::uint8_t>{1, 1, 1, 9, 9, 1, 2, 2, 2, 9, 9, 2,  //
                                                    3, 3, 3, 9, 9, 3, 3, 3, 3, 3, 3, 3}));
}

}  // namespace
}  // namespace anthesis
