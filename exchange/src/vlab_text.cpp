#include "vlab_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "text.h"

namespace anthesis::detail {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  if (text.starts_with('+') && !text.starts_with("+-")) {
    text.remove_prefix(1);
  }
  const std::from_chars_result result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() && !text.empty();
}

}  // namespace

std::string shown_value(std::string_view value) {
  constexpr std::size_t kMostShown = 40;
  return '"' + valid_utf8(one_line(value.substr(0, kMostShown))) + '"';
}

void append_fixed(std::string& text, double value) {
  char digits[64];  // magnitudes are at most 1e30
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof(digits), value, std::chars_format::fixed, 6);
  text.append(digits, end.ptr);
}

bool VlabText::fits(std::size_t limit) {
  return text_.size() <= limit ||
         fail_at({}, "file",
                 "must have at most " + std::to_string(limit) + " bytes, got " + std::to_string(text_.size()),
                 ErrorCode::kTooLarge);
}

void VlabText::skip_blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) {
    ++at_;
  }
}

void VlabText::new_line() {
  ++line_;
  line_start_ = at_;
}

TextPlace VlabText::place() {
  skip_blanks();
  return {line_, at_ - line_start_ + 1};
}

bool VlabText::at_end() const {
  return std::all_of(text_.begin() + static_cast<std::ptrdiff_t>(at_), text_.end(),
                     [](char c) { return is_blank(c) || c == '\n'; });
}

std::string_view VlabText::peek_word() {
  skip_blanks();
  std::size_t end = at_;
  while (end < text_.size() && !is_blank(text_[end]) && text_[end] != '\n') {
    if (text_[end++] == ':') {
      break;
    }
  }
  return text_.substr(at_, end - at_);
}

std::string_view VlabText::take_word() {
  const std::string_view word = peek_word();
  at_ += word.size();
  return word;
}

bool VlabText::next_is(std::string_view word) {
  return peek_word() == word;
}

bool VlabText::expect(std::string_view word) {
  if (peek_word() != word) {
    return fail("line", "must have \"" + std::string(word) + "\" here");
  }
  at_ += word.size();
  return true;
}

bool VlabText::number(std::string_view what, double& value, double low, double high) {
  const std::string_view word = peek_word();
  double read = 0.0;
  if (!parse(word, read) || !std::isfinite(read)) {
    return fail(what, "must be a number");
  }
  if (!(read >= low && read <= high)) {
    return fail(what, "must be between " + to_text(low) + " and " + to_text(high));
  }
  at_ += word.size();
  value = read;
  return true;
}

bool VlabText::whole(std::string_view what, std::int64_t& value, std::int64_t low, std::int64_t high) {
  const std::string_view word = peek_word();
  std::int64_t read = 0;
  if (!parse(word, read) || read < low || read > high) {
    return fail(what, "must be a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  at_ += word.size();
  value = read;
  return true;
}

std::string_view VlabText::rest_of_line() {
  skip_blanks();
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view rest = text_.substr(at_, end - at_);
  while (!rest.empty() && is_blank(rest.back())) {
    rest.remove_suffix(1);
  }
  at_ = end;
  if (at_ < text_.size()) {
    ++at_;
    new_line();
  }
  return rest;
}

bool VlabText::end_line() {
  skip_blanks();
  if (at_ == text_.size()) {
    return true;
  }
  if (text_[at_] != '\n') {
    return fail("line", "must end here");
  }
  ++at_;
  new_line();
  return true;
}

void VlabText::skip_line_ends() {
  for (skip_blanks(); at_ < text_.size() && text_[at_] == '\n'; skip_blanks()) {
    ++at_;
    new_line();
  }
}

bool VlabText::expect_end() {
  skip_line_ends();
  return at_ == text_.size() || fail("file", "must end here");
}

bool VlabText::fail(std::string_view what, std::string_view rule) {
  const TextPlace here = place();
  const std::string_view word = peek_word();
  const std::string got = !word.empty()         ? shown_value(word)
                          : at_ == text_.size() ? std::string("the end of the file")
                                                : std::string("the end of the line");
  return fail_at(here, what, std::string(rule) + ", got " + got);
}

bool VlabText::fail_at(TextPlace where, std::string_view what, std::string message, ErrorCode code) {
  error.code = code;
  error.where.clear();
  append(error.where, file_name_, ":", where.line, ":", where.column, ": ", what);
  error.message = std::move(message);
  return false;
}

}  // namespace anthesis::detail
