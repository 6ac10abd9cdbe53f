#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Three vertex indices, counter-clockwise seen from the outer (or upper) side.
using Triangle = std::array<std::uint32_t, 3>;

/// An indexed triangle mesh. `normals` and `uvs` are empty or as long as `positions_mm`.
struct Mesh {
  std::vector<Vec3> positions_mm;
  std::vector<Vec3> normals;  ///< unit
  std::vector<Vec2> uvs;      ///< (u, v) of the surface: u across in [0, 1], v from base to tip in [0, 1]
  std::vector<Triangle> triangles;
};

/// Twice the area of a triangle, along its normal.
Vec3 area_vector(const std::vector<Vec3>& positions_mm, const Triangle& triangle);

/// Angle-weighted vertex normals (Thürmer and Wüthrich 1998), written to `normals` (as long as `positions_mm`).
/// `twin[i]` is the smallest index of the vertices that share the place of i (i itself where none does): twins get one
/// common normal, so that seams do not show. An empty span means no twins. O(vertices + triangles).
void smooth_normals(std::span<const Vec3> positions_mm, std::span<const Triangle> triangles,
                    std::span<const std::uint32_t> twin, std::span<Vec3> normals);

}  // namespace anthesis
