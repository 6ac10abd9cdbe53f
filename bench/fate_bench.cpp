#include <benchmark/benchmark.h>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/fate/cone.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {
namespace {

constexpr double kConeRad = 1.3;

std::vector<Vec2> disc(std::int64_t florets) {
  std::vector<Vec2> centres(static_cast<std::size_t>(florets));
  place_spiral({}, centres);
  return centres;
}

void BM_ConeRule(benchmark::State& state) {
  const ThreadLimit one_thread(1);
  const std::vector<Vec2> florets = disc(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(nearest_in_cone_mm(florets, {}, kConeRad));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_ConeRule)->Arg(1'000)->Arg(10'000)->Unit(benchmark::kMillisecond);

/// Baseline: equations 4 and 5 as the paper writes them, over all pairs.
void BM_ConeRuleOverAllPairs(benchmark::State& state) {
  const std::vector<Vec2> florets = disc(state.range(0));
  const double cosine = math::cos(kConeRad);
  for (auto _ : state) {
    for (const Vec2 p : florets) {
      const Vec2 outward = normalized(p);
      double nearest = 1e300;
      for (const Vec2 q : florets) {
        const Vec2 to = q - p;
        const double distance = length(to);
        if (distance < nearest && dot(to, outward) > cosine * distance) {
          nearest = distance;
        }
      }
      benchmark::DoNotOptimize(nearest);
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_ConeRuleOverAllPairs)->Arg(1'000)->Arg(10'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace anthesis
