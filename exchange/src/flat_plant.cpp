#include "flat_plant.h"

#include <cmath>

#include "check_time.h"

namespace anthesis::detail {

Expected<FlatPlant> flat_plant(const Development& development, const Canopy& canopy) {
  if (std::optional<Error> error = check_canopy(development, canopy)) {
    return unexpected(*error);
  }
  FlatPlant plant;
  std::uint64_t vertices = 0;
  const auto add = [&](std::uint64_t vertex_count, std::uint64_t triangle_count) {
    plant.first_vertex.push_back(static_cast<std::uint32_t>(vertices));
    plant.triangle_count += triangle_count;
    return !__builtin_add_overflow(vertices, vertex_count, &vertices) && vertices <= kMaxFlatVertices;
  };
  const Error too_large{
      ErrorCode::kTooLarge, "detail",
      "makes more than " + std::to_string(kMaxFlatVertices) + " vertices, the most that a file of one time may have"};
  for (const OrganState& state : canopy.organs) {
    const OrganTemplate& shape = template_of(development, state);
    if (!add(shape.vertex_count(), shape.triangles().size())) {
      return unexpected(too_large);
    }
  }
  for (const Body& body : canopy.bodies) {
    if (!add(body.mesh.positions_mm.size(), body.mesh.triangles.size())) {
      return unexpected(too_large);
    }
  }
  plant.vertex_count = static_cast<std::uint32_t>(vertices);
  return plant;
}

std::optional<Error> check_canopy(const Development& development, const Canopy& canopy) {
  if (std::optional<Error> error = check_time(canopy.time)) {
    return error;
  }
  const auto wrong = [](std::string where, std::string message) {
    return Error{ErrorCode::kInvalidParameter, std::move(where), std::move(message)};
  };
  OrganId before;
  for (const OrganState& state : canopy.organs) {
    if (!(before < state.id) || state.id.value > development.organs().size()) {
      return wrong("organ " + std::to_string(state.id.value), "must be one of the development, each once, by id");
    }
    before = state.id;
    const std::size_t count = template_of(development, state).vertex_count();
    if (!state.deformed_mm.empty() && state.deformed_mm.size() != count) {
      return wrong(organ_name(development, state.id), "must have the " + std::to_string(count) +
                                                          " vertices of its template, got " +
                                                          std::to_string(state.deformed_mm.size()));
    }
    const Placement& place = state.world_from_organ;
    const Quaternion& q = place.rotation;
    bool finite = std::isfinite(place.position_mm.x + place.position_mm.y + place.position_mm.z + place.scale +
                                state.stage + q.w + q.x + q.y + q.z);
    for (const std::array<float, 3>& p : state.deformed_mm) {
      finite = finite && std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
    }
    if (!finite) {
      return wrong(organ_name(development, state.id), "has a place that is not finite");
    }
  }
  for (const Body& body : canopy.bodies) {
    for (const Vec3 p : body.mesh.positions_mm) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        return wrong(body.name, "has a place that is not finite");
      }
    }
  }
  return std::nullopt;
}

bool is_resolved(const Canopy& canopy) {
  for (const OrganState& state : canopy.organs) {
    if (!state.deformed_mm.empty()) {
      return true;
    }
  }
  return false;
}

const OrganTemplate& template_of(const Development& development, const OrganState& state) {
  return development.templates()[development.organs()[state.id.value - 1].template_index];
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
  if (!state.deformed_mm.empty()) {
    for (std::size_t i = 0; i < positions_mm.size(); ++i) {
      const std::array<float, 3>& p = state.deformed_mm[i];
      positions_mm[i] = {p[0], p[1], p[2]};
    }
    smooth_normals(positions_mm, shape.triangles(), shape.twins(), normals);
    return;
  }
  shape.pose(state.stage, positions_mm, normals);
  for (std::size_t i = 0; i < positions_mm.size(); ++i) {
    positions_mm[i] = apply(state.world_from_organ, positions_mm[i]);
    normals[i] = rotate(state.world_from_organ.rotation, normals[i]);
  }
}

}  // namespace anthesis::detail
