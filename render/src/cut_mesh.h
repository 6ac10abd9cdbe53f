#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/geometry/mesh.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// The points beyond a plane are those with dot(normal, point) > distance.
struct CutPlane {
  Vec3 normal;  ///< unit
  double distance = 0.0;
};

/// A mesh of closed surfaces whose vertices bear a label: what they are made of.
struct LabelledMesh {
  Mesh mesh;  ///< with normals, without uvs
  std::vector<std::uint8_t> labels;
};

/// Takes away what is beyond the plane and closes the surfaces by flat faces in it. O(vertices + triangles), and for
/// each face between the square and the cube of its corners.
LabelledMesh cut(const LabelledMesh& from, const CutPlane& plane);

/// Triangles of a simple polygon given counter-clockwise, without new points: n - 2 of them, by ears. A polygon that
/// crosses itself gives triangles too, some of them turned over.
std::vector<Triangle> triangulate_polygon(std::span<const Vec2> polygon);

}  // namespace anthesis
