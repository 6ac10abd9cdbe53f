#include <benchmark/benchmark.h>

#include <cmath>
#include <limits>

#include "anthesis/base/parallel.h"
#include "anthesis/exchange/harmonic_fields.h"
#include "anthesis/phyllotaxis/active_ring.h"
#include "anthesis/receptacle/contour_sequence.h"
#include "full_scan.h"
#include "published_heads.h"

namespace anthesis {
namespace {

using test::PublishedPattern;

/// Whole heads as O24 has them, one thread. The published program itself takes 47 to 76 s for one.
const PublishedPattern kHeads[] = {PublishedPattern::kBellisReleased, PublishedPattern::kBellisPaper,
                                   PublishedPattern::kSunflower};
const char* const kNames[] = {"Bellis, released", "Bellis, paper", "sunflower"};

bool ready(benchmark::State& state) {
  if (!test::published_heads_are_here()) {
    state.SkipWithError("no reference data; set ANTHESIS_REFERENCE");
    return false;
  }
  if (state.range(0) >= 0) {
    state.SetLabel(kNames[state.range(0)]);
  }
  return true;
}

void BM_ActiveRing(benchmark::State& state, bool as_published) {
  if (!ready(state)) {
    return;
  }
  const PublishedPattern pattern = kHeads[state.range(0)];
  const GrowingReceptacle head(test::head_of(pattern),
                               as_published ? SectionLookup::kAsPublished : SectionLookup::kExact);
  const ActiveRingParams params = test::ring_of(pattern);
  std::size_t size = 0;
  for (auto _ : state) {
    const auto primordia = as_published ? grow_active_ring_as_published(head, params) : grow_active_ring(head, params);
    size = primordia->size();
    benchmark::DoNotOptimize(size);
  }
  state.counters["primordia"] = static_cast<double>(size);
}
BENCHMARK_CAPTURE(BM_ActiveRing, continuous, false)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_ActiveRing, as_published, true)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

/// Baseline: the same outcome as BM_ActiveRing/as_published by asking every angle of every primordium.
void BM_ActiveRingFullScan(benchmark::State& state) {
  if (!ready(state)) {
    return;
  }
  const PublishedPattern pattern = kHeads[state.range(0)];
  const GrowingReceptacle head(test::head_of(pattern), SectionLookup::kAsPublished);
  const ActiveRingParams params = test::ring_of(pattern);
  std::size_t size = 0;
  for (auto _ : state) {
    size = test::full_scan(head, params).size();
    benchmark::DoNotOptimize(size);
  }
  state.counters["primordia"] = static_cast<double>(size);
}
BENCHMARK(BM_ActiveRingFullScan)->DenseRange(0, 2)->Unit(benchmark::kMillisecond)->Iterations(1);

DigitisedHead sunflower() {
  DigitisedHead head = test::published_head("sunflower", true);
  head.scale = 3.0;
  return head;
}

std::vector<double> frame_times() {
  const VlabFunctionTable pace = test::published_function("sunflower", "output_dalpha");
  return *contour_times([&](double time) { return pace(time); });
}

/// 2,214 frames of 79 points.
void BM_ContourSequence(benchmark::State& state, SectionLookup lookup, int threads) {
  if (!ready(state)) {
    return;
  }
  const GrowingReceptacle head(sunflower(), lookup);
  const std::vector<double> times = frame_times();
  const ThreadLimit limit(threads);
  for (auto _ : state) {
    benchmark::DoNotOptimize(sample_contours(head, times));
  }
}
BENCHMARK_CAPTURE(BM_ContourSequence, exact, SectionLookup::kExact, 1)->Arg(-1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_ContourSequence, exact_all_threads, SectionLookup::kExact, 0)
    ->Arg(-1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(BM_ContourSequence, as_published, SectionLookup::kAsPublished, 1)
    ->Arg(-1)
    ->Unit(benchmark::kMillisecond);

/// Baseline: the published walk of 10,000 steps a frame, one after the other on the functions of time.
void BM_ContourSequenceStepByStep(benchmark::State& state) {
  if (!ready(state)) {
    return;
  }
  const GrowingReceptacle head(sunflower(), SectionLookup::kAsPublished);
  const std::vector<double> times = frame_times();
  for (auto _ : state) {
    double sum = 0.0;
    for (const double time : times) {
      Vec2 here = head.point(time, 0.0);
      for (int i = 1; i <= 10'000; ++i) {
        const Vec2 next = head.point(time, 0.0001 * i);
        sum += length(next - here);
        here = next;
      }
    }
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK(BM_ContourSequenceStepByStep)->Arg(-1)->Unit(benchmark::kMillisecond)->Iterations(1);

/// All 219,186 harmonic fields of the sunflower as the bytes of a `.raw` file, on meshes of different density.
void BM_HarmonicFields(benchmark::State& state, int threads) {
  if (!ready(state)) {
    return;
  }
  const GrowingReceptacle head(sunflower(), SectionLookup::kAsPublished);
  const SectionSequence sections = with_base(sample_contours(head, frame_times()));
  const ThreadLimit limit(threads);
  double bytes = 0.0;
  for (auto _ : state) {
    bytes = 0.0;
    const auto growth =
        InteriorGrowth::make(sections, {.mesh = {.max_edge = 1.0 / static_cast<double>(-state.range(0))}});
    (void)write_harmonic_fields(*growth, [&](std::string_view piece) -> std::optional<Error> {
      bytes += static_cast<double>(piece.size());
      return std::nullopt;
    });
  }
  state.SetLabel("edges 1/" + std::to_string(-state.range(0)));
  state.counters["megabytes"] = bytes * 1e-6;
}
BENCHMARK_CAPTURE(BM_HarmonicFields, one_thread, 1)
    ->Arg(-4)
    ->Arg(-8)
    ->Arg(-16)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_HarmonicFields, all_threads, 0)
    ->Arg(-4)
    ->Arg(-8)
    ->Arg(-16)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Baseline: all frames in memory as cages, then one string of them.
void BM_HarmonicFieldsInMemory(benchmark::State& state) {
  if (!ready(state)) {
    return;
  }
  const GrowingReceptacle head(sunflower(), SectionLookup::kAsPublished);
  const SectionSequence sections = with_base(sample_contours(head, frame_times()));
  for (auto _ : state) {
    const auto growth = InteriorGrowth::make(sections, {.mesh = kVlabSectionMesh});
    std::vector<VlabCage> cages;
    (void)growth->weights([&](const HarmonicFrame& frame) {
      VlabCage& cage = cages.emplace_back();
      for (const Vec2 p : frame.mesh.points) {
        cage.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y)});
      }
      cage.triangles.assign(frame.mesh.triangles.begin(), frame.mesh.triangles.end());
      for (const Vec2 p : frame.controls) {
        cage.controls.push_back({static_cast<float>(p.x), static_cast<float>(p.y)});
      }
      for (const double weight : frame.weights) {
        cage.weights.push_back(static_cast<float>(weight));
      }
      return true;
    });
    benchmark::DoNotOptimize(write_vlab_cages(cages));
  }
}
BENCHMARK(BM_HarmonicFieldsInMemory)->Arg(-4)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

/// Making the tables of a head.
void BM_GrowingReceptacle(benchmark::State& state, SectionLookup lookup) {
  if (!ready(state)) {
    return;
  }
  const DigitisedHead head = sunflower();
  for (auto _ : state) {
    const GrowingReceptacle made(head, lookup);
    benchmark::DoNotOptimize(made);
  }
}
BENCHMARK_CAPTURE(BM_GrowingReceptacle, exact, SectionLookup::kExact)->Arg(-1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_GrowingReceptacle, as_published, SectionLookup::kAsPublished)
    ->Arg(-1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace anthesis
