#include "flat_plant.h"

#include "check_time.h"

namespace anthesis::detail {

Expected<FlatPlant> flat_plant(const Development& development, double time) {
  if (std::optional<Error> error = check_time(time)) {
    return unexpected(*error);
  }
  FlatPlant plant{.canopy = development.at(time), .first_vertex = {}};
  std::uint64_t vertices = 0;
  const auto add = [&](std::uint64_t vertex_count, std::uint64_t triangle_count) {
    plant.first_vertex.push_back(static_cast<std::uint32_t>(vertices));
    plant.triangle_count += triangle_count;
    return !__builtin_add_overflow(vertices, vertex_count, &vertices) && vertices <= kMaxFlatVertices;
  };
  const Error too_large{
      ErrorCode::kTooLarge, "detail",
      "makes more than " + std::to_string(kMaxFlatVertices) + " vertices, the most that a file of one time may have"};
  for (const OrganState& state : plant.canopy.organs) {
    const OrganTemplate& shape = template_of(development, state);
    if (!add(shape.vertex_count(), shape.triangles().size())) {
      return unexpected(too_large);
    }
  }
  for (const Body& body : plant.canopy.bodies) {
    if (!add(body.mesh.positions_mm.size(), body.mesh.triangles.size())) {
      return unexpected(too_large);
    }
  }
  plant.vertex_count = static_cast<std::uint32_t>(vertices);
  return plant;
}

const OrganTemplate& template_of(const Development& development, const OrganState& state) {
  return development.templates()[development.organs()[state.id.value - 1].template_index];
}

std::string organ_name(const Development& development, OrganId id) {
  const Organ& organ = development.organs()[id.value - 1];
  return development.species().organs[organ.kind].name + "." + std::to_string(id.value);
}

const Pigment& pigment_named(const Species& species, std::string_view name) {
  for (const Pigment& pigment : species.pigments) {
    if (pigment.name == name) {
      return pigment;
    }
  }
  static const Pigment grey = [] {
    Pigment pigment;
    pigment.name = "grey";
    pigment.mottle = 0.0;
    return pigment;
  }();
  return grey;
}

void pose_in_world(const OrganTemplate& shape, const OrganState& state, std::vector<Vec3>& positions_mm,
                   std::vector<Vec3>& normals) {
  positions_mm.resize(shape.vertex_count());
  normals.resize(shape.vertex_count());
  shape.pose(state.stage, positions_mm, normals);
  for (std::size_t i = 0; i < positions_mm.size(); ++i) {
    positions_mm[i] = apply(state.world_from_organ, positions_mm[i]);
    normals[i] = rotate(state.world_from_organ.rotation, normals[i]);
  }
}

}  // namespace anthesis::detail
