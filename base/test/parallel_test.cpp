#include "anthesis/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace anthesis {
namespace {

TEST(ParallelFor, CallsEachIndexOnceForAnyNumberOfThreads) {
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    std::vector<int> calls(10'000);
    EXPECT_TRUE(parallel_for(calls.size(), [&](std::size_t i) { ++calls[i]; }));
    EXPECT_EQ(calls, std::vector<int>(10'000, 1));
  }
}

TEST(ThreadLimit, OneMeansThatOnlyTheCallerWorks) {
  const ThreadLimit limit(1);
  std::mutex adding;
  std::set<std::thread::id> workers;
  parallel_for(1'000, [&](std::size_t) {
    std::this_thread::sleep_for(std::chrono::microseconds(50));
    const std::lock_guard lock(adding);
    workers.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(workers, std::set<std::thread::id>{std::this_thread::get_id()});
}

TEST(ParallelFor, ReportsRisingFractionsAndStopsWhenAsked) {
  double last = 0.0;
  std::atomic<int> calls = 0;
  const bool finished = parallel_for(
      100'000, [&](std::size_t) { ++calls; },
      [&](std::string_view stage, double fraction) {
        EXPECT_EQ(stage, "counting");
        EXPECT_GE(fraction, last);
        last = fraction;
        return fraction < 0.5;
      },
      "counting");
  EXPECT_FALSE(finished);
  EXPECT_GE(last, 0.5);
  EXPECT_LT(calls, 100'000);
}

}  // namespace
}  // namespace anthesis
