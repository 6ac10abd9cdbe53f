#include "anthesis/base/png.h"

#include <gmock/gmock.h>
#include <png.h>

#include <cstring>
#include <numeric>

namespace anthesis {
namespace {

std::vector<std::uint8_t> ramp(std::size_t size) {
  std::vector<std::uint8_t> pixels(size);
  std::iota(pixels.begin(), pixels.end(), std::uint8_t{0});
  return pixels;
}

// Reads the pixels back through libpng's other, simplified interface.
std::vector<std::uint8_t> decode(const std::string& bytes, int channels, png_image& image) {
  std::memset(&image, 0, sizeof(image));
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
  image.format = channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  return pixels;
}

TEST(EncodePng, ReadsBackTheSamePixelsWithAndWithoutAlpha) {
  for (const int channels : {3, 4}) {
    const std::vector<std::uint8_t> pixels = ramp(std::size_t{7} * 5 * static_cast<std::size_t>(channels));
    const Expected<std::string> bytes = encode_png(pixels, 7, 5, channels);
    ASSERT_TRUE(bytes.has_value()) << to_string(bytes.error());
    png_image image;
    EXPECT_EQ(decode(*bytes, channels, image), pixels);
    EXPECT_EQ(image.width, 7u);
    EXPECT_EQ(image.height, 5u);
  }
}

TEST(EncodePng, CarriesItsTextsAndNoTimeOfWriting) {
  const std::vector<std::uint8_t> pixels = ramp(12);
  const PngOptions options{.texts = {{"Software", "Anthesis"}, {"Species", "Lilium × elegans"}}};
  const Expected<std::string> bytes = encode_png(pixels, 2, 2, 3, options);
  ASSERT_TRUE(bytes.has_value());
  EXPECT_THAT(*bytes, testing::HasSubstr("Lilium × elegans"));
  EXPECT_THAT(*bytes, testing::Not(testing::HasSubstr("tIME")));
  EXPECT_EQ(*bytes, *encode_png(pixels, 2, 2, 3, options));
}

TEST(EncodePng, RefusesPixelsThatDoNotFitAndSidesThatAreTooLong) {
  const std::vector<std::uint8_t> pixels = ramp(12);
  EXPECT_EQ(encode_png(pixels, 3, 2, 3).error().where, "pixels");
  EXPECT_EQ(encode_png(pixels, 0, 2, 3).error().where, "pixels");
  EXPECT_EQ(encode_png(pixels, 2, 3, 2).error().where, "channels");
  EXPECT_EQ(encode_png(pixels, 70000, 1, 3).error().code, ErrorCode::kTooLarge);
}

TEST(EncodePng, ReportsWhatLibpngRefuses) {
  const PngOptions options{.texts = {{std::string(100, 'x'), "keyword too long"}}};
  const Expected<std::string> bytes = encode_png(ramp(12), 2, 2, 3, options);
  // libpng shortens or drops a bad keyword with a warning; either way the picture must stay readable.
  if (bytes.has_value()) {
    png_image image;
    EXPECT_EQ(decode(*bytes, 3, image), ramp(12));
  } else {
    EXPECT_EQ(bytes.error().code, ErrorCode::kIo);
  }
}

}  // namespace
}  // namespace anthesis
