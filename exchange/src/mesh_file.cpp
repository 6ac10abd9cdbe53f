#include "anthesis/exchange/mesh_file.h"

#include "anthesis/base/assert.h"
#include "anthesis/base/file.h"
#include "mesh_source.h"

namespace anthesis {

CheckedMesh::CheckedMesh(std::unique_ptr<const detail::MeshSource> source) : source_(std::move(source)) {}
CheckedMesh::CheckedMesh(CheckedMesh&&) noexcept = default;
CheckedMesh& CheckedMesh::operator=(CheckedMesh&&) noexcept = default;
CheckedMesh::~CheckedMesh() = default;

std::span<const std::string> CheckedMesh::parts() const {
  return source_->parts;
}

std::span<const Triangle> CheckedMesh::triangles() const {
  return source_->triangles;
}

std::span<const std::uint32_t> CheckedMesh::part_of_triangle() const {
  return source_->part_of_triangle;
}

std::size_t CheckedMesh::vertex_count() const {
  return source_->vertex_count;
}

std::span<const double> CheckedMesh::times_s() const {
  return source_->times_s;
}

Vec3 CheckedMesh::mm_per_unit() const {
  return source_->mm_per_unit;
}

MeshPose CheckedMesh::pose(std::size_t frame) const {
  ANTHESIS_ASSERT(frame < source_->times_s.size());
  return source_->pose(frame);
}

Expected<CheckedMesh> read_mesh(std::string bytes, std::string_view file_name) {
  const std::string where = std::string(file_name) + ':';
  if (bytes.size() > kMeshFileLimit) {
    return unexpected(
        Error{ErrorCode::kTooLarge, where, "must be at most " + std::to_string(kMeshFileLimit) + " bytes"});
  }
  Expected<std::unique_ptr<const detail::MeshSource>> source = unexpected(
      Error{ErrorCode::kParse, where, "is neither a PLY nor a GLB file: must begin with \"ply\" or \"glTF\""});
  if (bytes.starts_with("glTF")) {
    source = detail::read_glb(std::move(bytes), file_name);
  } else if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) {
    source = detail::read_ply(bytes, file_name);
  }
  if (!source) {
    return unexpected(source.error());
  }
  return CheckedMesh(std::move(*source));
}

Expected<CheckedMesh> load_mesh(const std::string& path) {
  Expected<std::string> bytes = read_file(path, kMeshFileLimit);
  if (!bytes) {
    return unexpected(bytes.error());
  }
  return read_mesh(std::move(*bytes), path);
}

}  // namespace anthesis
