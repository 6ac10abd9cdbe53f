#include "anthesis/base/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <mutex>

namespace anthesis {

bool parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, const Progress& progress,
                  const char* stage) {
  if (!progress) {
    tbb::parallel_for(std::size_t{0}, count, body);
    return true;
  }
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> stopped = false;
  std::mutex reporting;
  const std::size_t step = count / 200 + 1;  // half a percent between reports
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (stopped) {
      return;
    }
    body(i);
    if (++done % step == 0) {
      const std::lock_guard lock(reporting);
      if (!progress(stage, static_cast<double>(done.load()) / static_cast<double>(count))) {
        stopped = true;
      }
    }
  });
  return !stopped;
}

struct ThreadLimit::State {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) {
  if (threads > 0) {
    state_ = std::make_unique<State>(
        State{tbb::global_control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads))});
  }
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace anthesis
