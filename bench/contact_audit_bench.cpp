// The exact audit of packed petals beside CGAL's, which decides the same by the same rules.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>

#include <utility>
#include <vector>

#include "anthesis/base/parallel.h"
#include "anthesis/contact/crossings.h"
#include "contact_scene.h"

namespace anthesis {
namespace {

/// The petals before they move (no crossings), or after.
void BM_Audit(benchmark::State& state, const char* name, bool after) {
  const ThreadLimit threads(static_cast<int>(state.range(0)));
  const ContactScene scene = read_contact_scene(name);
  if (!scene.found()) {
    return state.SkipWithError(kNoContactScene);
  }
  const std::vector<Vec3>& positions = after ? scene.to_mm : scene.from_mm;
  std::uint64_t count = 0;
  for (auto _ : state) {
    count = find_crossings(positions, scene.triangles)->count;
  }
  state.counters["crossings"] = static_cast<double>(count);
  state.counters["triangles"] = static_cast<double>(scene.triangles.size());
}

/// Baseline.
void BM_AuditByCgal(benchmark::State& state, const char* name, bool after) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  const ContactScene scene = read_contact_scene(name);
  if (!scene.found()) {
    return state.SkipWithError(kNoContactScene);
  }
  const std::vector<Vec3>& positions = after ? scene.to_mm : scene.from_mm;
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertices;
  for (const Vec3 p : positions) {
    vertices.push_back(mesh.add_vertex({p.x, p.y, p.z}));
  }
  for (const Triangle& t : scene.triangles) {
    mesh.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  }
  std::size_t count = 0;
  for (auto _ : state) {
    std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
    CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(pairs));
    count = pairs.size();
  }
  state.counters["crossings"] = static_cast<double>(count);
  state.counters["triangles"] = static_cast<double>(scene.triangles.size());
}

#define ANTHESIS_AUDIT(name, after)                         \
  BENCHMARK_CAPTURE(BM_Audit, name##_##after, #name, after) \
      ->Arg(1)                                              \
      ->Arg(2)                                              \
      ->Unit(benchmark::kMillisecond)                       \
      ->UseRealTime();                                      \
  BENCHMARK_CAPTURE(BM_AuditByCgal, name##_##after, #name, after)->Unit(benchmark::kMillisecond)->UseRealTime()

ANTHESIS_AUDIT(art_16x19_a05, false);
ANTHESIS_AUDIT(art_154x19_a05, false);
ANTHESIS_AUDIT(art_154x19, false);
ANTHESIS_AUDIT(art_154x19, true);

}  // namespace
}  // namespace anthesis
