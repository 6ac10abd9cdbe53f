#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "anthesis/corolla/organ_shape.h"
#include "anthesis/geometry/mesh.h"

namespace anthesis {

/// The hairs of a surface whose vertices move while its triangles stay. Each hair stands on one triangle, so it goes
/// with the surface wherever development or touching takes that.
///
/// Hairs are drawn, not grown: they are no part of the meshes that touch, that are certified and that are written.
class HairCoat {
 public:
  /// Hairs on one run of triangles, under their pigment.
  struct Group {
    std::string on;  ///< what they stand on
    std::string pigment;
    std::uint32_t first_hair = 0;
    std::uint32_t hair_count = 0;
  };
  static constexpr std::size_t kMaxHairs = 20'000;

  /// Plants `hairs` on a surface with the given vertices when it is full grown, spread in proportion to its area. Where
  /// each stands and what it is like is a function of (seed, key, its number). Their number on each side, area times
  /// density, is rounded; where that makes more than kMaxHairs in all, they stand farther apart. Returns the number
  /// asked for. O(triangles + hairs).
  /// Precondition: check(hairs, ..) finds nothing; uvs and positions of equal length; key < 2^32.
  double plant(const Hairs& hairs, std::span<const Triangle> triangles, std::span<const Vec2> uvs,
               std::span<const Vec3> grown_mm, std::uint64_t seed, std::uint64_t key);

  std::size_t hair_count() const { return roots_.size(); }
  std::span<const Group> groups() const { return groups_; }

  /// The hairs of group `group` on the surface with the given vertices and unit normals, appended to `mesh`, their
  /// lengths and radii times `scale`. Their u runs around a hair, v from its root to its tip. O(hairs).
  void append(std::size_t group, std::span<const Vec3> positions_mm, std::span<const Vec3> normals, double scale,
              Mesh& mesh) const;

 private:
  struct Root {
    Triangle triangle = {};                  ///< of the surface
    std::array<double, 3> weight = {};       ///< of its corners
    std::array<double, 2> towards_tip = {};  ///< weights of its edges 01 and 02 in the direction of growing v
    bool lower = false;                      ///< stands on the lower side
    double length_mm = 0.0;
    double lean_rad = 0.0;
    double swirl_rad = 0.0;
    double bend_rad = 0.0;
  };
  struct Kind {
    double radius_mm = 0.0;
    int pieces = 1;  ///< along a hair
  };
  std::vector<Root> roots_;
  std::vector<Group> groups_;
  std::vector<Kind> kinds_;  ///< by group
};

}  // namespace anthesis
