#include "anthesis/exchange/ply.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "anthesis/base/parallel.h"
#include "check_time.h"
#include "flat_plant.h"
#include "provenance.h"
#include "text.h"

namespace anthesis {
namespace {

constexpr std::size_t kVertexBytes = 6 * 4 + 3 + 4 + 4;
constexpr std::size_t kFaceBytes = 1 + 3 * 4;

/// Writes little-endian values to a place in a buffer made large enough beforehand. The program runs on x86-64 only,
/// whose order of bytes this is.
class Writer {
 public:
  explicit Writer(char* to) : to_(to) {}
  template <class Value>
  void put(Value value) {
    std::memcpy(to_, &value, sizeof(value));
    to_ += sizeof(value);
  }
  void put(Vec3 v) {
    put(static_cast<float>(v.x));
    put(static_cast<float>(v.y));
    put(static_cast<float>(v.z));
  }

 private:
  char* to_;
};

std::uint8_t srgb_byte(double linear) {
  return static_cast<std::uint8_t>(std::lround(255.0 * srgb_from_linear(std::clamp(linear, 0.0, 1.0))));
}

struct Vertices {
  std::span<const Vec3> positions_mm;
  std::span<const Vec3> normals;  ///< may be empty
  std::span<const Vec2> uvs;      ///< may be empty
};

void put_vertices(Writer& to, const Vertices& from, const Pigment& pigment, const PigmentVariation& variation,
                  std::uint32_t organ, std::int32_t kind) {
  for (std::size_t i = 0; i < from.positions_mm.size(); ++i) {
    const Vec2 uv = from.uvs.empty() ? Vec2{0.5, 0.5} : from.uvs[i];
    const Colour colour = colour_at(pigment, variation, uv, true);
    to.put(from.positions_mm[i]);
    to.put(from.normals.empty() ? Vec3{0.0, 0.0, 1.0} : from.normals[i]);
    to.put(srgb_byte(colour.r));
    to.put(srgb_byte(colour.g));
    to.put(srgb_byte(colour.b));
    to.put(organ);
    to.put(kind);
  }
}

void put_faces(Writer& to, std::span<const Triangle> triangles, std::uint32_t first_vertex) {
  for (const Triangle& triangle : triangles) {
    to.put(std::uint8_t{3});
    for (const std::uint32_t vertex : triangle) {
      to.put(first_vertex + vertex);
    }
  }
}

std::string header(const Development& development, const Canopy& canopy, const detail::FlatPlant& plant) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  detail::append(text, "comment generator: ", detail::generator(), "\n");
  for (const auto& [key, value] : detail::provenance(development, detail::is_resolved(canopy))) {
    detail::append(text, "comment ", key, ": ", value, "\n");
  }
  detail::append(text, "comment time: ", canopy.time, "\ncomment units: millimetres; +z is up\n");
  const std::vector<OrganKind>& kinds = development.species().organs;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    detail::append(text, "comment kind ", i, ": ", detail::one_line(kinds[i].name), "\n");
  }
  detail::append(text, "element vertex ", plant.vertex_count,
                 "\nproperty float x\nproperty float y\nproperty float z\n"
                 "property float nx\nproperty float ny\nproperty float nz\n"
                 "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                 "property int organ\nproperty int kind\n"
                 "element face ",
                 plant.triangle_count, "\nproperty list uchar int vertex_indices\nend_header\n");
  return text;
}

}  // namespace

Expected<std::string> to_ply(const Development& development, double time, const Progress& progress) {
  if (std::optional<Error> error = detail::check_time(time)) {
    return unexpected(*error);
  }
  return to_ply(development, development.at(time), progress);
}

Expected<std::string> to_ply(const Development& development, const Canopy& canopy, const Progress& progress) {
  const Expected<detail::FlatPlant> plant = detail::flat_plant(development, canopy);
  if (!plant) {
    return unexpected(plant.error());
  }
  const Species& species = development.species();
  const std::vector<OrganState>& organs = canopy.organs;
  const std::vector<Body>& bodies = canopy.bodies;

  std::vector<std::uint64_t> first_triangle;
  std::uint64_t triangles = 0;
  for (const OrganState& state : organs) {
    first_triangle.push_back(triangles);
    triangles += detail::template_of(development, state).triangles().size();
  }

  std::string bytes = header(development, canopy, *plant);
  const std::size_t vertex_start = bytes.size();
  const std::size_t face_start = vertex_start + std::size_t{plant->vertex_count} * kVertexBytes;
  bytes.resize(face_start + plant->triangle_count * kFaceBytes);

  const bool done = parallel_for(
      organs.size(),
      [&](std::size_t i) {
        const OrganState& state = organs[i];
        const Organ& organ = development.organs()[state.id.value - 1];
        const OrganTemplate& shape = detail::template_of(development, state);
        std::vector<Vec3> positions_mm;
        std::vector<Vec3> normals;
        detail::pose_in_world(shape, state, positions_mm, normals);
        const std::uint32_t first = plant->first_vertex[i];
        for (const TemplateGroup& group : shape.groups()) {
          const Pigment& pigment = detail::pigment_named(species, group.pigment);
          Writer to(bytes.data() + vertex_start + std::size_t{first + group.first_vertex} * kVertexBytes);
          put_vertices(to,
                       {std::span(positions_mm).subspan(group.first_vertex, group.vertex_count),
                        std::span(normals).subspan(group.first_vertex, group.vertex_count),
                        shape.uvs().subspan(group.first_vertex, group.vertex_count)},
                       pigment, vary(pigment, development.options().seed, state.id.value), state.id.value,
                       static_cast<std::int32_t>(organ.kind));
        }
        Writer to(bytes.data() + face_start + first_triangle[i] * kFaceBytes);
        put_faces(to, shape.triangles(), first);
      },
      progress, "ply");
  if (!done) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  for (std::size_t j = 0; j < bodies.size(); ++j) {
    const Mesh& mesh = bodies[j].mesh;
    const std::uint32_t first = plant->first_vertex[organs.size() + j];
    const Pigment& pigment = detail::pigment_named(species, bodies[j].pigment);
    Writer vertices(bytes.data() + vertex_start + std::size_t{first} * kVertexBytes);
    put_vertices(vertices, {mesh.positions_mm, mesh.normals, mesh.uvs}, pigment,
                 vary(pigment, development.options().seed, 0), 0, -1);
    Writer faces(bytes.data() + face_start + triangles * kFaceBytes);
    put_faces(faces, mesh.triangles, first);
    triangles += mesh.triangles.size();
  }
  return bytes;
}

}  // namespace anthesis
