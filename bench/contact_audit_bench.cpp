// The exact audit of packed petals beside CGAL's, which decides the same by the same rules.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "anthesis/base/parallel.h"
#include "anthesis/contact/crossings.h"

namespace anthesis {
namespace {

struct Scene {
  std::vector<Vec3> positions_mm;
  std::vector<Triangle> triangles;
};

/// The petals before they move (no crossings), or after.
Scene read_scene(const std::string& name, bool after) {
  const char* given = std::getenv("ANTHESIS_REFERENCE");
  const std::string folder = given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT;
  std::ifstream file(folder + "/contact-scenes/" + name + ".bin", std::ios::binary);
  Scene scene;
  std::array<std::int32_t, 2> counts = {};
  const auto read = [&file](auto* to, std::size_t count) {
    file.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(count * sizeof(*to)));
  };
  read(counts.data(), 2);
  if (!file) {
    return scene;
  }
  scene.positions_mm.resize(static_cast<std::size_t>(counts[0]));
  scene.triangles.resize(static_cast<std::size_t>(counts[1]));
  read(scene.positions_mm.data(), scene.positions_mm.size());
  if (after) {
    read(scene.positions_mm.data(), scene.positions_mm.size());
  } else {
    file.seekg(static_cast<std::streamoff>(scene.positions_mm.size() * sizeof(Vec3)), std::ios::cur);
  }
  read(scene.triangles.data(), scene.triangles.size());
  return scene;
}

void BM_Audit(benchmark::State& state, const char* name, bool after) {
  const ThreadLimit threads(static_cast<int>(state.range(0)));
  const Scene scene = read_scene(name, after);
  if (scene.triangles.empty()) {
    return state.SkipWithError("no reference data; set ANTHESIS_REFERENCE");
  }
  std::uint64_t count = 0;
  for (auto _ : state) {
    count = find_crossings(scene.positions_mm, scene.triangles)->count;
  }
  state.counters["crossings"] = static_cast<double>(count);
  state.counters["triangles"] = static_cast<double>(scene.triangles.size());
}

/// Baseline.
void BM_AuditByCgal(benchmark::State& state, const char* name, bool after) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  const Scene scene = read_scene(name, after);
  if (scene.triangles.empty()) {
    return state.SkipWithError("no reference data; set ANTHESIS_REFERENCE");
  }
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertices;
  for (const Vec3 p : scene.positions_mm) {
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
