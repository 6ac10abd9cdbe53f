#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/geometry/mesh.h"

namespace anthesis {

/// How the vertices of an organ hang together, wherever they are: one for all organs of a template (O16 section 3).
/// Stiffnesses are the share of a constraint's error that one projection removes, in [0, 1]; 0 leaves it out.
struct Sheet {
  std::size_t vertex_count = 0;
  std::vector<Triangle> triangles;
  std::vector<Vec3> shape_mm;  ///< a typical shape, by which the triangles are grouped in space; empty: the first seen

  std::vector<std::array<std::uint32_t, 2>> edges;  ///< each edge once, smaller vertex first, ascending
  std::vector<double> edge_stiffness;               ///< one for each edge

  /// Pairs of triangles that share an edge: its two vertices, then the apex of the triangle that runs from the first
  /// to the second vertex, then the apex of the other one. Of an edge with more than two triangles each next pair.
  std::vector<std::array<std::uint32_t, 4>> hinges;
  std::vector<double> hinge_stiffness;  ///< one for each hinge

  std::vector<std::uint32_t> attached;       ///< vertices that are held in place, ascending
  std::vector<double> attachment_stiffness;  ///< one for each attached vertex
};

/// The edges and hinges of a mesh, all stiffnesses 1 and nothing attached. O(triangles log triangles).
/// Precondition: indices below `vertex_count`, no triangle with a vertex twice (asserted).
Sheet make_sheet(std::size_t vertex_count, std::span<const Triangle> triangles);

/// The signed angle by which the two triangles of a hinge turn out of one plane, in (-pi, pi]: 0 flat, positive when
/// the apexes lie on the side that the triangles' normals point away from.
double hinge_angle_rad(Vec3 edge_first, Vec3 edge_second, Vec3 apex, Vec3 other_apex);

}  // namespace anthesis
