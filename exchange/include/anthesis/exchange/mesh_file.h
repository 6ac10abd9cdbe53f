#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/mesh.h"

namespace anthesis {

namespace detail {
class MeshSource;
}

inline constexpr std::size_t kMeshFileLimit = std::size_t{1} << 32;  ///< bytes
inline constexpr std::size_t kMeshVertexLimit = 50'000'000;
inline constexpr std::size_t kMeshTriangleLimit = 100'000'000;
inline constexpr std::size_t kMeshFrameLimit = 10'000;

/// Where all vertices are at one time.
struct MeshPose {
  std::vector<Vec3> positions;      ///< finite or not, as the file's transforms make them
  std::vector<std::uint8_t> shown;  ///< for each part: 0 if it is scaled to nothing, so that no one sees it
};

/// A mesh that was read from a file to be looked at: triangles that stay the same, in parts, and vertices that move.
class CheckedMesh {
 public:
  explicit CheckedMesh(std::unique_ptr<const detail::MeshSource> source);
  CheckedMesh(CheckedMesh&&) noexcept;
  CheckedMesh& operator=(CheckedMesh&&) noexcept;
  ~CheckedMesh();

  std::span<const std::string> parts() const;  ///< names, such as ray_floret.12
  std::span<const Triangle> triangles() const;
  std::span<const std::uint32_t> part_of_triangle() const;  ///< index into parts()
  std::size_t vertex_count() const;

  /// One for each frame, at least one. A PLY file and a GLB file without animation have one frame, at 0; a GLB file
  /// with animations has one for each time that is a key of any channel, one animation after the other.
  std::span<const double> times_s() const;

  /// Positions are in the file's own units; times this they are millimetres, axis by axis. PLY files are taken to be in
  /// millimetres. See read_mesh for what GLB positions leave out.
  Vec3 mm_per_unit() const;

  /// All vertices at a frame. O(vertices x morph targets in use), parallel, the same for any number of threads.
  /// Precondition: frame < times_s().size() (asserted).
  MeshPose pose(std::size_t frame) const;

 private:
  std::unique_ptr<const detail::MeshSource> source_;
};

/// Reads the bytes of a PLY or a GLB file, whichever they are.
///
/// PLY: ascii or binary in either order of bytes, polygons cut into fans. Positions are the file's numbers, exactly.
/// The parts are the organs that the vertex properties `organ` and `kind` name (see to_ply), else one part "mesh".
///
/// GLB: glTF 2.0, all meshes of the default scene, with morph targets and animations. The parts are the nodes.
/// Positions are computed in double precision: base + weight x target, target by target, leaving out weights of 0; then
/// the nodes' transforms from the root's children down. So where nodes do not move their meshes and weights are 0 or 1,
/// they are sums of the file's numbers, rounded once each. If the scene has one root, its own transform is left out:
/// what turns, scales and moves everything together makes no crossings, and would only round. Skins, instances, sparse
/// and quantized accessors and compression are errors.
///
/// Errors: kParse with the place and the rule, such as "flower.ply: header line 7: ..."; kTooLarge beyond the limits
/// above. Any bytes are safe: time and memory are bounded by the size of the file, and for GLB by the limits.
Expected<CheckedMesh> read_mesh(std::string bytes, std::string_view file_name);

/// The mesh in a file. Errors as read_mesh, and kIo.
Expected<CheckedMesh> load_mesh(const std::string& path);

}  // namespace anthesis
