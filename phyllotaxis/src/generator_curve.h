#pragma once
#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/function_graph.h"
#include "anthesis/geometry/surface_of_revolution.h"

namespace anthesis {

/// A place on a generating curve: a share x in [0, 1] of one of its polynomial pieces, numbered from the base.
struct GeneratorPlace {
  std::uint32_t piece = 0;
  double x = 0.0;
  friend constexpr auto operator<=>(GeneratorPlace, GeneratorPlace) = default;
};

/// What an organ forbids to another on the generator of one azimuth: the places nearer to `centre` in the half plane
/// than sqrt((factor * (radius + theirs))^2 - aside2).
struct ForbiddenDisc {
  Vec2 centre;          ///< the organ's centre, projected on the half plane
  double aside2 = 0.0;  ///< square of its distance from that plane
  double radius_mm = 0.0;
};

/// The generating curve of a surface from base to tip, as polynomials, with the radius that an organ has at each place.
/// It answers where the curve leaves a disc.
class GeneratorCurve {
 public:
  struct Point {
    Vec2 position_mm;  ///< (radius, height)
    Vec2 derivative;   ///< by x of the piece
    double organ_mm = 0.0;
    double organ_derivative = 0.0;
  };

  /// Organs of one radius wherever they are: `Point::organ_mm` is 0 and the caller's radius is added.
  explicit GeneratorCurve(const SurfaceOfRevolution& surface) { build(surface, nullptr); }

  /// Organs whose radius depends on the place. The radius becomes a piecewise polynomial, within 1e-11 of `radius_mm`.
  GeneratorCurve(const SurfaceOfRevolution& surface, const FunctionGraph& radius_mm) { build(surface, &radius_mm); }

  Point at(GeneratorPlace place) const {
    const Piece& piece = pieces_[place.piece];
    Point point;
    point.position_mm = piece.power[degree_];
    for (int i = degree_ - 1; i >= 0; --i) {
      point.derivative = place.x * point.derivative + point.position_mm;
      point.position_mm = place.x * point.position_mm + piece.power[i];
    }
    if (organ_degree_ > 0) {
      point.organ_mm = piece.organ_power[organ_degree_];
      for (int i = organ_degree_ - 1; i >= 0; --i) {
        point.organ_derivative = place.x * point.organ_derivative + point.organ_mm;
        point.organ_mm = place.x * point.organ_mm + piece.organ_power[i];
      }
    }
    return point;
  }

  /// Profile parameter of the surface, 0 at the tip, 1 at the base, and back.
  double t_of(GeneratorPlace place) const {
    const Piece& piece = pieces_[place.piece];
    return piece.from + place.x * piece.width;
  }
  GeneratorPlace place_of(double t) const;

  /// Places as one number that grows towards the tip.
  static double number_of(GeneratorPlace place) { return place.piece + place.x; }
  GeneratorPlace place_at(double number) const {
    const auto piece = std::min(static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(pieces_.size() - 1));
    return {piece, number - piece};
  }

  GeneratorPlace tip() const { return {static_cast<std::uint32_t>(pieces_.size() - 1), 1.0}; }

  /// Numbers of two places, below and above `place`, between which the curve is at most `way_mm` from it along itself.
  std::array<double, 2> stretch_about(GeneratorPlace place, double way_mm) const;

  /// Least radius by place that is possible near a place; a bound.
  double least_organ_near_mm(GeneratorPlace place) const {
    const std::uint32_t last = static_cast<std::uint32_t>(pieces_.size()) - 1;
    return std::min({pieces_[place.piece].organ_least, pieces_[std::min(place.piece + 1, last)].organ_least,
                     pieces_[std::max(place.piece, 1u) - 1].organ_least});
  }

  /// Least and largest radius that organs have by place; bounds, within a few percent.
  double least_organ_mm() const { return least_organ_mm_; }
  double largest_organ_mm() const { return largest_organ_mm_; }

  /// No coordinate is larger.
  double extent_mm() const { return extent_mm_; }
  Vec2 low_mm() const { return low_mm_; }
  Vec2 high_mm() const { return high_mm_; }

  /// The first place after `from`, which the disc forbids to an organ of `own_mm` (added to the radius by place), where
  /// it no longer does. False if there is none up to the tip.
  bool leave(GeneratorPlace& from, const ForbiddenDisc& disc, double own_mm, double factor) const;

 private:
  struct Piece {
    double from = 0.0;   ///< profile parameter at x = 0
    double width = 0.0;  ///< negative: t falls towards the tip
    // Bounds over the piece, by x.
    double slowest = 0.0;
    double fastest = 0.0;
    double bend = 0.0;  ///< length of the second derivative
    double organ_least = 0.0;
    double organ_largest = 0.0;
    double organ_slope = 0.0;
    double organ_bend = 0.0;
    std::array<Vec2, kMaxDegree + 1> power{};  ///< position as a sum of power[i] x^i
    std::array<double, kMaxDegree + 1> organ_power{};
    std::array<Vec2, kMaxDegree + 1> control{};  ///< the same as Bezier curves of one common degree
    std::array<double, kMaxDegree + 1> organ_control{};
  };
  void build(const SurfaceOfRevolution& surface, const FunctionGraph* radius_mm);
  void finish(Piece& piece);
  bool leave_piece(std::uint32_t index, double& x, const ForbiddenDisc& disc, double own_mm, double factor) const;
  bool leave_by_subdivision(const Piece& piece, double& x, const ForbiddenDisc& disc, double own_mm,
                            double factor) const;
  double excess(const Piece& piece, double x, const ForbiddenDisc& disc, double own_mm, double factor,
                double& slope) const;

  int degree_ = 1;        ///< of the position
  int organ_degree_ = 0;  ///< of the radius by place
  double least_organ_mm_ = 0.0;
  double largest_organ_mm_ = 0.0;
  double extent_mm_ = 0.0;
  Vec2 low_mm_;
  Vec2 high_mm_;
  std::vector<Piece> pieces_;
};

}  // namespace anthesis
