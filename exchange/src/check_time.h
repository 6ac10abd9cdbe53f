#pragma once
#include <optional>

#include "anthesis/base/error.h"

namespace anthesis::detail {

/// Developmental time is in [0, 1]; written so that NaN is refused too.
inline std::optional<Error> check_time(double time) {
  if (!(time >= 0.0 && time <= 1.0)) {
    return invalid_parameter("time", "must be in [0, 1]", time);
  }
  return std::nullopt;
}

}  // namespace anthesis::detail
