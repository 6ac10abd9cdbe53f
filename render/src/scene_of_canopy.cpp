#include "anthesis/render/scene_of_canopy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace anthesis {

namespace {

constexpr double kStages = 64.0;  // organs whose stages agree to this share of development share a mesh

std::uint32_t pigment_index(const Species& species, const std::string& name) {
  for (std::size_t i = 0; i < species.pigments.size(); ++i) {
    if (species.pigments[i].name == name) {
      return static_cast<std::uint32_t>(i);
    }
  }
  return 0;
}

SceneMesh posed(const OrganTemplate& organ, double stage, const Species& species) {
  SceneMesh posed;
  Mesh& mesh = posed.mesh;
  mesh.positions_mm.resize(organ.vertex_count());
  mesh.normals.resize(organ.vertex_count());
  organ.pose(stage, mesh.positions_mm, mesh.normals);
  mesh.uvs.assign(organ.uvs().begin(), organ.uvs().end());
  mesh.triangles.assign(organ.triangles().begin(), organ.triangles().end());
  for (const TemplateGroup& group : organ.groups()) {
    posed.spans.push_back({group.first_triangle, group.triangle_count, pigment_index(species, group.pigment)});
  }
  return posed;
}

}  // namespace

Scene make_scene(const Development& development, const Canopy& canopy, const SceneOptions& options) {
  const Species& species = development.species();
  Scene scene;
  scene.backdrop = options.backdrop;
  scene.pigments = species.pigments;
  if (scene.pigments.empty()) {
    scene.pigments.emplace_back();
  }
  const std::uint64_t seed = development.options().seed;

  std::map<std::pair<std::uint32_t, int>, std::uint32_t> meshes;  // by template and quantised stage
  scene.instances.reserve(canopy.organs.size() + canopy.bodies.size());
  for (const OrganState& state : canopy.organs) {
    if (!(state.world_from_organ.scale > 0.0)) {
      continue;  // not grown yet
    }
    const std::uint32_t index = development.organs()[state.id.value - 1].template_index;
    const int stage = static_cast<int>(std::floor(std::clamp(state.stage, 0.0, 1.0) * kStages + 0.5));
    const auto [place, added] = meshes.try_emplace({index, stage}, static_cast<std::uint32_t>(scene.meshes.size()));
    if (added) {
      scene.meshes.push_back(posed(development.templates()[index], stage / kStages, species));
    }
    Instance instance;
    instance.mesh = place->second;
    instance.world_from_mesh = state.world_from_organ;
    for (const PigmentSpan& span : scene.meshes[place->second].spans) {
      instance.variations.push_back(vary(scene.pigments[span.pigment], seed, state.id.value));
    }
    scene.instances.push_back(std::move(instance));
  }
  for (const Body& body : canopy.bodies) {
    if (body.mesh.triangles.empty()) {
      continue;
    }
    Instance instance;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    instance.framed = body.name != "peduncle";
    scene.meshes.push_back(
        {body.mesh,
         {{0, static_cast<std::uint32_t>(body.mesh.triangles.size()), pigment_index(species, body.pigment)}}});
    scene.instances.push_back(std::move(instance));
  }
  if (options.ground) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Instance& instance : scene.instances) {
      for (const Vec3& p : scene.meshes[instance.mesh].mesh.positions_mm) {
        lowest = std::min(lowest, apply(instance.world_from_mesh, p).z);
      }
    }
    scene.ground = Ground{.height_mm = std::isfinite(lowest) ? lowest : 0.0};
  }
  return scene;
}

Expected<Scene> make_organ_scene(const Species& species, std::size_t kind, double stage, double detail,
                                 const SceneOptions& options) {
  const auto organ = OrganTemplate::build(species.organs[kind].shape, detail, 0, 0);
  if (!organ) {
    return unexpected(organ.error());
  }
  Scene scene;
  scene.backdrop = options.backdrop;
  scene.pigments = species.pigments;
  scene.meshes.push_back(posed(*organ, stage, species));
  Instance instance;
  instance.variations.resize(scene.meshes[0].spans.size());
  scene.instances.push_back(std::move(instance));
  return scene;
}

}  // namespace anthesis
