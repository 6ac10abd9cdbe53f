#include "anthesis/base/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <mutex>

namespace anthesis {
namespace {

constexpr std::chrono::milliseconds kLongestSilence(100);  // so that Ctrl-C is heard

}  // namespace

bool parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, const Progress& progress,
                  const char* stage) {
  if (!progress) {
    tbb::parallel_for(std::size_t{0}, count, body);
    return true;
  }
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> stopped = false;
  std::mutex reporting;
  const std::size_t step = count / 200 + 1;  // half a percent between reports, or a tenth of a second if that is sooner
  using Clock = std::chrono::steady_clock;
  std::atomic<Clock::rep> next_report = (Clock::now() + kLongestSilence).time_since_epoch().count();
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (stopped) {
      return;
    }
    body(i);
    const Clock::rep now = Clock::now().time_since_epoch().count();
    if (++done % step == 0 || now >= next_report) {
      const std::lock_guard lock(reporting);
      next_report = now + Clock::duration(kLongestSilence).count();
      if (!progress(stage, static_cast<double>(done.load()) / static_cast<double>(count))) {
        stopped = true;
      }
    }
  });
  return !stopped;
}

// Made in place: the control can be copied, but a copy's end lifts the limit.
struct ThreadLimit::State {
  explicit State(int threads)
      : control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) {
  if (threads > 0) {
    state_ = std::make_unique<State>(threads);
  }
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace anthesis
