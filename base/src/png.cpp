#include "anthesis/base/png.h"

#include <png.h>

#include <csetjmp>
#include <limits>

namespace anthesis {
namespace {

constexpr std::uint32_t kMaxSide = 65535;

// What libpng's callbacks reach through their pointers. It reports errors by longjmp, so nothing with a destructor may
// come to life between setjmp and png_destroy: everything lives in the caller's frame.
struct Sink {
  std::string bytes;
  std::string error;
};

void append(png_structp png, png_bytep data, png_size_t size) {
  static_cast<Sink*>(png_get_io_ptr(png))->bytes.append(reinterpret_cast<const char*>(data), size);
}

void flush(png_structp) {}

[[noreturn]] void fail(png_structp png, png_const_charp message) {
  static_cast<Sink*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

void write(png_structp png, png_infop info, const png_text* texts, int text_count, png_const_bytep pixels,
           std::uint32_t width, std::uint32_t height, int channels, const PngOptions& options) {
  png_set_compression_level(png, options.compression);
  png_set_IHDR(png, info, width, height, 8, channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (options.srgb_chunk) {
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  }
  png_set_text(png, info, texts, text_count);
  png_write_info(png, info);
  const std::size_t stride = std::size_t{width} * static_cast<std::size_t>(channels);
  for (std::uint32_t row = 0; row < height; ++row) {
    png_write_row(png, pixels + row * stride);
  }
  png_write_end(png, info);
}

}  // namespace

Expected<std::string> encode_png(std::span<const std::uint8_t> pixels, std::uint32_t width, std::uint32_t height,
                                 int channels, const PngOptions& options) {
  if (width > kMaxSide || height > kMaxSide) {
    return unexpected(Error{ErrorCode::kTooLarge, "png", "is at most 65,535 pixels wide and high"});
  }
  if (channels != 3 && channels != 4) {
    return unexpected(invalid_parameter("channels", "must be 3 or 4", channels));
  }
  if (width == 0 || height == 0 || pixels.size() != std::size_t{width} * height * static_cast<std::size_t>(channels)) {
    return unexpected(invalid_parameter("pixels", "must be width x height x channels bytes, and not empty",
                                        static_cast<double>(pixels.size())));
  }

  std::vector<png_text> texts;
  for (const PngText& text : options.texts) {
    png_text entry{};
    entry.compression = PNG_ITXT_COMPRESSION_NONE;
    // libpng's struct is shared with reading and so not const; writing does not change it.
    entry.key = const_cast<char*>(text.keyword.c_str());
    entry.text = const_cast<char*>(text.text.c_str());
    entry.itxt_length = text.text.size();
    texts.push_back(entry);
  }

  Sink sink;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, fail, ignore_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr) {
    png_destroy_write_struct(&png, nullptr);
    return unexpected(Error{ErrorCode::kIo, "png", "libpng could not start"});
  }
  if (setjmp(png_jmpbuf(png)) == 0) {
    png_set_write_fn(png, &sink, append, flush);
    write(png, info, texts.data(), static_cast<int>(texts.size()), pixels.data(), width, height, channels, options);
  }
  png_destroy_write_struct(&png, &info);
  if (!sink.error.empty()) {
    return unexpected(Error{ErrorCode::kIo, "png", sink.error});
  }
  return std::move(sink.bytes);
}

}  // namespace anthesis
