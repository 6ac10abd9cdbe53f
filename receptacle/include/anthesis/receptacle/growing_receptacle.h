#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/bspline.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/phyllotaxis/growing_profile.h"

namespace anthesis {

/// The half section of one head at one stage, as it was traced on a scan. Places on it are shares s of its arc length,
/// 0 at the apex and 1 at the base.
struct DigitisedSection {
  BSplineCurve<Vec2> profile;  ///< (radius, height), apex first; radii >= 0; the unit is the caller's
  std::vector<double>
      landmarks;      ///< s of the same organs on every section, from the base inwards: descending, in (0, 1]
  double ring = 0.0;  ///< s of the active ring, in [0, 1]
};

/// A section given by sample points instead of control points: straight from each to the next.
/// Precondition: at least two points.
BSplineCurve<Vec2> traced_profile(std::vector<Vec2> points);

/// Sections of heads of different age that stand for the growth of one head (O24, C-model).
struct DigitisedHead {
  std::vector<DigitisedSection> sections;  ///< youngest first, at least 3; later ones have no fewer landmarks

  /// In time, of the quadratic B-spline that blends the sections: three more than sections, ascending, beginning with
  /// three zeros and ending with three ones. Empty: equally spaced.
  std::vector<double> knots;

  double scale = 1.0;  ///< factor from the sections' unit, > 0
};

/// Where an outline touches or crosses itself, about; none if it is simple. O(points^2).
std::optional<Vec2> place_of_crossing(std::span<const Vec2> outline);

/// What is wrong with a head, if anything; sections must not cross themselves. `where` is like
/// "sections[2].landmarks[1]". At most 100 sections with at most 10,000 control points together.
std::optional<Error> check(const DigitisedHead& head);

/// How places on a section are looked up.
enum class SectionLookup {
  kExact,  ///< on the curve itself; the material coordinate is inverted exactly

  /// As the program published with O24 does: 100 points equally far apart along 1,000 chords a piece, joined by
  /// straight lines; lengths are 2,000 chords; material coordinates are multiples of 0.001.
  kAsPublished,
};

class GrownProfile;

/// The C-model of O24: profile and active ring of a growing head as functions of time. See docs/receptacle.md.
///
/// Built in some milliseconds. Then `point` costs about 0.1 microseconds, `s_from_material` and its inverse less,
/// `length` about 3. Copies share the tables.
class GrowingReceptacle final : public GrowingProfile {
 public:
  /// Precondition: check(head) finds nothing.
  explicit GrowingReceptacle(const DigitisedHead& head, SectionLookup lookup = SectionLookup::kExact);

  /// Blends the sections at equal s: (radius, height) = scale * sum of B_k(time) C_k(s); radius >= 0.
  Vec2 point(double time, double s) const;
  double radius(double time, double s) const override { return point(time, s).x; }

  /// Of the half section. s is not exactly the share of this length: sections are blended at equal s, and a blend of
  /// curves that are each run through evenly is not.
  double length(double time) const override;

  double ring(double time) const override;

  std::size_t landmarks() const override;  ///< as many as the last section has

  /// A landmark that a young section lacks keeps its ratio to the landmark outside it.
  double landmark(double time, std::size_t number) const override;

  double s_from_material(double time, double u) const override;
  double material_from_s(double time, double s) const override;

  SectionLookup lookup() const;

  /// The whole profile of one moment, for many questions. About 5 microseconds, and 20 for its arc length.
  GrownProfile at(double time) const;

 private:
  struct Tables;
  std::shared_ptr<const Tables> tables_;
  friend class GrownProfile;
};

/// The half section at one moment.
class GrownProfile {
 public:
  Vec2 point(double s) const;

  double length() const { return before_.back(); }  ///< of the curve (or polygon, as published) itself
  double length_to(double s) const;                 ///< from the apex
  double s_at_length(double length) const;          ///< the inverse, clamped to the profile

 private:
  friend class GrowingReceptacle;

  std::shared_ptr<const GrowingReceptacle::Tables> tables_;
  std::vector<double> x_;  ///< Chebyshev coefficients, interval after interval
  std::vector<double> y_;
  std::vector<double> density_;  ///< of the length within an interval: Legendre coefficients
  std::vector<double> before_;   ///< length up to each interval; one more than intervals
};

}  // namespace anthesis
