#include "anthesis/render/caption.h"

#include <algorithm>
#include <vector>

#include "glyphs.h"

namespace anthesis {
namespace {

constexpr int kColumns = Glyph::kColumns;
constexpr int kRows = Glyph::kRows;
constexpr int kAdvance = Glyph::kAdvance;
constexpr int kPointsHigh = 200;  // points to an image's height

constexpr Glyph kGlyphs[] = {
    {'(', {2, 4, 8, 8, 8, 4, 2}},        {')', {8, 4, 2, 2, 2, 4, 8}},        {'+', {0, 4, 4, 31, 4, 4, 0}},
    {',', {0, 0, 0, 0, 6, 2, 4}},        {'-', {0, 0, 0, 31, 0, 0, 0}},       {'.', {0, 0, 0, 0, 0, 12, 12}},
    {'/', {1, 2, 2, 4, 8, 8, 16}},       {'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},
    {'2', {14, 17, 1, 6, 8, 16, 31}},    {'3', {14, 17, 1, 6, 1, 17, 14}},    {'4', {2, 6, 10, 18, 31, 2, 2}},
    {'5', {31, 16, 30, 1, 1, 17, 14}},   {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 8, 8, 8}},
    {'8', {14, 17, 17, 14, 17, 17, 14}}, {'9', {14, 17, 17, 15, 1, 2, 12}},   {':', {0, 12, 12, 0, 12, 12, 0}},
    {'=', {0, 0, 31, 0, 31, 0, 0}},      {'?', {14, 17, 1, 6, 4, 0, 4}},      {'A', {14, 17, 17, 31, 17, 17, 17}},
    {'B', {30, 17, 17, 30, 17, 17, 30}}, {'C', {14, 17, 16, 16, 16, 17, 14}}, {'D', {30, 17, 17, 17, 17, 17, 30}},
    {'E', {31, 16, 16, 30, 16, 16, 31}}, {'F', {31, 16, 16, 30, 16, 16, 16}}, {'G', {14, 17, 16, 23, 17, 17, 15}},
    {'H', {17, 17, 17, 31, 17, 17, 17}}, {'I', {14, 4, 4, 4, 4, 4, 14}},      {'J', {1, 1, 1, 1, 1, 17, 14}},
    {'K', {17, 18, 20, 24, 20, 18, 17}}, {'L', {16, 16, 16, 16, 16, 16, 31}}, {'M', {17, 27, 21, 21, 17, 17, 17}},
    {'N', {17, 25, 21, 19, 17, 17, 17}}, {'O', {14, 17, 17, 17, 17, 17, 14}}, {'P', {30, 17, 17, 30, 16, 16, 16}},
    {'Q', {14, 17, 17, 17, 21, 18, 13}}, {'R', {30, 17, 17, 30, 20, 18, 17}}, {'S', {15, 16, 16, 14, 1, 1, 30}},
    {'T', {31, 4, 4, 4, 4, 4, 4}},       {'U', {17, 17, 17, 17, 17, 17, 14}}, {'V', {17, 17, 17, 17, 17, 10, 4}},
    {'W', {17, 17, 17, 21, 21, 27, 17}}, {'X', {17, 17, 10, 4, 10, 17, 17}},  {'Y', {17, 17, 10, 4, 4, 4, 4}},
    {'Z', {31, 1, 2, 4, 8, 16, 31}},     {'[', {7, 4, 4, 4, 4, 4, 7}},        {']', {28, 4, 4, 4, 4, 4, 28}},
    {'_', {0, 0, 0, 0, 0, 0, 31}},       {'a', {0, 0, 14, 1, 15, 17, 15}},    {'b', {16, 16, 30, 17, 17, 17, 30}},
    {'c', {0, 0, 14, 17, 16, 17, 14}},   {'d', {1, 1, 15, 17, 17, 17, 15}},   {'e', {0, 0, 14, 17, 31, 16, 14}},
    {'f', {6, 9, 8, 28, 8, 8, 8}},       {'g', {0, 0, 15, 17, 15, 1, 14}},    {'h', {16, 16, 30, 17, 17, 17, 17}},
    {'i', {4, 0, 12, 4, 4, 4, 14}},      {'j', {2, 0, 6, 2, 2, 18, 12}},      {'k', {16, 16, 18, 20, 24, 20, 18}},
    {'l', {12, 4, 4, 4, 4, 4, 14}},      {'m', {0, 0, 26, 21, 21, 21, 21}},   {'n', {0, 0, 30, 17, 17, 17, 17}},
    {'o', {0, 0, 14, 17, 17, 17, 14}},   {'p', {0, 0, 30, 17, 30, 16, 16}},   {'q', {0, 0, 15, 17, 15, 1, 1}},
    {'r', {0, 0, 22, 25, 16, 16, 16}},   {'s', {0, 0, 15, 16, 14, 1, 30}},    {'t', {8, 8, 28, 8, 8, 9, 6}},
    {'u', {0, 0, 17, 17, 17, 19, 13}},   {'v', {0, 0, 17, 17, 17, 10, 4}},    {'w', {0, 0, 17, 21, 21, 21, 10}},
    {'x', {0, 0, 17, 10, 4, 10, 17}},    {'y', {0, 0, 17, 17, 15, 1, 14}},    {'z', {0, 0, 31, 2, 4, 8, 31}}};

/// A point of the text, `margin` pixels wider on all sides.
void fill(Image& image, int x, int y, int size, int margin, std::uint8_t value) {
  for (int row = std::max(0, y - margin); row < std::min(image.height, y + size + margin); ++row) {
    for (int column = std::max(0, x - margin); column < std::min(image.width, x + size + margin); ++column) {
      std::uint8_t* pixel =
          image.bytes.data() + (static_cast<std::size_t>(row) * image.width + column) * image.channels;
      std::fill_n(pixel, 3, value);
      if (image.channels == 4) {
        pixel[3] = 255;
      }
    }
  }
}

/// One line, `top` rows from the upper edge.
void write_line(Image& image, std::string_view line, int top, int size) {
  const std::size_t fits = static_cast<std::size_t>(image.width / (kAdvance * size));
  line.remove_prefix(line.size() - std::min(line.size(), fits));
  const int left = (image.width - static_cast<int>(line.size()) * kAdvance * size) / 2;
  for (const bool rim : {true, false}) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Glyph& glyph = glyph_of(line[i]);
      for (int row = 0; row < kRows && line[i] != ' '; ++row) {
        for (int column = 0; column < kColumns; ++column) {
          if (glyph.lit(column, row)) {
            const int x = left + (static_cast<int>(i) * kAdvance + column) * size;
            fill(image, x, top + row * size, size, rim ? std::max(1, size / 2) : 0, rim ? 0 : 240);
          }
        }
      }
    }
  }
}

}  // namespace

const Glyph& glyph_of(char character) {
  const auto named = [](char c) { return [c](const Glyph& g) { return g.character == c; }; };
  const Glyph* found = std::find_if(std::begin(kGlyphs), std::end(kGlyphs), named(character));
  return found != std::end(kGlyphs) ? *found : *std::find_if(std::begin(kGlyphs), std::end(kGlyphs), named('?'));
}

void write_caption(Image& image, std::string_view text) {
  std::vector<std::string_view> lines;
  std::size_t longest = 1;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    longest = std::max(longest, end);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const std::size_t fits = static_cast<std::size_t>(image.width) / (longest * kAdvance);
  const int size = std::clamp(std::min(static_cast<int>(fits), image.height / kPointsHigh), 1, 64);
  int top = image.height;
  for (std::size_t i = lines.size(); i-- > 0;) {
    top -= (kRows + 3) * size;
    write_line(image, lines[i], top, size);
  }
}

}  // namespace anthesis
