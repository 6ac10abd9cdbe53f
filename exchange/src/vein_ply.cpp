// Strands of a head as one binary PLY mesh.
#include <cstring>

#include "anthesis/exchange/vein_files.h"
#include "provenance.h"
#include "text.h"

namespace anthesis {
namespace {

template <class Value>
void put(std::string& bytes, Value value) {  // x86-64 is little-endian
  char raw[sizeof(value)];
  std::memcpy(raw, &value, sizeof(value));
  bytes.append(raw, sizeof(value));
}

void put(std::string& bytes, Vec3 v) {
  put(bytes, static_cast<float>(v.x));
  put(bytes, static_cast<float>(v.y));
  put(bytes, static_cast<float>(v.z));
}

}  // namespace

Expected<std::string> veins_ply(const Vasculature& veins, const VeinTubeParams& params, const MadeFrom& made_from) {
  const Expected<VeinTubes> tubes = vein_tubes(veins, params);
  if (!tubes) {
    return unexpected(tubes.error());
  }
  const Mesh& mesh = tubes->mesh;
  std::string bytes = "ply\nformat binary_little_endian 1.0\n";
  detail::append(bytes, "comment generator: ", detail::generator(), "\n");
  for (const auto& [key, value] : made_from) {
    detail::append(bytes, "comment ", detail::one_line(key), ": ", detail::one_line(value), "\n");
  }
  detail::append(bytes, "comment +z is up\n");
  for (const VeinKind kind : {VeinKind::kFloret, VeinKind::kAbaxial, VeinKind::kAdaxial}) {
    detail::append(bytes, "comment kind ", static_cast<int>(kind), ": ", vein_kind_name(kind), "\n");
  }
  detail::append(bytes, "element vertex ", mesh.positions_mm.size(),
                 "\nproperty float x\nproperty float y\nproperty float z\n"
                 "property float nx\nproperty float ny\nproperty float nz\n"
                 "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                 "property uint vein\nproperty uchar kind\n"
                 "element face ",
                 mesh.triangles.size(), "\nproperty list uchar int vertex_indices\nend_header\n");
  bytes.reserve(bytes.size() + mesh.positions_mm.size() * 32 + mesh.triangles.size() * 13);
  for (std::size_t i = 0; i < mesh.positions_mm.size(); ++i) {
    put(bytes, mesh.positions_mm[i]);
    put(bytes, mesh.normals[i]);
    for (const std::uint8_t channel : vein_colour(tubes->kind[i])) {
      put(bytes, channel);
    }
    put(bytes, tubes->vein[i]);
    put(bytes, static_cast<std::uint8_t>(tubes->kind[i]));
  }
  for (const Triangle& triangle : mesh.triangles) {
    put(bytes, std::uint8_t{3});
    for (const std::uint32_t corner : triangle) {
      put(bytes, corner);
    }
  }
  return bytes;
}

}  // namespace anthesis
