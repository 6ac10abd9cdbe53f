#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "anthesis/base/error.h"

namespace anthesis::detail {

/// Where something stands in a text, from 1.
struct TextPlace {
  std::size_t line = 1;
  std::size_t column = 1;
};

/// Goes through a text of the Virtual Laboratory word by word and notes the first thing that is wrong, with its place.
/// Every function that may fail answers false once it has said why in `error`. A word ends at a blank or after a colon,
/// so that "X:-0.5" is two words. Lines end with LF or CR LF.
class VlabText {
 public:
  VlabText(std::string_view text, std::string_view file_name) : text_(text), file_name_(file_name) {}

  /// False, with the error, for a text longer than `limit` bytes.
  bool fits(std::size_t limit);

  /// Place of the next word of the line, or of the line's end.
  TextPlace place();

  /// Whether nothing but blanks and line ends is left.
  bool at_end() const;

  /// Whether the next word of the line is `word`.
  bool next_is(std::string_view word);

  /// Takes the next word of the line, which must be `word`.
  bool expect(std::string_view word);

  /// Takes the next word of the line; empty at its end.
  std::string_view take_word();

  /// Takes a number, called `what` in an error. Texts hold single precision: at most 1e30 in magnitude.
  bool number(std::string_view what, double& value, double low = -1e30, double high = 1e30);
  bool whole(std::string_view what, std::int64_t& value, std::int64_t low, std::int64_t high);

  /// Takes the rest of the line without blanks at its ends, and the line's end.
  std::string_view rest_of_line();

  /// Nothing more may stand on the line; goes to the next.
  bool end_line();

  /// Goes over line ends: for the few formats that do not mind where lines end.
  void skip_line_ends();

  /// Only blanks may be left of the text.
  bool expect_end();

  bool fail(std::string_view what, std::string_view rule);  ///< at the next word, which is shown
  bool fail_at(TextPlace place, std::string_view what, std::string message, ErrorCode code = ErrorCode::kParse);

  Error error;

 private:
  void skip_blanks();
  std::string_view peek_word();
  void new_line();

  std::string_view text_;
  std::string_view file_name_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  std::size_t line_start_ = 0;
};

/// "got" part of an error: the value, cut short, on one line.
std::string shown_value(std::string_view value);

/// `value` as C's %f writes it, with six digits after the point; text.h has %g.
void append_fixed(std::string& text, double value);

}  // namespace anthesis::detail
