#pragma once
#include <charconv>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace anthesis::detail {

/// Appends the shortest text that reads back as the same number, with a point whatever the locale.
template <class Number>
void append_number(std::string& text, Number value) {
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof(digits), value);
  text.append(digits, end.ptr);
}

/// Appends the shortest text of six significant digits, as C's %g: "0.3" for 0.30000000000000004.
inline void append_short(std::string& text, double value) {
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof(digits), value, std::chars_format::general, 6);
  text.append(digits, end.ptr);
}

inline std::string short_text(double value) {
  std::string text;
  append_short(text, value);
  return text;
}

/// Appends the pieces one after the other: text as it is, numbers by append_number.
template <class... Pieces>
void append(std::string& text, const Pieces&... pieces) {
  const auto one = [&text](const auto& piece) {
    if constexpr (std::convertible_to<decltype(piece), std::string_view>) {
      text.append(std::string_view(piece));
    } else {
      append_number(text, piece);
    }
  };
  (one(pieces), ...);
}

/// `text` on one line: control characters become spaces, so that it may stand in a comment line of any format.
inline std::string one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      c = ' ';
    }
  }
  return line;
}

/// `text` with every byte that is not part of well-formed UTF-8 turned into '?', as JSON needs it.
std::string valid_utf8(std::string_view text);

/// A name without blanks, for formats whose names end at one.
inline std::string one_word(std::string_view text) {
  std::string word = one_line(text);
  for (char& c : word) {
    if (c == ' ') {
      c = '_';
    }
  }
  return word.empty() ? "unnamed" : word;
}

}  // namespace anthesis::detail
