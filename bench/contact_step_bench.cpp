// One pass of growing sheets in contact and the certificate after it, on the peers' scene: 154 petals of 648 triangles
// in layers half an edge apart, in one step of growth.
//
// No program at hand does all of it. Ten iterations of a library for position-based dynamics and the broad phase,
// narrow phase and audit of ipc-toolkit 1.6.0 add up to peer_ms, the figures of each on the same file on a like
// processor: with additive advancement (Li et al. 2021), and with Tight-Inclusion (Wang et al. 2021) to
// inclusion_peer_ms.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/contact/detector.h"
#include "anthesis/contact/elastic_batch.h"
#include "anthesis/contact/growing_sheets.h"
#include "contact_scene.h"
#include "step_filter.h"

namespace anthesis {
namespace {

constexpr std::uint32_t kVerticesOfBody = ContactScene::kVerticesOfBody;
constexpr int kSweeps = 10;

/// Of one thread and of two.
constexpr double kPeer_ms[] = {837.0, 419.0};
constexpr double kInclusionPeer_ms[] = {1742.0, 822.0};

const ContactScene& scene() {
  static const ContactScene read = read_contact_scene("art_154x19_a05");
  return read;
}

bool loaded(benchmark::State& state) {
  if (!scene().found()) {
    state.SkipWithError(kNoContactScene);
  }
  return scene().found();
}

constexpr double kThicknessShare = 0.1;  // of an edge

/// All petals as they are in the file, which crosses nothing. One pass takes the targets the whole way.
GrowingSheets start() {
  GrowingSheets sheets({scene().sheet}, {.sweeps = kSweeps, .piece = 1.0, .settling_passes = 0});
  GrowingSheets::Snapshot snapshot;
  snapshot.bodies.assign(scene().body_count, {0, kThicknessShare * scene().mean_edge_mm()});
  snapshot.positions_mm = scene().from_mm;
  snapshot.targets_mm = scene().from_mm;
  snapshot.awake.assign(scene().body_count, 1);
  snapshot.wanted_mm.assign(scene().from_mm.size(), 0.0);
  sheets.restore(std::move(snapshot));
  return sheets;
}

/// There and back again, one pass each: the whole step of the file, which moves a vertex by up to two thirds of an
/// edge, or a seventh of it, a piece of the size that growth is done in.
void grow(benchmark::State& state, bool with_audit) {
  if (!loaded(state)) {
    return;
  }
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  GrowingSheets sheets = start();
  std::vector<Vec3> to_mm = scene().to_mm;
  for (std::size_t i = 0; i < to_mm.size(); ++i) {
    to_mm[i] = lerp(scene().from_mm[i], to_mm[i], 0.01 * static_cast<double>(state.range(1)));
  }
  for (int warm_up = 0; warm_up < 2; ++warm_up) {
    benchmark::DoNotOptimize(sheets.advance(warm_up == 0 ? to_mm : scene().from_mm));
  }
  GrowthStep all;
  std::uint64_t crossings = 0;
  bool there = false;
  for (auto _ : state) {
    there = !there;
    const GrowthStep step = *sheets.advance(there ? to_mm : scene().from_mm);
    all.passes += step.passes;
    all.contacts += step.contacts;
    all.shortened += step.shortened;
    if (with_audit) {
      crossings += sheets.audit()->count;
    }
  }
  const auto mean = benchmark::Counter::kAvgIterations;
  state.counters["passes"] = benchmark::Counter(all.passes, mean);
  state.counters["contacts"] = benchmark::Counter(static_cast<double>(all.contacts), mean);
  state.counters["shortened"] = benchmark::Counter(static_cast<double>(all.shortened), mean);
  if (with_audit) {
    state.counters["crossings"] = static_cast<double>(crossings);
    state.counters["peer_ms"] = kPeer_ms[state.range(0) - 1];
    state.counters["inclusion_peer_ms"] = kInclusionPeer_ms[state.range(0) - 1];
  }
}

void BM_PassAndAudit(benchmark::State& state) {
  grow(state, true);
}
BENCHMARK(BM_PassAndAudit)
    ->ArgNames({"threads", "percent"})
    ->ArgsProduct({{1, 2}, {100, 15}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

// Cost by size --------------------------------------------------------------------------------------------------------

/// A disc of tubular florets on Vogel's spiral that grow by a half into each other: cost should be near-linear in their
/// number.
void BM_Florets(benchmark::State& state) {
  constexpr int kSides = 6;
  constexpr int kRings = 7;
  std::vector<Triangle> triangles;
  for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring) {
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t a = ring * kSides + side;
      const std::uint32_t b = ring * kSides + (side + 1) % kSides;
      triangles.push_back({a, b, b + kSides});
      triangles.push_back({a, b + kSides, a + kSides});
    }
  }
  Sheet sheet = make_sheet(kSides * kRings, triangles);
  for (std::uint32_t i = 0; i < 2 * kSides; ++i) {
    sheet.attached.push_back(i);
    sheet.attachment_stiffness.push_back(0.5);
  }
  const auto florets = static_cast<std::size_t>(state.range(0));
  const auto targets_at = [&](double size) {
    std::vector<Vec3> targets;
    for (std::size_t k = 0; k < florets; ++k) {
      const double radius = 1.6 * std::sqrt(static_cast<double>(k) + 0.5);
      const math::SinCos azimuth = math::sin_cos(2.39996322972865332 * static_cast<double>(k));
      for (int i = 0; i < kSides * kRings; ++i) {
        const double height = static_cast<double>(i / kSides) / (kRings - 1);
        const math::SinCos around = math::sin_cos(math::kTurnRad * (i % kSides) / kSides);
        const double wide = size * (0.6 + 0.9 * height * height);
        targets.push_back(
            {radius * azimuth.cos + wide * around.cos, radius * azimuth.sin + wide * around.sin, 6.0 * size * height});
      }
    }
    return targets;
  };
  std::uint64_t crossings = 0;
  for (auto _ : state) {
    GrowingSheets sheets({sheet}, {});
    const std::vector<Vec3> begin = targets_at(0.8);
    for (std::size_t k = 0; k < florets; ++k) {
      sheets.enter({0, 0.04}, std::span(begin).subspan(k * kSides * kRings, kSides * kRings), {});
    }
    for (int step = 1; step <= 10; ++step) {
      benchmark::DoNotOptimize(sheets.advance(targets_at(0.8 + 0.04 * step)));
    }
    crossings += sheets.audit()->count;
  }
  state.counters["crossings"] = static_cast<double>(crossings);
  state.counters["us_per_floret"] = benchmark::Counter(
      static_cast<double>(florets) * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(BM_Florets)->RangeMultiplier(2)->Range(128, 2048)->Unit(benchmark::kMillisecond)->UseRealTime();

// Its parts -----------------------------------------------------------------------------------------------------------

void BM_Pass(benchmark::State& state) {
  grow(state, false);
}
BENCHMARK(BM_Pass)
    ->ArgNames({"threads", "percent"})
    ->ArgsProduct({{1, 2}, {100, 15}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// What the pass looks around for: along each vertex's way and a little more.
struct Surroundings {
  std::vector<Vec3> way_mm;
  std::vector<double> reach_mm;
  std::vector<ContactBody> bodies;
  std::vector<MovingBody> moving;

  Surroundings() {
    const double thickness_mm = kThicknessShare * scene().mean_edge_mm();
    for (std::size_t i = 0; i < scene().from_mm.size(); ++i) {
      way_mm.push_back(scene().to_mm[i] - scene().from_mm[i]);
      reach_mm.push_back(0.7 * thickness_mm + 0.05 * length(way_mm[i]));
    }
    for (std::uint32_t b = 0; b < scene().body_count; ++b) {
      const std::uint32_t first = b * kVerticesOfBody;
      ContactBody body{0, first};
      body.vertex_reach_mm = std::span(reach_mm).subspan(first, kVerticesOfBody);
      body.vertex_way_mm = std::span(way_mm).subspan(first, kVerticesOfBody);
      bodies.push_back(body);
      moving.push_back({first, first + kVerticesOfBody, {}, true});
    }
  }
};

/// All contacts, or those of two petals alone.
void BM_Detector(benchmark::State& state) {
  if (!loaded(state)) {
    return;
  }
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  Surroundings around;
  for (ContactBody& body : around.bodies) {
    body.within = state.range(1) != 0;
  }
  const std::vector<Sheet> sheets = {scene().sheet};
  Detector detector(sheets);
  std::vector<Contact> contacts;
  for (auto _ : state) {
    detector.find_near(scene().from_mm, around.bodies, contacts);
  }
  state.counters["contacts"] = static_cast<double>(contacts.size());
}
BENCHMARK(BM_Detector)
    ->ArgNames({"threads", "within"})
    ->ArgsProduct({{1, 2}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void BM_Filter(benchmark::State& state) {
  if (!loaded(state)) {
    return;
  }
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  const Surroundings around;
  const std::vector<Sheet> sheets = {scene().sheet};
  std::vector<Contact> contacts;
  Detector(sheets).find_near(scene().from_mm, around.bodies, contacts);
  StepFilter filter;
  std::vector<Vec3> to;
  for (auto _ : state) {
    to = scene().to_mm;
    benchmark::DoNotOptimize(
        filter.apply(contacts, around.moving, {around.way_mm, around.reach_mm, around.reach_mm}, scene().from_mm, to));
  }
  state.counters["contacts"] = static_cast<double>(contacts.size());
}
BENCHMARK(BM_Filter)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void BM_Elastic(benchmark::State& state) {
  if (!loaded(state)) {
    return;
  }
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  std::vector<std::uint32_t> first;
  for (std::uint32_t b = 0; b < scene().body_count; ++b) {
    first.push_back(b * kVerticesOfBody);
  }
  ElasticBatch batch(scene().sheet);
  std::vector<Vec3> positions = scene().from_mm;
  for (auto _ : state) {
    batch.set_rest(scene().to_mm, first);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      batch.load(positions);
      batch.settle(1);
      batch.store(positions);
    }
  }
}
BENCHMARK(BM_Elastic)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void BM_Audit(benchmark::State& state) {
  if (!loaded(state)) {
    return;
  }
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  const GrowingSheets sheets = start();
  for (auto _ : state) {
    benchmark::DoNotOptimize(sheets.audit());
  }
}
BENCHMARK(BM_Audit)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace anthesis
