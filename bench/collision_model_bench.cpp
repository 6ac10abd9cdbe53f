#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/collision_model.h"

namespace anthesis {
namespace {

/// Radius of spheres of which about `organs` find a place: each takes 4.52 squares of its radius.
double radius_for(const SurfaceOfRevolution& surface, double organs) {
  return std::sqrt(surface.area_mm2() / (4.52 * organs));
}

SurfaceOfRevolution disc() {
  return {{{0.0, 0.0}, {10.0, 0.0}}, 1};
}

/// From pole to pole, two cubic Bezier curves.
SurfaceOfRevolution sphere() {
  constexpr double kR = 10.0;
  constexpr double kK = 0.5522847498 * kR;
  return SurfaceOfRevolution(
      bezier_chain<Vec2>({{0, kR}, {kK, kR}, {kR, kK}, {kR, 0}, {kR, -kK}, {kK, -kR}, {0, -kR}}, 3));
}

/// As many organs around at any length: a thousand need ten millimetres.
SurfaceOfRevolution long_cylinder(double organs) {
  return {{{10.0, 0.01 * organs}, {10.0, 0.0}}, 1};
}

void place(benchmark::State& state, const CollisionParams& params) {
  std::size_t organs = 0;
  for (auto _ : state) {
    const Expected<CollisionPattern> pattern = place_by_collision(params, 10'000'000);
    organs = pattern ? pattern->organs.size() : 0;
    benchmark::DoNotOptimize(organs);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(organs));
  state.counters["organs"] = static_cast<double>(organs);
}

void BM_CollisionOnADisc(benchmark::State& state) {
  CollisionParams params{.surface = disc()};
  params.radius_mm = radius_for(params.surface, static_cast<double>(state.range(0)));
  place(state, params);
}
BENCHMARK(BM_CollisionOnADisc)->Arg(2'000)->Arg(10'000)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

void BM_CollisionOnASphere(benchmark::State& state) {
  CollisionParams params{.surface = sphere()};
  params.radius_mm = radius_for(params.surface, static_cast<double>(state.range(0)));
  place(state, params);
}
BENCHMARK(BM_CollisionOnASphere)->Arg(2'000)->Arg(10'000)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

void BM_CollisionOnALongCylinder(benchmark::State& state) {
  CollisionParams params{.surface = long_cylinder(static_cast<double>(state.range(0)))};
  params.radius_mm = radius_for(params.surface, static_cast<double>(state.range(0)));
  place(state, params);
}
BENCHMARK(BM_CollisionOnALongCylinder)->Arg(10'000)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

/// Radii from 1.4 to 0.6 of the mean along the profile.
void BM_CollisionOfRadiiByPlace(benchmark::State& state) {
  CollisionParams params{.surface = sphere()};
  const double mean_mm = radius_for(params.surface, static_cast<double>(state.range(0)));
  params.radius_mm = RadiusAlongProfile{FunctionGraph({{0.0, 0.6 * mean_mm}, {1.0, 1.4 * mean_mm}})};
  place(state, params);
}
BENCHMARK(BM_CollisionOfRadiiByPlace)->Arg(20'000)->Unit(benchmark::kMillisecond);

/// Radii that fall organ by organ, under F92's limit.
void BM_CollisionOfFallingRadii(benchmark::State& state) {
  CollisionParams params{.surface = sphere()};
  const auto organs = static_cast<double>(state.range(0));
  const double mean_mm = radius_for(params.surface, organs);
  params.radius_mm = RadiusByIndex{
      [=](std::size_t k) { return mean_mm * std::max(1.4 - 0.8 * static_cast<double>(k) / organs, 0.3); }};
  place(state, params);
}
BENCHMARK(BM_CollisionOfFallingRadii)->Arg(20'000)->Unit(benchmark::kMillisecond);

/// Baseline: F92's own search. Each organ by halving [t_min, t_max], to the last bits as ours, against all earlier
/// organs until one collides, as in its section 2.4. (Halving may miss free places: they are not one interval.)
std::size_t place_as_in_the_paper(const SurfaceOfRevolution& surface, double radius_mm) {
  constexpr int kHalvings = 50;
  std::vector<Vec3> centres;
  const double apart2 = 4.0 * radius_mm * radius_mm;
  for (std::size_t n = 0;; ++n) {
    const auto [sine, cosine] = math::sin_cos(spiral_azimuth_rad(n, kGoldenAngleRad));
    const auto place_at = [&, sine = sine, cosine = cosine](double t) {
      const Vec2 p = surface.profile_mm().at(1.0 - t);
      return Vec3{p.x * cosine, p.x * sine, p.y};
    };
    const auto free_at = [&](double t) {
      const Vec3 place = place_at(t);
      for (const Vec3& centre : centres) {
        const Vec3 apart = place - centre;
        if (dot(apart, apart) < apart2) {
          return false;
        }
      }
      return true;
    };
    if (free_at(0.0)) {
      centres.push_back(place_at(0.0));
      continue;
    }
    if (!free_at(1.0)) {
      return n;
    }
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      (free_at(middle) ? high : low) = middle;
    }
    centres.push_back(place_at(high));
  }
}

/// The time of the baseline is the one reported; `speedup` is against place_by_collision on the same surface, the best
/// of five.
void BM_F92SearchOverAllEarlierOrgans(benchmark::State& state) {
  const SurfaceOfRevolution surface = state.range(1) == 0 ? disc() : sphere();
  CollisionParams params{.surface = surface};
  const double radius_mm = radius_for(surface, static_cast<double>(state.range(0)));
  params.radius_mm = radius_mm;
  // Time of this process, not of the clock on the wall: what others do on the machine is not ours.
  const auto seconds = [](std::clock_t from) { return static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC; };
  double ours_s = 1e9;
  std::size_t ours = 0;
  for (int i = 0; i < 5; ++i) {
    const std::clock_t start = std::clock();
    ours = place_by_collision(params, 10'000'000)->organs.size();
    ours_s = std::min(ours_s, seconds(start));
  }
  double paper_s = 0.0;
  std::size_t paper = 0;
  for (auto _ : state) {
    const std::clock_t start = std::clock();
    paper = place_as_in_the_paper(surface, radius_mm);
    paper_s = seconds(start);
  }
  state.counters["organs_ours"] = static_cast<double>(ours);
  state.counters["organs_paper"] = static_cast<double>(paper);
  state.counters["ours_ms"] = 1e3 * ours_s;
  state.counters["speedup"] = (paper_s / static_cast<double>(paper)) / (ours_s / static_cast<double>(ours));
}
BENCHMARK(BM_F92SearchOverAllEarlierOrgans)
    ->Args({2'400, 0})
    ->Args({20'000, 0})
    ->Args({20'000, 1})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace anthesis
