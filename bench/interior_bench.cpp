// Growth of the inside of a head, and its harmonic coordinates, beside what one would write first: a factorisation for
// every field, and every field for a step of growth.
#include <benchmark/benchmark.h>

#include <Eigen/SparseCholesky>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include "anthesis/receptacle/interior_growth.h"

namespace anthesis {
namespace {

/// The sections of a published head.
const SectionSequence& sections(bool is_sunflower) {
  const auto read = [](const char* name) {
    const char* given = std::getenv("ANTHESIS_REFERENCE");
    std::ifstream file(std::filesystem::path(given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT) / name);
    ContourSequence contours;
    std::size_t frames = 0;
    std::size_t points = 0;
    if (!(file >> frames >> points)) {
      std::fprintf(stderr, "no %s\n", name);
      std::exit(1);
    }
    for (std::size_t i = 0; i < points; ++i) {
      int flag = 0;
      file >> flag;
      contours.landmarks.push_back(flag == 1);
    }
    contours.points.resize(frames * points);
    for (ContourPoint& point : contours.points) {
      file >> point.position.x >> point.position.y >> point.s;
    }
    contours.times.resize(frames);
    return with_base(contours);
  };
  static const SectionSequence bellis = read("heads/bellis/bellis.cntrs");
  static const SectionSequence sunflower = read("heads/sunflower/sunflower-regenerated.cntrs");
  return is_sunflower ? sunflower : bellis;
}

/// A whole development, carrying `points` points.
void growth(benchmark::State& bench, bool is_sunflower, std::size_t points, double max_edge = 1.0 / 16) {
  const SectionSequence& all = sections(is_sunflower);
  double mesh_points = 0.0;
  std::size_t triangulations = 0;
  for (auto _ : bench) {
    InteriorGrowth grown = *InteriorGrowth::make(all, {.mesh = {.max_edge = max_edge}});
    std::vector<Vec3> carried;
    for (std::size_t i = 0; i < points; ++i) {
      const double u = static_cast<double>(i % 97) / 97.0;
      const double v = static_cast<double>(i % 89) / 89.0;
      carried.push_back(
          {0.6 * u * (1.0 - v) * all.points[all.points_per_frame - 21].x, 0.0, 0.9 * v * all.points[0].y});
    }
    mesh_points = 0.0;
    for (std::size_t f = 0; f + 1 < grown.frames(); ++f) {
      (void)grown.advance(f);
      (void)grown.carry(carried);
      mesh_points += static_cast<double>(grown.mesh().points.size());
    }
    triangulations = grown.triangulations();
    benchmark::DoNotOptimize(carried.data());
  }
  bench.counters["mesh_points"] = mesh_points / static_cast<double>(all.frames() - 1);
  bench.counters["triangulations"] = static_cast<double>(triangulations);
}
BENCHMARK_CAPTURE(growth, bellis, false, 0)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(growth, bellis_5000_points, false, 5000)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(growth, sunflower, true, 0)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(growth, sunflower_5000_points, true, 5000)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(growth, bellis_edges_of_an_eighth, false, 0, 0.125)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(growth, sunflower_edges_of_an_eighth, true, 0, 0.125)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

/// All fields of all frames, handed out frame by frame.
void weights(benchmark::State& bench, bool is_sunflower) {
  const InteriorGrowth grown = *InteriorGrowth::make(sections(is_sunflower));
  double bytes = 0.0;
  for (auto _ : bench) {
    bytes = 0.0;
    (void)grown.weights([&](const HarmonicFrame& frame) {
      bytes += 4.0 * static_cast<double>(frame.weights.size());
      return true;
    });
  }
  bench.counters["megabytes_as_floats"] = bytes * 1e-6;
}
BENCHMARK_CAPTURE(weights, bellis, false)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(weights, sunflower, true)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);

/// A linear system of the mesh's free points, put together and factorised from nothing as one would write it first.
class FreshSystem {
 public:
  explicit FreshSystem(const SectionMesh& mesh)
      : mesh_(mesh),
        given_(static_cast<int>(mesh.contour_points())),
        free_(static_cast<int>(mesh.points.size()) - given_) {
    std::vector<Eigen::Triplet<double>> entries;
    for_sides([&](int a, int b, double weight) {
      if (a >= 0) {
        entries.emplace_back(a, a, weight);
        if (b >= 0) {
          entries.emplace_back(a, b, -weight);
        }
      }
    });
    Eigen::SparseMatrix<double> matrix(free_, free_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(matrix);
  }

  /// value(i): at point i of contour and base.
  template <class Value>
  Eigen::VectorXd solve(const Value& value) const {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(free_);
    for_sides([&](int a, int b, double weight) {
      if (a >= 0 && b < 0) {
        right[a] += weight * value(static_cast<std::size_t>(b + given_));
      }
    });
    return factor_.solve(right);
  }

 private:
  template <class Body>
  void for_sides(const Body& body) const {
    for (const Triangle& triangle : mesh_.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 p = mesh_.points[triangle[(k + 1) % 3]] - mesh_.points[triangle[k]];
        const Vec2 q = mesh_.points[triangle[(k + 2) % 3]] - mesh_.points[triangle[k]];
        const double weight = 0.5 * dot(p, q) / cross(p, q);
        const int a = static_cast<int>(triangle[(k + 1) % 3]) - given_;
        const int b = static_cast<int>(triangle[(k + 2) % 3]) - given_;
        body(a, b, weight);
        body(b, a, weight);
      }
    }
  }

  const SectionMesh& mesh_;
  int given_;
  int free_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

/// Baseline of `growth`: only its solutions, with a new analysis and factorisation for each of the two components, on
/// the meshes of every 10th frame. Multiply by 10 to compare.
void growth_naive_tenth(benchmark::State& bench, bool is_sunflower) {
  const SectionSequence& all = sections(is_sunflower);
  for (auto _ : bench) {
    bench.PauseTiming();
    InteriorGrowth grown = *InteriorGrowth::make(all);
    bench.ResumeTiming();
    for (std::size_t f = 0; f + 1 < all.frames(); f += 10) {
      bench.PauseTiming();
      (void)grown.advance(f);
      bench.ResumeTiming();
      const SectionMesh& mesh = grown.mesh();
      const std::span<const Vec2> next = all.frame(f + 1);
      for (const bool is_height : {false, true}) {
        const FreshSystem system(mesh);
        benchmark::DoNotOptimize(system.solve([&](std::size_t i) {
          const Vec2 along = mesh.contour_point(i, next) - mesh.points[i];
          return is_height ? along.y : along.x;
        }));
      }
    }
  }
}
BENCHMARK_CAPTURE(growth_naive_tenth, bellis, false)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(3);
BENCHMARK_CAPTURE(growth_naive_tenth, sunflower, true)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(3);

/// Baseline of `weights`: every 100th frame, one factorisation for each field. Multiply by 100 to compare.
void weights_naive_hundredth(benchmark::State& bench, bool is_sunflower) {
  const SectionSequence& all = sections(is_sunflower);
  for (auto _ : bench) {
    bench.PauseTiming();
    InteriorGrowth grown = *InteriorGrowth::make(all);
    bench.ResumeTiming();
    for (std::size_t f = 0; f < all.frames(); f += 100) {
      bench.PauseTiming();
      (void)grown.advance(f);
      bench.ResumeTiming();
      const SectionMesh& mesh = grown.mesh();
      for (std::size_t control = 0; control < all.points_per_frame; ++control) {
        const FreshSystem system(mesh);
        benchmark::DoNotOptimize(system.solve([&](std::size_t i) {
          const SectionPlace& place = mesh.places[i];
          return (place.from == control ? 1.0 - place.t : 0.0) + (place.to == control && place.t > 0.0 ? place.t : 0.0);
        }));
      }
    }
  }
}
BENCHMARK_CAPTURE(weights_naive_hundredth, bellis, false)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(weights_naive_hundredth, sunflower, true)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace
}  // namespace anthesis
