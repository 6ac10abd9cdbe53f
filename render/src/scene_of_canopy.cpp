#include "anthesis/render/scene_of_canopy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"
#include "anthesis/corolla/surface_follower.h"

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

void add_to(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions_mm.size());
  mesh.positions_mm.insert(mesh.positions_mm.end(), other.positions_mm.begin(), other.positions_mm.end());
  mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
  mesh.uvs.insert(mesh.uvs.end(), other.uvs.begin(), other.uvs.end());
  for (const Triangle& t : other.triangles) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

/// The surface of a template without its places.
SceneMesh surface_of(const OrganTemplate& organ, const Species& species) {
  SceneMesh surface;
  Mesh& mesh = surface.mesh;
  mesh.positions_mm.resize(organ.vertex_count());
  mesh.normals.resize(organ.vertex_count());
  mesh.uvs.assign(organ.uvs().begin(), organ.uvs().end());
  mesh.triangles.assign(organ.triangles().begin(), organ.triangles().end());
  for (const TemplateGroup& group : organ.groups()) {
    surface.spans.push_back({group.first_triangle, group.triangle_count, pigment_index(species, group.pigment)});
  }
  return surface;
}

/// Lets hairs stand on the surface that `surface` consists of so far.
void add_hairs(const HairCoat& hairs, double scale, const Species& species, SceneMesh& surface) {
  Mesh coat;  // apart, as it follows from the vertices that it is added to
  for (std::size_t group = 0; group < hairs.groups().size(); ++group) {
    const auto first = static_cast<std::uint32_t>(surface.mesh.triangles.size() + coat.triangles.size());
    hairs.append(group, surface.mesh.positions_mm, surface.mesh.normals, scale, coat);
    const auto after = static_cast<std::uint32_t>(surface.mesh.triangles.size() + coat.triangles.size());
    surface.spans.push_back({first, after - first, pigment_index(species, hairs.groups()[group].pigment)});
  }
  add_to(surface.mesh, coat);
}

SceneMesh posed(const OrganTemplate& organ, double stage, const Species& species) {
  SceneMesh posed = surface_of(organ, species);
  organ.pose(stage, posed.mesh.positions_mm, posed.mesh.normals);
  add_hairs(organ.hairs(), 1.0, species, posed);
  return posed;
}

std::vector<Vec3> bent_mm(const OrganState& state) {
  std::vector<Vec3> positions_mm;
  positions_mm.reserve(state.deformed_mm.size());
  for (const std::array<float, 3>& p : state.deformed_mm) {
    positions_mm.push_back({p[0], p[1], p[2]});
  }
  return positions_mm;
}

/// An organ that touching bent, where it is in the world.
SceneMesh deformed(const OrganTemplate& organ, const OrganState& state, const Species& species) {
  ANTHESIS_ASSERT(state.deformed_mm.size() == organ.vertex_count());
  SceneMesh deformed = surface_of(organ, species);
  Mesh& mesh = deformed.mesh;
  mesh.positions_mm = bent_mm(state);
  smooth_normals(mesh.positions_mm, organ.triangles(), organ.twins(), mesh.normals);
  add_hairs(organ.hairs(), state.world_from_organ.scale, species, deformed);
  return deformed;
}

/// The hairs on the stem, which stands where it is drawn.
HairCoat hairs_of_stem(const Development& drawn) {
  HairCoat coat;
  const std::vector<Hairs>& hairs = drawn.species().peduncle.hairs;
  if (!hairs.empty()) {
    const Canopy grown = drawn.at(1.0);
    const auto stem = std::find_if(grown.bodies.begin(), grown.bodies.end(),
                                   [](const Body& body) { return body.name == "peduncle"; });
    for (std::size_t i = 0; i < hairs.size() && stem != grown.bodies.end(); ++i) {
      coat.plant(hairs[i], stem->mesh.triangles, stem->mesh.uvs, stem->mesh.positions_mm, drawn.options().seed, i);
    }
  }
  return coat;
}

/// Lets the organs of a finer plant follow those of the plant that was bent.
class Refinement {
 public:
  Refinement(const Development& coarse, const Development& finer, const Canopy& canopy)
      : coarse_(coarse), finer_(finer) {
    ANTHESIS_ASSERT(coarse.templates().size() == finer.templates().size());
    followers_.resize(coarse.templates().size());
    for (const OrganState& state : canopy.organs) {
      std::optional<SurfaceFollower>& follower = followers_[template_index(state)];
      if (!state.deformed_mm.empty() && !follower) {
        follower.emplace(coarse.templates()[template_index(state)], finer.templates()[template_index(state)]);
      }
    }
  }

  SceneMesh mesh(const OrganState& state) const {
    const OrganTemplate& coarse = coarse_.templates()[template_index(state)];
    const OrganTemplate& fine = finer_.templates()[template_index(state)];
    SceneMesh result = surface_of(fine, finer_.species());
    Mesh& mesh = result.mesh;
    std::vector<Vec3> rest_mm(coarse.vertex_count());
    std::vector<Vec3> normals(coarse.vertex_count());
    coarse.pose(state.stage, rest_mm, normals);
    fine.pose(state.stage, mesh.positions_mm, mesh.normals);
    for (Vec3& p : rest_mm) {
      p = apply(state.world_from_organ, p);
    }
    for (Vec3& p : mesh.positions_mm) {
      p = apply(state.world_from_organ, p);
    }
    followers_[template_index(state)]->follow(rest_mm, bent_mm(state), mesh.positions_mm);
    smooth_normals(mesh.positions_mm, fine.triangles(), fine.twins(), mesh.normals);
    add_hairs(fine.hairs(), state.world_from_organ.scale, finer_.species(), result);
    return result;
  }

 private:
  std::uint32_t template_index(const OrganState& state) const {
    return coarse_.organs()[state.id.value - 1].template_index;
  }

  const Development& coarse_;
  const Development& finer_;
  std::vector<std::optional<SurfaceFollower>> followers_;  ///< by template, where it is needed
};

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
  std::optional<Refinement> refinement;
  if (options.finer != nullptr) {
    refinement.emplace(development, *options.finer, canopy);
  }
  std::vector<SceneMesh> bent(canopy.organs.size());
  parallel_for(bent.size(), [&](std::size_t i) {
    const OrganState& state = canopy.organs[i];
    if (!state.deformed_mm.empty()) {
      const std::uint32_t index = development.organs()[state.id.value - 1].template_index;
      bent[i] = refinement ? refinement->mesh(state) : deformed(development.templates()[index], state, species);
    }
  });
  for (std::size_t i = 0; i < canopy.organs.size(); ++i) {
    const OrganState& state = canopy.organs[i];
    if (!(state.world_from_organ.scale > 0.0)) {
      continue;  // not grown yet
    }
    const std::uint32_t index = development.organs()[state.id.value - 1].template_index;
    Instance instance;
    if (state.deformed_mm.empty()) {
      const int stage = static_cast<int>(std::floor(std::clamp(state.stage, 0.0, 1.0) * kStages + 0.5));
      const auto [place, added] = meshes.try_emplace({index, stage}, static_cast<std::uint32_t>(scene.meshes.size()));
      if (added) {
        const Development& drawn = options.finer != nullptr ? *options.finer : development;
        scene.meshes.push_back(posed(drawn.templates()[index], stage / kStages, species));
      }
      instance.mesh = place->second;
      instance.world_from_mesh = state.world_from_organ;
    } else {
      instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
      scene.meshes.push_back(std::move(bent[i]));
    }
    for (const PigmentSpan& span : scene.meshes[instance.mesh].spans) {
      instance.variations.push_back(vary(scene.pigments[span.pigment], seed, state.id.value));
    }
    scene.instances.push_back(std::move(instance));
  }
  const std::vector<Body> finer_bodies =
      options.finer != nullptr ? options.finer->at(canopy.time).bodies : std::vector<Body>{};
  const HairCoat stem_hairs = hairs_of_stem(options.finer != nullptr ? *options.finer : development);
  for (const Body& body : options.finer != nullptr ? finer_bodies : canopy.bodies) {
    if (body.mesh.triangles.empty()) {
      continue;
    }
    Instance instance;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    instance.framed = body.name != "peduncle";
    SceneMesh surface{
        body.mesh, {{0, static_cast<std::uint32_t>(body.mesh.triangles.size()), pigment_index(species, body.pigment)}}};
    if (body.name == "peduncle") {
      add_hairs(stem_hairs, 1.0, species, surface);
    }
    scene.meshes.push_back(std::move(surface));
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
