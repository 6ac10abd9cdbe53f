#include "anthesis/exchange/obj.h"

#include <algorithm>
#include <span>

#include "anthesis/base/parallel.h"
#include "check_time.h"
#include "flat_plant.h"
#include "provenance.h"
#include "text.h"

namespace anthesis {
namespace {

using detail::append;

void append_vector(std::string& text, std::string_view what, Vec3 v) {
  // Single precision: what every reader keeps, in half the bytes.
  append(text, what, static_cast<float>(v.x), " ", static_cast<float>(v.y), " ", static_cast<float>(v.z), "\n");
}

/// Where the indices of an object start in the file, counted from 1 as OBJ does; 0: the object has none of these.
struct FirstIndices {
  std::uint64_t position = 1;
  std::uint64_t uv = 0;
  std::uint64_t normal = 0;
};

void append_faces(std::string& text, std::span<const Triangle> triangles, const FirstIndices& first) {
  for (const Triangle& triangle : triangles) {
    text += 'f';
    for (const std::uint32_t vertex : triangle) {
      append(text, " ", first.position + vertex);
      if (first.uv != 0) {
        append(text, "/", first.uv + vertex);
      }
      if (first.normal != 0) {
        append(text, first.uv != 0 ? "/" : "//", first.normal + vertex);
      }
    }
    text += '\n';
  }
}

void append_uvs(std::string& text, std::span<const Vec2> uvs) {
  for (const Vec2 uv : uvs) {
    append(text, "vt ", static_cast<float>(uv.x), " ", static_cast<float>(uv.y), "\n");
  }
}

std::string header(const Development& development, const Canopy& canopy) {
  std::string text = "# " + detail::generator() + "\n";
  for (const auto& [key, value] : detail::provenance(development, detail::is_resolved(canopy))) {
    append(text, "# ", key, ": ", value, "\n");
  }
  append(text, "# time: ", canopy.time, "\n# units: millimetres; +z is up\n");
  return text;
}

std::string material_library(const Development& development, const Canopy& canopy) {
  std::string text = header(development, canopy);
  std::vector<Pigment> pigments = development.species().pigments;
  pigments.push_back(detail::pigment_named(development.species(), ""));
  for (const Pigment& pigment : pigments) {
    // OBJ has one colour for a material: the upper side's in the middle of the organ.
    const Colour colour = colour_at(pigment, PigmentVariation{}, {0.3, 0.6}, true);
    // The Phong exponent that matches a microfacet roughness alpha = roughness^2 (Blinn's 2 / alpha^2 - 2).
    const double alpha = std::max(0.05, pigment.roughness * pigment.roughness);
    const double shininess = std::min(1000.0, std::max(0.0, 2.0 / (alpha * alpha) - 2.0));
    const double specular = 0.08 * pigment.specular;
    append(text, "\nnewmtl ", detail::one_word(pigment.name), "\nKd ", static_cast<float>(colour.r), " ",
           static_cast<float>(colour.g), " ", static_cast<float>(colour.b), "\nKs ", static_cast<float>(specular), " ",
           static_cast<float>(specular), " ", static_cast<float>(specular), "\nNs ", static_cast<float>(shininess),
           "\nPr ", static_cast<float>(pigment.roughness), "\nillum 2\n");
  }
  return text;
}

}  // namespace

Expected<ObjText> to_obj(const Development& development, double time, std::string_view mtl_name,
                         const Progress& progress) {
  if (std::optional<Error> error = detail::check_time(time)) {
    return unexpected(*error);
  }
  return to_obj(development, development.at(time), mtl_name, progress);
}

Expected<ObjText> to_obj(const Development& development, const Canopy& canopy, std::string_view mtl_name,
                         const Progress& progress) {
  const Expected<detail::FlatPlant> plant = detail::flat_plant(development, canopy);
  if (!plant) {
    return unexpected(plant.error());
  }
  const std::vector<OrganState>& organs = canopy.organs;
  const std::vector<Body>& bodies = canopy.bodies;
  const std::span<const OrganTemplate> templates = development.templates();

  ObjText result;
  result.obj = header(development, canopy);
  append(result.obj, "mtllib ", detail::one_word(mtl_name), "\n");

  // Organs of one template share their texture coordinates: written once, where the template is first used.
  std::vector<std::uint64_t> first_uv(templates.size(), 0);
  std::uint64_t next_uv = 1;
  for (const OrganState& state : organs) {
    const std::uint32_t index = development.organs()[state.id.value - 1].template_index;
    if (first_uv[index] == 0) {
      first_uv[index] = next_uv;
      next_uv += templates[index].uvs().size();
      append_uvs(result.obj, templates[index].uvs());
    }
  }

  // Each organ's text depends on its own numbers only, so they are made side by side and joined in order.
  std::vector<std::string> texts(organs.size());
  const bool done = parallel_for(
      organs.size(),
      [&](std::size_t i) {
        const OrganState& state = organs[i];
        const OrganTemplate& shape = detail::template_of(development, state);
        std::vector<Vec3> positions_mm;
        std::vector<Vec3> normals;
        detail::pose_in_world(shape, state, positions_mm, normals);
        std::string& text = texts[i];
        text.reserve(positions_mm.size() * 72 + shape.triangles().size() * 48);
        append(text, "o ", detail::one_word(organ_name(development, state.id)), "\n");
        for (const Vec3 p : positions_mm) {
          append_vector(text, "v ", p);
        }
        for (const Vec3 n : normals) {
          append_vector(text, "vn ", n);
        }
        const std::uint64_t first = std::uint64_t{plant->first_vertex[i]} + 1;
        const FirstIndices indices{first, first_uv[development.organs()[state.id.value - 1].template_index], first};
        for (const TemplateGroup& group : shape.groups()) {
          append(text, "usemtl ", detail::one_word(detail::pigment_named(development.species(), group.pigment).name),
                 "\n");
          append_faces(text, shape.triangles().subspan(group.first_triangle, group.triangle_count), indices);
        }
      },
      progress, "obj");
  if (!done) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  std::size_t size = result.obj.size();
  for (const std::string& text : texts) {
    size += text.size();
  }
  result.obj.reserve(size);
  for (std::string& text : texts) {
    result.obj += text;
    text = {};
  }

  // From here on the file has one normal for each position only if every body has them, so normals count on their own.
  std::uint64_t next_normal = bodies.empty() ? 1 : std::uint64_t{plant->first_vertex[organs.size()]} + 1;
  for (std::size_t j = 0; j < bodies.size(); ++j) {
    const Mesh& mesh = bodies[j].mesh;
    append(result.obj, "o ", detail::one_word(bodies[j].name), "\n");
    for (const Vec3 p : mesh.positions_mm) {
      append_vector(result.obj, "v ", p);
    }
    append_uvs(result.obj, mesh.uvs);
    for (const Vec3 n : mesh.normals) {
      append_vector(result.obj, "vn ", n);
    }
    append(result.obj, "usemtl ",
           detail::one_word(detail::pigment_named(development.species(), bodies[j].pigment).name), "\n");
    append_faces(result.obj, mesh.triangles,
                 {std::uint64_t{plant->first_vertex[organs.size() + j]} + 1, mesh.uvs.empty() ? 0 : next_uv,
                  mesh.normals.empty() ? 0 : next_normal});
    next_uv += mesh.uvs.size();
    next_normal += mesh.normals.size();
  }
  result.mtl = material_library(development, canopy);
  return result;
}

}  // namespace anthesis
