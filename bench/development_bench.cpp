#include <benchmark/benchmark.h>

#include "anthesis/exchange/glb.h"
#include "anthesis/exchange/species_file.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {
namespace {

const Species& sunflower() {
  static const Species species = *find_species("sunflower");
  return species;
}

void BM_GrowASunflower(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(Development::grow(sunflower(), {}));
  }
}
BENCHMARK(BM_GrowASunflower)->Unit(benchmark::kMillisecond);

void BM_SunflowerAtATime(benchmark::State& state) {
  const Development development = *Development::grow(sunflower(), {});
  for (auto _ : state) {
    benchmark::DoNotOptimize(development.at(0.8));
  }
}
BENCHMARK(BM_SunflowerAtATime)->Unit(benchmark::kMillisecond);

/// Baseline of the next: the bytes of a GLB cannot be had for less than a copy of them.
void BM_CopyTheBytesOfAGlb(benchmark::State& state) {
  const Development development = *Development::grow(sunflower(), {});
  const std::string bytes = *to_glb(development, {});
  for (auto _ : state) {
    std::string copy = bytes;
    benchmark::DoNotOptimize(copy.data());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}
BENCHMARK(BM_CopyTheBytesOfAGlb)->Unit(benchmark::kMillisecond);

void BM_WriteAGlb(benchmark::State& state) {
  const Development development = *Development::grow(sunflower(), {});
  std::size_t bytes = 0;
  for (auto _ : state) {
    bytes += to_glb(development, {})->size();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
}
BENCHMARK(BM_WriteAGlb)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace anthesis
