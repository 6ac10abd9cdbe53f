#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/corolla/organ_template.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Lets the surface of a fine template follow a coarse one of the same shape that was bent: for pictures, whose
/// outlines show facets that the mechanics of a coarse mesh does not mind.
///
/// Each coarse vertex moves and turns with the triangles around it; a fine vertex takes the mean of its coarse
/// neighbours' motions, weighed by where it lies between them in (u, v) of the same copy of the petal or column, such
/// that a bent row of coarse vertices becomes a smooth arc through them.
class SurfaceFollower {
 public:
  /// Precondition: templates of the same OrganShape, seed and variant, at any two levels of detail (asserted as far as
  /// their groups and copies tell).
  SurfaceFollower(const OrganTemplate& coarse, const OrganTemplate& fine);

  /// `rest_mm`: the coarse template's pose. `bent_mm`: where its vertices are instead. `fine_mm`: the fine template's
  /// pose in the same frame as `rest_mm`; overwritten by where it follows to. If nothing was bent that is the pose
  /// itself, exactly; if the coarse surface was moved as a rigid body, so is the fine one, up to rounding.
  /// O(vertices + triangles). May be called from many threads.
  void follow(std::span<const Vec3> rest_mm, std::span<const Vec3> bent_mm, std::span<Vec3> fine_mm) const;

 private:
  struct Neighbour {
    std::uint32_t vertex = 0;  ///< of the coarse template
    double weight = 0.0;
  };
  OrganTemplate coarse_;
  OrganTemplate fine_;
  std::vector<std::array<Neighbour, 4>> neighbours_;  ///< of each fine vertex; weights sum to 1, unused ones are 0
};

}  // namespace anthesis
