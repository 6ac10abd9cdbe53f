#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// A range that individuals of a species vary within: lowest and highest value.
using Range = std::array<double, 2>;

/// A point of the half cross-section of a petal, in units of the petal's half width there.
struct SectionPoint {
  double across = 0.0;   ///< 0 at the midrib, then >= 0, 1 where the half width is reached; may come back: a tube
  double up = 0.0;       ///< towards the upper (adaxial) side; negative hangs down
  double forward = 0.0;  ///< towards the tip: teeth, notches and rounded ends
};

/// A petal at one key stage of its development: a row of control points across the petal at each control point of its
/// midrib. Equal poses of one petal have equal numbers of points (O16 section 2).
struct PetalPose {
  double stage = 0.0;                 ///< in [0, 1], ascending over the poses
  std::vector<Vec2> midrib_mm;        ///< (outward, up) control points, base to tip: at least degree + 1
  std::vector<double> half_width_mm;  ///< one for each midrib point, >= 0
  std::vector<double> side_mm;        ///< sideways shift of each row; empty: none, the petal is symmetric
  /// Half cross-sections: empty (flat), one for all rows, or one for each row, all of equal length >= 2.
  std::vector<std::vector<SectionPoint>> sections;
};

/// A set of petals that share one shape: a ring of `count` by rotation, or a pair by reflection.
struct Petals {
  std::string name;
  std::string pigment;
  int count = 1;             ///< copies by rotation about the floret's axis, 1 to 64
  bool mirrored = false;     ///< a second copy, reflected in the floret's plane of symmetry y = 0
  double azimuth_deg = 0.0;  ///< of the first petal; 0 is outward
  int fused = 0;             ///< boundary control points, from the base up, shared with the neighbouring petal
  std::string fused_with;    ///< name of an earlier petal set whose margin it shares; empty: its own copies' margins
  int degree_across = 3;     ///< of the B-spline surface in u, 1 to 5
  int degree_along = 3;      ///< of the B-spline surface in v, 1 to 5
  std::vector<Vec2> spacing = {{0.0, 0.2}, {1.0, 0.2}};   ///< lambda(v) of O16 eq. 1: distance between vertex rows
  std::vector<Vec2> vertices = {{0.0, 3.0}, {1.0, 3.0}};  ///< eta(v) of O16 section 2: vertices across
  std::vector<PetalPose> poses;
};

/// A solid of revolution at one key stage: stamens, styles, ovaries, pappus bristles.
struct ColumnPose {
  double stage = 0.0;
  std::vector<Vec2> profile_mm;  ///< (radius, height) control points, base to top, at least degree + 1
  double lean_deg = 0.0;         ///< away from the floret's axis
};

struct Column {
  std::string name;
  std::string pigment;
  int count = 1;                ///< copies by rotation about the floret's axis, 1 to 256
  double azimuth_deg = 0.0;     ///< of the first copy
  double ring_radius_mm = 0.0;  ///< distance of the copies' bases from the axis
  double base_mm = 0.0;         ///< height of the copies' bases
  int sides = 6;                ///< vertices around, 3 to 64
  int rings = 6;                ///< vertices along, 2 to 64
  int degree = 3;               ///< of the profile curve, 1 to 5
  std::vector<ColumnPose> poses;
};

/// Hairs that stand on a surface: on a petal or column of an organ, or on the stem. They are drawn only and take no
/// part in touching. Each range is drawn from once for each hair.
struct Hairs {
  std::string on;                   ///< name of the petals or column of the same organ; empty on the stem
  std::string pigment;              ///< v = 0 is a hair's root, v = 1 its tip
  bool upper = true;                ///< on the upper side of petals, on the outside of what is round
  bool lower = false;               ///< on the lower side of petals
  double density_per_mm2 = 1.0;     ///< of each side, when it is full grown; (0, 1000]
  Range along = {0.0, 1.0};         ///< the part from base to tip that they stand on
  Range length_mm = {1.0, 1.0};     ///< of a full grown organ, in (0, 1000]
  double radius_mm = 0.02;          ///< at the root; hairs end in a point
  Range lean_deg = {0.0, 0.0};      ///< from the surface's normal towards its tip, at the root
  Range swirl_deg = {-30.0, 30.0};  ///< turn of the lean's direction about the normal
  Range bend_deg = {0.0, 0.0};      ///< further lean over the length
};

/// What makes one organ differ in shape from the next, in ranges.
struct ShapeVariation {
  Range curl_deg = {0.0, 0.0};   ///< extra bend of the midrib over its length, backwards when positive
  Range twist_deg = {0.0, 0.0};  ///< turn of the tip about the midrib
  Range sway_deg = {0.0, 0.0};   ///< extra bend sideways over its length
  Range width = {1.0, 1.0};      ///< factor of the width
};

/// Everything about the form of one kind of organ: a floret with corolla, stamens and pistil; a bract; a leaf.
struct OrganShape {
  std::vector<Petals> petals;
  std::vector<Column> columns;
  std::vector<Hairs> hairs;
  ShapeVariation variation;
};

/// What is wrong with `shape`, if anything; `where` names it in the message ("organs.ray_floret").
std::optional<Error> check(const OrganShape& shape, std::string_view where);

/// What is wrong with the numbers of `hairs`, if anything.
std::optional<Error> check(const Hairs& hairs, std::string_view where);

}  // namespace anthesis
