#include "anthesis/base/error.h"

#include <algorithm>
#include <charconv>
#include <vector>

namespace anthesis {

std::string to_text(double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, result.ptr);
}

Error invalid_parameter(std::string_view where, std::string_view rule, std::string_view value) {
  return {ErrorCode::kInvalidParameter, std::string(where), std::string(rule) + ", got " + std::string(value)};
}

Error invalid_parameter(std::string_view where, std::string_view rule, double value) {
  return invalid_parameter(where, rule, to_text(value));
}

std::string to_string(const Error& error) {
  return error.where.empty() ? error.message : error.where + " " + error.message;
}

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::kIo:
      return 74;  // EX_IOERR of sysexits.h
    case ErrorCode::kCrossing:
      return 1;
    case ErrorCode::kCancelled:
      return 130;  // what a shell reports after Ctrl-C
    case ErrorCode::kInvalidParameter:
    case ErrorCode::kUnknownParameter:
    case ErrorCode::kParse:
    case ErrorCode::kTooLarge:
      return 65;  // EX_DATAERR
  }
  return 65;
}

namespace {

/// Optimal string alignment distance: edits and swaps of neighbours.
std::size_t edits_between(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> cost((a.size() + 1) * width);
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      std::size_t& here = cost[i * width + j];
      if (i == 0 || j == 0) {
        here = i + j;
        continue;
      }
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      here = std::min(
          {cost[(i - 1) * width + j] + 1, cost[i * width + j - 1] + 1, cost[(i - 1) * width + j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        here = std::min(here, cost[(i - 2) * width + j - 2] + 1);
      }
    }
  }
  return cost.back();
}

}  // namespace

std::string_view nearest_name(std::string_view name, const std::string_view* names, std::size_t count) {
  constexpr std::size_t kLongestName = 64;  // longer than any of ours: do not let a huge key cost a huge table
  if (name.size() > kLongestName) {
    return {};
  }
  std::string_view best;
  std::size_t best_edits = name.size() / 3 + 1;  // one slip in short words, more in long ones
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t edits = edits_between(name, names[i]);
    if (edits <= best_edits && (best.empty() || edits < best_edits)) {
      best = names[i];
      best_edits = edits;
    }
  }
  return best;
}

}  // namespace anthesis
