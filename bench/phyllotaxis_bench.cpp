#include <benchmark/benchmark.h>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/ridley.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {
namespace {

SurfaceOfRevolution concave_profile() {
  return {{{0, 0}, {1, 0.1}, {1.2, 1.5}, {2.5, 2}, {3, 1.2}}, 3};
}

/// Places and frames of n organs, as every pattern needs them.
void BM_RidleyOnAConcaveProfile(benchmark::State& state) {
  const SurfaceOfRevolution surface = concave_profile();
  const auto n = static_cast<std::size_t>(state.range(0));
  const std::vector<double> areas(n, surface.area_mm2() / static_cast<double>(n));
  std::vector<double> t(n);
  for (auto _ : state) {
    place_organs(surface, areas, SpiralDirection::kFromApex, t);
    for (std::size_t i = 0; i < n; ++i) {
      benchmark::DoNotOptimize(surface.frame(t[i], static_cast<double>(i) * kGoldenAngleRad));
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_RidleyOnAConcaveProfile)->Arg(1'000)->Arg(100'000)->Unit(benchmark::kMillisecond);

/// Baseline: eq. 2 solved as it is usually programmed, by walking the profile in small steps and adding up area.
void BM_RidleyBySteppingAlongTheProfile(benchmark::State& state) {
  const SurfaceOfRevolution surface = concave_profile();
  const auto n = static_cast<std::size_t>(state.range(0));
  const double area = surface.area_mm2() / static_cast<double>(n);
  const double step = 1.0 / (100.0 * static_cast<double>(n));  // a hundred steps an organ: areas within about a percent
  for (auto _ : state) {
    double sum = 0.5 * area;
    std::size_t placed = 0;
    for (double t = 0.5 * step; t < 1.0; t += step) {
      sum += math::kTurnRad * surface.radius_mm(t) * surface.speed_mm(t) * step;
      if (sum >= area) {
        sum -= area;
        benchmark::DoNotOptimize(surface.frame(t, static_cast<double>(placed++) * kGoldenAngleRad));
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_RidleyBySteppingAlongTheProfile)->Arg(1'000)->Arg(100'000)->Unit(benchmark::kMillisecond);

/// Arithmetic limit of the above: one sine and cosine an organ, and nothing else.
void BM_SineAndCosineAlone(benchmark::State& state) {
  for (auto _ : state) {
    for (std::int64_t i = 0; i < state.range(0); ++i) {
      benchmark::DoNotOptimize(math::sin_cos(static_cast<double>(i) * kGoldenAngleRad));
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_SineAndCosineAlone)->Arg(100'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace anthesis
