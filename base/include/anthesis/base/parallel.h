#pragma once
#include <cstddef>
#include <functional>
#include <memory>

#include "anthesis/base/progress.h"

namespace anthesis {

/// Calls `body(i)` once for each i in [0, count), on all permitted threads.
///
/// Results do not depend on the number of threads as long as body(i) writes only to places that belong to i.
/// Returns false if `progress` (reported under `stage` at least every tenth of a second, as far as body(i) is shorter
/// than that) asked to stop; some calls are then missing.
bool parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, const Progress& progress = {},
                  const char* stage = "");

/// While it lives, parallel loops use at most `threads` threads; 0 means one per processor the process may use.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace anthesis
