#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/corolla/hair_coat.h"
#include "anthesis/corolla/organ_shape.h"
#include "anthesis/geometry/mesh.h"

namespace anthesis {

/// The vertices and triangles of a template that wear one pigment. Groups do not share vertices.
struct TemplateGroup {
  std::string name;     ///< of the petals or column, as in the species file: "corolla", "stamens"
  std::string pigment;  ///< name of the pigment
  std::uint32_t first_vertex = 0;
  std::uint32_t vertex_count = 0;
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
};

/// The shape of an organ at every stage of its development, polygonized once: vertices move, triangles stay
/// (O16 section 2). Millimetres, the organ's base at the origin, its axis along +z, its outer (abaxial) side towards
/// +x.
class OrganTemplate {
 public:
  /// At least as many vertices as one template of `shape` has at `detail`, found without building it; exact but for
  /// columns that end in a point.
  static std::size_t count_vertices(const OrganShape& shape, double detail);

  /// `detail` scales the polygonization: 1 as the species file states it, 2 about four times the triangles.
  /// `variant` 0 is the shape as stated; any other number is an individual within the ranges of `shape.variation`.
  /// More than kMaxVertices vertices are kTooLarge, before anything is built; so are more hairs than
  /// HairCoat::kMaxHairs.
  static constexpr std::size_t kMaxVertices = 250'000;
  static Expected<OrganTemplate> build(const OrganShape& shape, double detail, std::uint64_t seed,
                                       std::uint32_t variant);

  std::span<const Triangle> triangles() const;
  std::span<const Vec2> uvs() const;
  std::span<const TemplateGroup> groups() const;
  std::size_t vertex_count() const;

  /// For each vertex the smallest index of those that share its place at every stage (fused margins, closed rings).
  std::span<const std::uint32_t> twins() const;

  /// The hairs on it, which are none of its vertices: they stand on any pose of it, bent or not. Two templates of one
  /// shape, seed and variant have about the same hairs whatever their detail, not one by one the same.
  const HairCoat& hairs() const;

  /// Positions and unit normals at `stage` in [0, 1]; spans of vertex_count(). About 0.1 microseconds a vertex.
  void pose(double stage, std::span<Vec3> positions_mm, std::span<Vec3> normals) const;

 private:
  struct State;
  explicit OrganTemplate(std::shared_ptr<const State> state) : state_(std::move(state)) {}
  std::shared_ptr<const State> state_;  ///< never changes, so that copies may share it
};

}  // namespace anthesis
