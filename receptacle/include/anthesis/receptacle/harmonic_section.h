#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/mesh.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

// The H-model of O24: harmonic functions inside the half section of a head. See docs/harmonic-interior.md.
//
// A section is a polygon of control points (radius, height), apex first, along the contour to the rim and along the
// base to the axis: the first and the last point lie on the axis, all others beside it. The axis closes the polygon.

/// What is wrong with a section, if anything: coordinates must be finite, the radius 0 at the first and the last point
/// and >= 0 elsewhere, the height of the first above that of the last. That the polygon must not touch or cross itself
/// is checked where it is triangulated.
std::optional<Error> check_section(std::span<const Vec2> controls);

/// Whether a point with radius >= 0 lies inside a section, the axis included; on contour and base either answer.
/// Exact; O(controls).
bool is_in_section(std::span<const Vec2> controls, Vec2 p);

struct SectionMeshParams {
  /// The longest edge inside, as a share of the section's size (the larger of width and height); in [0.002, 1].
  double max_edge = 0.0625;
};

std::optional<Error> check(const SectionMeshParams& params);

/// Where a point of the boundary lies: the share `t` of the way from one control point to a later one.
struct SectionPlace {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  double t = 0.0;
};

/// A triangulated section.
struct SectionMesh {
  std::vector<Vec2> points;             ///< those on the contour and base in order, those inside the axis, the others
  std::vector<Triangle> triangles;      ///< counter-clockwise
  std::vector<SectionPlace> places;     ///< of the points on contour and base
  std::size_t axis_points = 0;          ///< from base to apex; the ends of the axis are control points
  std::vector<std::uint32_t> controls;  ///< the control points that are points of the mesh, ascending

  std::size_t contour_points() const { return places.size(); }

  /// The same on the moved boundary: where the points of contour and base lie with other control points.
  Vec2 contour_point(std::size_t i, std::span<const Vec2> control_points) const {
    const SectionPlace& place = places[i];
    return place.t == 0.0 ? control_points[place.from]
                          : lerp(control_points[place.from], control_points[place.to], place.t);
  }
};

/// Triangulates a section by Delaunay refinement (Ruppert 1995, with the off-centres of Uengoer 2004): angles of at
/// least 25 degrees except where the polygon itself is sharper, and every edge inside locally Delaunay.
///
/// Control points nearer to each other than 1e-5 of the section's size become one: the last of them counts, except that
/// the apex stays. Some milliseconds for 100 control points; the same triangles on every machine. Errors: what
/// check_section finds; a polygon that touches or crosses itself; more than 200,000 points (kTooLarge).
Expected<SectionMesh> triangulate_section(std::span<const Vec2> controls, const SectionMeshParams& params = {});

/// What holds on the axis.
enum class AxisCondition {
  kNatural,  ///< no slope across the axis (O24): the function goes on evenly on the other side
  kZero,     ///< the function is 0 there and goes on oddly, as a radius does
};

/// One section, made ready to extend functions from its boundary.
class HarmonicSection {
 public:
  /// Errors as triangulate_section.
  static Expected<HarmonicSection> make(std::span<const Vec2> controls, const SectionMeshParams& params = {});

  const SectionMesh& mesh() const;
  std::size_t controls() const;

  /// Values at the points of the mesh of the function that is harmonic inside, has `values` at the control points and
  /// is linear between them. No value inside lies beyond those on the boundary (with kNatural). With kZero the values
  /// of the first and the last control point count as 0.
  ///
  /// Precondition: one value for each control point.
  std::vector<double> extend(std::span<const double> values, AxisCondition axis = AxisCondition::kNatural) const;

  /// The harmonic coordinates: `row(i, weights)` for each control point i in turn, with its field at the points of the
  /// mesh, in [0, 1]. Rows sum to 1 at each point. The field of a control point that became one with another is 0.
  void weights(const std::function<void(std::size_t, std::span<const double>)>& row) const;

 private:
  struct Parts;
  explicit HarmonicSection(std::shared_ptr<const Parts> parts);
  std::shared_ptr<const Parts> parts_;
};

}  // namespace anthesis
