// Veins of whole heads, and the searches in them beside the plain ones: linear searches, all cones against all, mean
// value coordinates by their angles.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "../vasculature/test/own_heads.h"
#include "../vasculature/test/published_heads.h"
#include "anthesis/base/math.h"
#include "anthesis/base/random.h"
#include "anthesis/vasculature/mean_value_growth.h"
#include "anthesis/vasculature/vasculature.h"
#include "vein_visibility.h"
#include "vertex_grid.h"

namespace anthesis {
namespace {

// ---- whole heads ----------------------------------------------------------------------------------------------------

void grow(benchmark::State& state, const VeinParams& params, const OutlineSequence& outlines,
          const std::vector<VeinPrimordium>& primordia) {
  const HeadGrowth growth = mean_value_growth(outlines);
  VeinOptions options;
  options.stride = static_cast<std::uint32_t>(state.range(0));
  std::size_t vertices = 0;
  for (auto _ : state) {
    const Expected<Vasculature> veins = grow_veins(params, growth, primordia, options);
    vertices = veins ? veins->vertices.size() : 0;
  }
  state.counters["vertices"] = static_cast<double>(vertices);
}

void bellis(benchmark::State& state) {
  if (!test::has_published_heads()) {
    state.SkipWithError("no published heads; set ANTHESIS_REFERENCE");
    return;
  }
  const test::PublishedHead head = test::published_bellis();
  grow(state, bellis_veins(VeinSource::kAsPublished), head.outlines, head.primordia);
}
BENCHMARK(bellis)->Arg(8)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();

void sunflower(benchmark::State& state) {
  if (!test::has_published_heads()) {
    state.SkipWithError("no published heads; set ANTHESIS_REFERENCE");
    return;
  }
  const test::PublishedHead head = test::published_sunflower();
  grow(state, sunflower_veins(VeinSource::kAsPublished), head.outlines, head.primordia);
}
BENCHMARK(sunflower)->Arg(8)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();

void gerbera_of_our_own(benchmark::State& state) {
  const test::SaucerHead head = test::saucer_head();
  grow(state, gerbera_veins(VeinSource::kAsPublished), head.outlines, head.primordia);
}
BENCHMARK(gerbera_of_our_own)->Arg(8)->Unit(benchmark::kMillisecond)->UseRealTime();

// ---- searches -------------------------------------------------------------------------------------------------------

/// Strands of a small head: 20,000 vertices or so, with their resistance.
struct Strands {
  std::vector<Vec3> positions;
  std::vector<double> resistances;
  std::vector<std::uint32_t> indices;
  std::vector<Vec3> tips;
};

const Strands& strands() {
  static const Strands made = [] {
    const test::SaucerHead head = test::saucer_head(600, 0.5);
    Strands strands;
    const Expected<Vasculature> veins =
        grow_veins(gerbera_veins(VeinSource::kAsPublished), mean_value_growth(head.outlines), head.primordia);
    for (const VeinVertex& v : veins->vertices) {
      if (std::isfinite(v.resistance)) {
        strands.indices.push_back(static_cast<std::uint32_t>(strands.positions.size()));
        strands.positions.push_back(v.position);
        strands.resistances.push_back(v.resistance);
      }
    }
    Rng rng(1, 1, RandomPurpose::kTest);
    for (int i = 0; i < 64; ++i) {
      const auto near = static_cast<std::size_t>(rng.uniform() * static_cast<double>(strands.positions.size()));
      strands.tips.push_back(strands.positions[near] +
                             Vec3{rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3)});
    }
    return strands;
  }();
  return made;
}

constexpr double kGround = 6.98;

void least_resistance_grid(benchmark::State& state) {
  const Strands& all = strands();
  veins::VertexGrid grid;
  grid.build(all.positions, all.resistances, all.indices, 0.03);
  std::size_t k = 0;
  for (auto _ : state) {
    const Vec3 p = all.tips[k++ % all.tips.size()];
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t best = 0;
    grid.below(
        p, [](double square, double resistance) { return kGround * std::sqrt(square) + resistance; },
        [&] { return least; },
        [&](std::uint32_t v) {
          const double score = kGround * length(all.positions[v] - p) + all.resistances[v];
          if (score < least) {
            least = score;
            best = v;
          }
        });
    benchmark::DoNotOptimize(best);
  }
  state.counters["vertices"] = static_cast<double>(all.positions.size());
}
BENCHMARK(least_resistance_grid);

void least_resistance_linear(benchmark::State& state) {
  const Strands& all = strands();
  std::size_t k = 0;
  for (auto _ : state) {
    const Vec3 p = all.tips[k++ % all.tips.size()];
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t best = 0;
    for (const std::uint32_t v : all.indices) {
      const double score = kGround * length(all.positions[v] - p) + all.resistances[v];
      if (score < least) {
        least = score;
        best = v;
      }
    }
    benchmark::DoNotOptimize(best);
  }
}
BENCHMARK(least_resistance_linear);

void nearest_grid(benchmark::State& state) {
  const Strands& all = strands();
  veins::VertexGrid grid;
  grid.build(all.positions, {}, all.indices, 0.03);
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(grid.nearest(all.tips[k++ % all.tips.size()]));
  }
}
BENCHMARK(nearest_grid);

void nearest_linear(benchmark::State& state) {
  const Strands& all = strands();
  std::size_t k = 0;
  for (auto _ : state) {
    const Vec3 p = all.tips[k++ % all.tips.size()];
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t best = 0;
    for (const std::uint32_t v : all.indices) {
      const Vec3 way = all.positions[v] - p;
      if (dot(way, way) < least) {
        least = dot(way, way);
        best = v;
      }
    }
    benchmark::DoNotOptimize(best);
  }
}
BENCHMARK(nearest_linear);

void grid_build(benchmark::State& state) {
  const Strands& all = strands();
  veins::VertexGrid grid;
  for (auto _ : state) {
    grid.build(all.positions, all.resistances, all.indices, 0.03);
    benchmark::DoNotOptimize(grid);
  }
}
BENCHMARK(grid_build)->Unit(benchmark::kMicrosecond);

void visible(benchmark::State& state) {
  const Strands& all = strands();
  std::size_t k = 0;
  for (auto _ : state) {
    std::size_t seen = 0;
    veins::visit_visible(all.tips[k++ % 8], all.positions, all.indices, 0.01, [&](std::uint32_t, double) {
      ++seen;
      return true;
    });
    benchmark::DoNotOptimize(seen);
  }
}
BENCHMARK(visible)->Unit(benchmark::kMillisecond);

void visible_all_against_all(benchmark::State& state) {
  const Strands& all = strands();
  std::size_t k = 0;
  for (auto _ : state) {
    const Vec3 p = all.tips[k++ % 8];
    std::vector<std::uint32_t> order = all.indices;
    const auto distance = [&](std::uint32_t v) { return length(all.positions[v] - p); };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return distance(a) < distance(b); });
    const double nearest = distance(order.front());
    std::vector<std::pair<Vec3, double>> taken;
    for (const std::uint32_t v : order) {
      const Vec3 direction = normalized(all.positions[v] - p);
      const double width = std::min(0.01 * distance(v) / nearest, math::kTurnRad);
      if (std::none_of(taken.begin(), taken.end(), [&](const auto& other) {
            return math::acos(std::clamp(dot(direction, other.first), -1.0, 1.0)) < 0.5 * (width + other.second);
          })) {
        taken.emplace_back(direction, width);
      }
    }
    benchmark::DoNotOptimize(taken);
  }
}
BENCHMARK(visible_all_against_all)->Unit(benchmark::kMillisecond);

// ---- growth ---------------------------------------------------------------------------------------------------------

std::vector<Vec2> section_points(const test::SaucerHead& head, std::size_t frame) {
  Rng rng(2, 1, RandomPurpose::kTest);
  const Vec2 edge = head.outlines.frame(frame)[50];
  std::vector<Vec2> points;
  for (int i = 0; i < 10'000; ++i) {
    points.push_back({edge.x * 0.8 * rng.uniform(), edge.y * rng.uniform(0.7, 0.95)});
  }
  return points;
}

void mean_value_move(benchmark::State& state) {
  const test::SaucerHead head = test::saucer_head(300);
  const HeadGrowth growth = mean_value_growth(head.outlines);
  const std::vector<Vec2> points = section_points(head, 200);
  for (auto _ : state) {
    std::vector<Vec2> moved = points;
    growth.move(200, 208, moved);
    benchmark::DoNotOptimize(moved);
  }
  state.SetItemsProcessed(state.iterations() * 10'000);
}
BENCHMARK(mean_value_move)->Unit(benchmark::kMillisecond)->UseRealTime();

void mean_value_by_angles(benchmark::State& state) {
  const test::SaucerHead head = test::saucer_head(300);
  std::vector<Vec2> corners(head.outlines.frame(200).begin(), head.outlines.frame(200).end());
  std::vector<Vec2> moves;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    moves.push_back(head.outlines.frame(208)[i] - corners[i]);
  }
  for (std::size_t i = head.outlines.points_per_frame; i-- > 1;) {
    corners.push_back({-corners[i].x, corners[i].y});
    moves.push_back(Vec2(moves[i]));
  }
  const std::vector<Vec2> points = section_points(head, 200);
  for (auto _ : state) {
    std::vector<Vec2> moved = points;
    for (Vec2& p : moved) {
      double weights = 0.0;
      Vec2 sum;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::size_t j = i + 1 == corners.size() ? 0 : i + 1;
        const Vec2 a = corners[i] - p;
        const Vec2 b = corners[j] - p;
        const double half = math::tan(0.5 * math::atan2(cross(a, b), dot(a, b)));
        weights += half / length(a) + half / length(b);
        sum += (half / length(a)) * moves[i] + (half / length(b)) * moves[j];
      }
      p += sum / weights;
    }
    benchmark::DoNotOptimize(moved);
  }
  state.SetItemsProcessed(state.iterations() * 10'000);
}
BENCHMARK(mean_value_by_angles)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace anthesis
