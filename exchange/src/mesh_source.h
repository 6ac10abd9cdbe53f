#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/exchange/mesh_file.h"

namespace anthesis::detail {

/// What a reader makes of a file: the tables of CheckedMesh, and the way to pose it.
class MeshSource {
 public:
  virtual ~MeshSource() = default;
  virtual MeshPose pose(std::size_t frame) const = 0;

  std::vector<std::string> parts;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> part_of_triangle;
  std::size_t vertex_count = 0;
  std::vector<double> times_s = {0.0};
  Vec3 mm_per_unit{1.0, 1.0, 1.0};
};

Expected<std::unique_ptr<const MeshSource>> read_ply(std::string_view bytes, std::string_view file_name);
Expected<std::unique_ptr<const MeshSource>> read_glb(std::string bytes, std::string_view file_name);

}  // namespace anthesis::detail
