#include <benchmark/benchmark.h>

#include <algorithm>

#include "anthesis/corolla/organ_template.h"
#include "anthesis/exchange/species_file.h"

namespace anthesis {
namespace {

const OrganShape& disk_floret() {
  static const Species species = *find_species("sunflower");
  return std::ranges::find(species.organs, "disk_floret", &OrganKind::name)->shape;
}

void BM_PoseADiskFloret(benchmark::State& state) {
  const OrganTemplate floret = *OrganTemplate::build(disk_floret(), 1.0, 1, 0);
  std::vector<Vec3> positions(floret.vertex_count());
  std::vector<Vec3> normals(floret.vertex_count());
  double stage = 0.0;
  for (auto _ : state) {
    stage = stage < 0.9 ? stage + 0.0137 : 0.01;
    floret.pose(stage, positions, normals);
    benchmark::DoNotOptimize(positions.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(positions.size()));
}
BENCHMARK(BM_PoseADiskFloret)->Unit(benchmark::kMicrosecond);

/// Baseline: linear blending of two finished meshes, which is what a morph target costs, with the same normals.
void BM_BlendADiskFloretLinearly(benchmark::State& state) {
  const OrganTemplate floret = *OrganTemplate::build(disk_floret(), 1.0, 1, 0);
  std::vector<Vec3> from(floret.vertex_count());
  std::vector<Vec3> to(floret.vertex_count());
  std::vector<Vec3> positions(floret.vertex_count());
  std::vector<Vec3> normals(floret.vertex_count());
  floret.pose(0.0, from, normals);
  floret.pose(1.0, to, normals);
  double share = 0.0;
  for (auto _ : state) {
    share = share < 0.9 ? share + 0.0137 : 0.01;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] = lerp(from[i], to[i], share);
    }
    smooth_normals(positions, floret.triangles(), floret.twins(), normals);
    benchmark::DoNotOptimize(positions.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(positions.size()));
}
BENCHMARK(BM_BlendADiskFloretLinearly)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace anthesis
