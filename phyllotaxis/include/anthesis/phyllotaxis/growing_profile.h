#pragma once
#include <cstddef>

namespace anthesis {

/// A growing surface of revolution with an active ring, as functions of time: what a model of phyllotaxis on a growing
/// head needs to know (docs/active-ring.md). Time runs over [0, 1]. A place on the half section is s, 0 at the apex and
/// 1 at the base; lengths are in one unit of the caller's choice.
///
/// All functions are pure and may be called from several threads. Arguments outside their range are clamped.
class GrowingProfile {
 public:
  GrowingProfile() = default;
  GrowingProfile(const GrowingProfile&) = default;
  GrowingProfile& operator=(const GrowingProfile&) = default;
  virtual ~GrowingProfile() = default;

  virtual double radius(double time, double s) const = 0;  ///< distance from the axis, >= 0
  virtual double length(double time) const = 0;            ///< of the half section, apex to base, > 0
  virtual double ring(double time) const = 0;              ///< s of the active ring

  /// Where the material line u is: 0 the apex, 1 the base, increasing in u at any time.
  virtual double s_from_material(double time, double u) const = 0;
  virtual double material_from_s(double time, double s) const = 0;  ///< the inverse

  /// Landmarks of the tissue are numbered from 1, the outermost; 0 is the base itself, landmarks() + 1 the apex.
  virtual std::size_t landmarks() const = 0;
  virtual double landmark(double time, std::size_t number) const = 0;  ///< its s
};

}  // namespace anthesis
