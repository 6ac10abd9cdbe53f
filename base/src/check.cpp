#include "anthesis/base/check.h"

#include <string>

namespace anthesis {

std::optional<Error> check_number(std::string_view where, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    return invalid_parameter(where, "must be in [" + to_text(low) + ", " + to_text(high) + "]", value);
  }
  return std::nullopt;
}

std::optional<Error> check_whole(std::string_view where, int value, int low, int high) {
  return check_number(where, value, low, high);
}

std::optional<Error> check_range(std::string_view where, const std::array<double, 2>& range, double low, double high) {
  for (const double end : range) {
    if (auto error = check_number(where, end, low, high)) {
      return error;
    }
  }
  if (range[0] > range[1]) {
    return invalid_parameter(where, "must run from low to high", to_text(range[0]) + " to " + to_text(range[1]));
  }
  return std::nullopt;
}

}  // namespace anthesis
