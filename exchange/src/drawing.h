#pragma once
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "text.h"

/// Pieces of SVG drawings in our style.
namespace anthesis::detail {

inline constexpr char kFont[] = "Helvetica, Arial, 'Liberation Sans', sans-serif";
inline constexpr char kInk[] = "#222222";
inline constexpr char kFaint[] = "#8a8a8a";

/// Two decimals are a hundredth of a pixel; trailing zeros go.
inline std::string px(double value) {
  char digits[64];
  const std::to_chars_result end =
      std::to_chars(digits, digits + sizeof(digits), std::clamp(value, -1e9, 1e9), std::chars_format::fixed, 2);
  std::string text(digits, end.ptr);
  while (text.back() == '0') {
    text.pop_back();
  }
  if (text.back() == '.') {
    text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

inline std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : one_line(text)) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

inline std::string attribute(std::string_view name, std::string_view value) {
  std::string text;
  append(text, " ", name, "=\"", escaped(value), "\"");
  return text;
}

inline void open_svg(std::string& svg, double width, double height, std::string_view title) {
  append(svg, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"",
         attribute("width", px(width)), attribute("height", px(height)),
         attribute("viewBox", "0 0 " + px(width) + " " + px(height)), attribute("font-family", kFont),
         attribute("fill", kInk), ">\n<title>", escaped(title),
         "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n");
}

inline void text_at(std::string& svg, double x, double y, double size, std::string_view anchor, std::string_view colour,
                    std::string_view words, std::string_view more = "") {
  append(svg, "<text", attribute("x", px(x)), attribute("y", px(y)), attribute("font-size", px(size)),
         attribute("text-anchor", anchor), attribute("fill", colour), more, ">", escaped(words), "</text>\n");
}

inline void line(std::string& svg, double x0, double y0, double x1, double y1, std::string_view colour, double width,
                 std::string_view more = "") {
  append(svg, "<line", attribute("x1", px(x0)), attribute("y1", px(y0)), attribute("x2", px(x1)),
         attribute("y2", px(y1)), attribute("stroke", colour), attribute("stroke-width", px(width)), more, "/>\n");
}

/// The colour at `share` of the way, 0 to 1, through stops (red, green, blue; 0 to 255) at equal distances.
template <std::size_t kStops>
std::string blended(const std::array<std::array<double, 3>, kStops>& stops, double share) {
  constexpr char kDigits[] = "0123456789abcdef";
  const double place = static_cast<double>(kStops - 1) * std::clamp(share, 0.0, 1.0);
  const std::size_t i = std::min(static_cast<std::size_t>(place), kStops - 2);
  const double f = place - static_cast<double>(i);
  std::string colour = "#";
  for (std::size_t c = 0; c < 3; ++c) {
    const long value = std::lround((1.0 - f) * stops[i][c] + f * stops[i + 1][c]);
    colour += kDigits[value / 16];
    colour += kDigits[value % 16];
  }
  return colour;
}

/// Green young, 0, over yellow to red old, 1.
inline std::string age_colour(double age) {
  constexpr std::array<std::array<double, 3>, 3> kStops = {{{58, 166, 85}, {232, 198, 58}, {200, 55, 45}}};
  return blended(kStops, age);
}

}  // namespace anthesis::detail
