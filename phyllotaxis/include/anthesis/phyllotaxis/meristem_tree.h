#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/phyllotaxis/meristem_dynamics.h"

namespace anthesis {

/// The meristems of one level of a hierarchy. All of them live through the same history, each from its own beginning.
struct MeristemLevel {
  MeristemDynamicsParams dynamics;  ///< against the age of the meristem, which runs from 0 to 1

  // When an element becomes a meristem of this level: as soon as both hold. Not for level 0, which is one from time 0.
  double onset_age = 0.0;       ///< its age, finite, >= 0
  double onset_area_mm2 = 0.0;  ///< its area, on the scale of its parent's dynamics; > 0: its growth must never fall
};

/// Patterns on patterns: the elements of a meristem become meristems with elements of their own (O16 figs. 12 and 13).
struct MeristemTreeParams {
  /// Level n is at levels[n]; the last entry serves all further levels, so a single one makes a self-similar pattern.
  std::vector<MeristemLevel> levels;

  int depth = 1;      ///< levels of elements below the root, >= 1; elements of the last never become meristems
  double fill = 0.7;  ///< share of an element's area that its own rim encircles, (0, 1]; below 0.7 few circles overlap
};

std::optional<Error> check(const MeristemTreeParams& params);

/// An element of the hierarchy, the whole meristem included.
struct MeristemElement {
  static constexpr std::uint32_t kNoParent = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t parent = kNoParent;  ///< index of the element that carries it, always a smaller one
  std::uint32_t level = 0;           ///< 0 for the whole
  std::uint32_t order = 0;           ///< among the elements of its parent, by birth
  double birth = 0.0;
  double onset = 0.0;        ///< time at which it becomes a meristem; infinite if it never does by time 1
  double azimuth_rad = 0.0;  ///< in its parent's frame, [0, 2 pi)
};

/// A hierarchy of patterns as a function of time. An element stands on the surface of the meristem that carries it,
/// upright on it and turned by the rule that O16 draws from Hofmeister's: its own first element lies as far as possible
/// from the centre of the meristem that carries it. See docs/meristem-dynamics.md.
class MeristemTree {
 public:
  /// Errors of a level's dynamics have "levels[n]." before their field. More than `limit` elements are kTooLarge.
  /// O(elements), beside one run of the dynamics for each level.
  static Expected<MeristemTree> run(MeristemTreeParams params, std::size_t limit, const Progress& progress = {});

  /// In order of birth; the first is the whole meristem.
  std::span<const MeristemElement> elements() const { return elements_; }

  /// Number of elements born by `time` >= 0; they are the first so many.
  std::size_t born(double time) const;

  /// world_from_element of the first born(time) elements, in parallel. In its own frame an element stands on the plane
  /// z = 0 with +z the normal of its parent's surface, +x away from that surface's apex; its rim is the unit circle, so
  /// the scale is its radius. One surface for each meristem and time: 0.1 ms each.
  std::vector<Placement> places(double time) const;

  /// The surface of an element that is born by `time`, in its own frame: the rim is the unit circle at height 0. Before
  /// it becomes a meristem it has the shape of one at age 0.
  SurfaceOfRevolution surface(std::size_t element, double time) const;

  /// The pattern that all meristems of a level share, against their age: time - onset.
  const MeristemDynamics& dynamics(std::size_t level) const;

 private:
  explicit MeristemTree(MeristemTreeParams params) : params_(std::move(params)) {}
  std::size_t entry(std::size_t level) const;
  std::optional<Error> bear(std::size_t limit, const Progress& progress);

  MeristemTreeParams params_;
  std::vector<MeristemDynamics> dynamics_;  ///< by entry of params_.levels
  std::vector<MeristemElement> elements_;
  std::vector<std::uint32_t> children_;     ///< of all elements, one after another, each's in order of birth
  std::vector<std::uint32_t> first_child_;  ///< into children_, by element, with the end behind the last
};

}  // namespace anthesis
