#include <benchmark/benchmark.h>

#include <array>
#include <memory>
#include <vector>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/contact/elastic_batch.h"
#include "contact_scene.h"

/// Time of one projection of one constraint, ten sweeps a step, on 154 petals of 19 x 19 vertices that have grown by a
/// fiftieth and shifted. A PBD library in use today takes 73 to 123 ns of one thread and 35 to 38 ns of two for the
/// lengths and dihedral angles of the same file, on the machine where ours were first measured.
namespace anthesis {
namespace {

constexpr int kSweeps = 10;
constexpr std::uint32_t kAttached = 19;  // a side of each petal
constexpr double kPeerOneThread = 73e-9;
constexpr double kPeerTwoThreads = 35e-9;

const ContactScene& scene() {
  static const ContactScene made = [] {
    ContactScene read = read_contact_scene("art_154x19_a05");
    for (std::uint32_t v = 0; read.found() && v < kAttached; ++v) {
      read.sheet.attached.push_back(v);
      read.sheet.attachment_stiffness.push_back(1.0);
    }
    return read;
  }();
  return made;
}

std::vector<std::uint32_t> first_vertices() {
  std::vector<std::uint32_t> first;
  for (std::uint32_t body = 0; body < scene().body_count; ++body) {
    first.push_back(scene().first_vertex(body));
  }
  return first;
}

bool loaded(benchmark::State& state) {
  if (!scene().found()) {
    state.SkipWithError(kNoContactScene);
  }
  return scene().found();
}

void report(benchmark::State& state) {
  const Sheet& sheet = scene().sheet;
  const std::size_t constraints = sheet.edges.size() + sheet.hinges.size() + sheet.attached.size();
  state.counters["per_projection"] =
      benchmark::Counter(static_cast<double>(kSweeps * scene().body_count * constraints),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["peer"] = state.range(0) == 1 ? kPeerOneThread : kPeerTwoThreads;
}

void BM_ElasticSweeps(benchmark::State& state, void (ElasticBatch::*go)(int sweeps)) {
  if (!loaded(state)) {
    return;
  }
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  ElasticBatch batch(scene().sheet);
  batch.set_rest(scene().to_mm, first_vertices());
  std::vector<Vec3> positions = scene().from_mm;
  for (auto _ : state) {
    batch.load(scene().from_mm);
    (batch.*go)(kSweeps);
    batch.store(positions);
    benchmark::DoNotOptimize(positions.data());
  }
  report(state);
}
BENCHMARK_CAPTURE(BM_ElasticSweeps, sweep, &ElasticBatch::sweep)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(BM_ElasticSweeps, settle, &ElasticBatch::settle)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void BM_SetRest(benchmark::State& state) {
  if (!loaded(state)) {
    return;
  }
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  const std::vector<std::uint32_t> first = first_vertices();
  ElasticBatch batch(scene().sheet);
  for (auto _ : state) {
    batch.set_rest(scene().to_mm, first);
  }
}
BENCHMARK(BM_SetRest)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// Baseline: each constraint an object of its own that knows how to project itself, one organ after the other, as PBD
/// libraries keep them.
class Constraint {
 public:
  virtual ~Constraint() = default;
  virtual void project(std::vector<Vec3>& positions) const = 0;
};

class EdgeConstraint : public Constraint {
 public:
  EdgeConstraint(std::uint32_t a, std::uint32_t b, const std::vector<Vec3>& rest)
      : a_(a), b_(b), length_(length(rest[b] - rest[a])) {}
  void project(std::vector<Vec3>& positions) const override {
    const Vec3 along = positions[b_] - positions[a_];
    const double now = length(along);
    const Vec3 shift = 0.5 * (now - length_) / now * along;
    positions[a_] += shift;
    positions[b_] += -shift;
  }

 private:
  std::uint32_t a_, b_;
  double length_;
};

class HingeConstraint : public Constraint {
 public:
  HingeConstraint(const std::array<std::uint32_t, 4>& vertices, const std::vector<Vec3>& rest)
      : vertices_(vertices),
        angle_(hinge_angle_rad(rest[vertices[0]], rest[vertices[1]], rest[vertices[2]], rest[vertices[3]])) {}
  void project(std::vector<Vec3>& positions) const override {
    const Vec3 p = positions[vertices_[0]];
    const Vec3 q = positions[vertices_[1]];
    const Vec3 apex = positions[vertices_[2]];
    const Vec3 other = positions[vertices_[3]];
    const Vec3 edge = q - p;
    const Vec3 normal = cross(edge, apex - p);
    const Vec3 other_normal = cross(other - p, edge);
    const double edge_length = length(edge);
    if (dot(normal, normal) < 1e-20 || dot(other_normal, other_normal) < 1e-20) {
      return;
    }
    const double angle = hinge_angle_rad(p, q, apex, other);
    const std::array<Vec3, 2> heights = {-edge_length / dot(normal, normal) * normal,
                                         -edge_length / dot(other_normal, other_normal) * other_normal};
    const double foot = dot(apex - p, edge) / dot(edge, edge);
    const double other_foot = dot(other - p, edge) / dot(edge, edge);
    const std::array<Vec3, 4> gradient = {-((1.0 - foot) * heights[0] + (1.0 - other_foot) * heights[1]),
                                          -(foot * heights[0] + other_foot * heights[1]), heights[0], heights[1]};
    double error = angle - angle_;
    error = error > math::kPi ? error - math::kTurnRad : error <= -math::kPi ? error + math::kTurnRad : error;
    double sum = 0.0;
    for (const Vec3& g : gradient) {
      sum += dot(g, g);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      positions[vertices_[i]] += -error / sum * gradient[i];
    }
  }

 private:
  std::array<std::uint32_t, 4> vertices_;
  double angle_;
};

class AttachmentConstraint : public Constraint {
 public:
  AttachmentConstraint(std::uint32_t vertex, const std::vector<Vec3>& rest) : vertex_(vertex), place_(rest[vertex]) {}
  void project(std::vector<Vec3>& positions) const override { positions[vertex_] = place_; }

 private:
  std::uint32_t vertex_;
  Vec3 place_;
};

void BM_OneConstraintAtATime(benchmark::State& state) {
  if (!loaded(state)) {
    return;
  }
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  const ContactScene& s = scene();
  std::vector<std::vector<std::unique_ptr<Constraint>>> organs(s.body_count);
  for (std::size_t k = 0; k < organs.size(); ++k) {
    const std::uint32_t first = s.first_vertex(static_cast<std::uint32_t>(k));
    for (const auto& edge : s.sheet.edges) {
      organs[k].push_back(std::make_unique<EdgeConstraint>(first + edge[0], first + edge[1], s.to_mm));
    }
    for (const auto& hinge : s.sheet.hinges) {
      const std::array<std::uint32_t, 4> moved = {first + hinge[0], first + hinge[1], first + hinge[2],
                                                  first + hinge[3]};
      organs[k].push_back(std::make_unique<HingeConstraint>(moved, s.to_mm));
    }
    for (const std::uint32_t vertex : s.sheet.attached) {
      organs[k].push_back(std::make_unique<AttachmentConstraint>(first + vertex, s.to_mm));
    }
  }
  std::vector<Vec3> positions;
  for (auto _ : state) {
    positions = s.from_mm;
    parallel_for(organs.size(), [&](std::size_t k) {
      for (int sweep = 0; sweep < kSweeps; ++sweep) {
        for (const auto& constraint : organs[k]) {
          constraint->project(positions);
        }
      }
    });
    benchmark::DoNotOptimize(positions.data());
  }
  report(state);
}
BENCHMARK(BM_OneConstraintAtATime)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace anthesis
