#pragma once
#include <functional>
#include <string_view>

namespace anthesis {

/// Called by long stages with the stage's name and the fraction done, in [0, 1]; returns false to cancel.
/// May be called from any thread, but never from two at once. An empty function means "no one is watching".
using Progress = std::function<bool(std::string_view stage, double fraction)>;

/// Reports to `progress` if there is one; true means go on.
inline bool report(const Progress& progress, std::string_view stage, double fraction) {
  return !progress || progress(stage, fraction);
}

}  // namespace anthesis
