#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "anthesis/geometry/vec.h"

namespace anthesis {

/// The largest coordinate, by magnitude, that the predicates take.
inline constexpr double kPredicateLimit = 1e100;

// Exact signs, -1, 0 or 1, of determinants of the very coordinates given: no tolerance and no rounding. Right for all
// doubles up to kPredicateLimit, the smallest subnormal ones among them. A few nanoseconds where a bound on the
// rounding of the ordinary computation decides; about a microsecond for points (nearly) in one line or plane, and a few
// more where their coordinates differ by hundreds of orders of magnitude. The same on every processor.
//
// Precondition: coordinates finite and at most kPredicateLimit (asserted).

/// On which side of the line from `a` to `b` the point `c` is: 1 left (a, b, c run counter-clockwise), -1 right, 0 on
/// it.
int orient2d(Vec2 a, Vec2 b, Vec2 c);

/// Two pieces of a broken line that touch or cross, by the numbers of the points they begin with; none if it is simple.
/// Neighbours may share their common point but must not run back over each other. `closed`: from the last point to the
/// first as well. O(n^2). Precondition: neighbouring points differ.
std::optional<std::array<std::size_t, 2>> crossing_pieces(std::span<const Vec2> line, bool closed);

/// On which side of the plane through a, b, c the point `d` is: 1 on the side from which a, b, c run counter-clockwise
/// (the side of the normal (b - a) x (c - a)), -1 on the other, 0 in the plane.
int orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// orient3d for one triangle and many points: the same answers in half the time.
class PlaneSide {
 public:
  PlaneSide() = default;  ///< of three equal points
  PlaneSide(Vec3 a, Vec3 b, Vec3 c) : corners_{a, b, c} {
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    normal_ = cross(ab, ac);
    size_ = std::max({std::fabs(ab.y * ac.z) + std::fabs(ab.z * ac.y), std::fabs(ab.z * ac.x) + std::fabs(ab.x * ac.z),
                      std::fabs(ab.x * ac.y) + std::fabs(ab.y * ac.x)});
  }

  /// orient3d(a, b, c, d)
  int operator()(Vec3 d) const {
    const int sign = quick(d);
    return sign != 0 ? sign : orient3d(corners_[0], corners_[1], corners_[2], d);
  }

  /// The same where the rounded determinant decides, else 0.
  int quick(Vec3 d) const {
    const Vec3 ad = d - corners_[0];
    const double determinant = dot(normal_, ad);
    const double positive = size_ * (std::fabs(ad.x) + std::fabs(ad.y) + std::fabs(ad.z));
    const double bound = kRelativeError * positive + kUnderflow;
    return static_cast<int>(determinant > bound) - static_cast<int>(determinant < -bound);
  }

  const std::array<Vec3, 3>& corners() const { return corners_; }

  /// (b - a) x (c - a), rounded.
  Vec3 normal() const { return normal_; }

  /// Of the rounded determinant, relative to the same with all terms taken positive (Shewchuk 1997, "Adaptive precision
  /// floating-point arithmetic and fast robust geometric predicates", stage A of his orient3d).
  static constexpr double kRelativeError = (7.0 + 56.0 * 0x1p-53) * 0x1p-53;
  /// What products too small for a double may lose besides: a few times 5e-324, times at most 2e100.
  static constexpr double kUnderflow = 1e-220;

 private:
  std::array<Vec3, 3> corners_;
  Vec3 normal_;
  double size_ = 0.0;  ///< the largest coordinate of the normal with all terms taken positive
};

}  // namespace anthesis
