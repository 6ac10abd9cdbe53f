#pragma once
#include <array>
#include <optional>
#include <string_view>

#include "anthesis/base/error.h"

namespace anthesis {

// What is wrong with a value that other people give, if anything: kInvalidParameter for the field `where`. NaN is in no
// range.

std::optional<Error> check_number(std::string_view where, double value, double low, double high);
std::optional<Error> check_whole(std::string_view where, int value, int low, int high);

/// A range [lowest, highest] within [low, high].
std::optional<Error> check_range(std::string_view where, const std::array<double, 2>& range, double low, double high);

}  // namespace anthesis
