#include <benchmark/benchmark.h>

#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/phyllotaxis/parastichies.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {
namespace {

std::vector<PatternOrgan> disc(std::size_t count) {
  std::vector<Vec2> places(count);
  place_spiral({}, places);
  std::vector<PatternOrgan> organs;
  for (const Vec2 place : places) {
    organs.push_back({math::atan2(place.y, place.x), length(place), length(place), 0.0});
  }
  return organs;
}

/// Everything: neighbours, families, regions, dislocations, divergences.
void BM_Parastichies(benchmark::State& state) {
  const std::vector<PatternOrgan> organs = disc(static_cast<std::size_t>(state.range(0)));
  const ThreadLimit threads(static_cast<int>(state.range(1)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(analyse_parastichies(organs));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_Parastichies)
    ->ArgNames({"organs", "threads"})
    ->Args({1'000, 1})
    ->Args({10'000, 1})
    ->Args({100'000, 1})
    ->Args({100'000, 0})
    ->Unit(benchmark::kMillisecond);

/// Baseline: only the four nearest neighbours of each organ, by looking at all others, as scripts do it.
void BM_NeighboursByAllPairs(benchmark::State& state) {
  const std::vector<PatternOrgan> organs = disc(static_cast<std::size_t>(state.range(0)));
  std::vector<Vec3> places;
  for (const PatternOrgan& organ : organs) {
    const auto [sin, cos] = math::sin_cos(organ.azimuth_rad);
    places.push_back({organ.radius_mm * cos, organ.radius_mm * sin, organ.height_mm});
  }
  for (auto _ : state) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::array<std::pair<double, std::size_t>, 4> nearest;
      nearest.fill({1e300, 0});
      for (std::size_t k = 0; k < places.size(); ++k) {
        const Vec3 away = places[k] - places[i];
        std::pair<double, std::size_t> one = {dot(away, away), k};
        if (k == i || one.first >= nearest[3].first) {
          continue;
        }
        for (std::pair<double, std::size_t>& place : nearest) {
          if (one.first < place.first) {
            std::swap(one, place);
          }
        }
      }
      benchmark::DoNotOptimize(nearest);
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_NeighboursByAllPairs)
    ->ArgName("organs")
    ->Arg(1'000)
    ->Arg(10'000)
    ->Arg(100'000)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace anthesis
