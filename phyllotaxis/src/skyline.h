#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "generator_curve.h"

namespace anthesis {

/// What is proven to be forbidden on all generators of a sector of azimuths: everything below a place, and some
/// stretches above it. Places are numbers as GeneratorCurve::number_of gives them.
class ForbiddenStretches {
 public:
  double all_below() const { return all_below_; }

  /// The end of the stretch that a place lies in, or the place itself.
  double pass(double place) const {
    if (place < all_below_) {
      return all_below_;
    }
    for (int i = 0; i < count_; ++i) {
      if (place < stretch_[i][1]) {
        return place >= stretch_[i][0] ? stretch_[i][1] : place;
      }
    }
    return place;
  }

  void add(double from, double to);
  void add_all_below(double place);

  /// What both forbid.
  friend ForbiddenStretches common(const ForbiddenStretches& a, const ForbiddenStretches& b);

 private:
  static constexpr int kMost = 6;

  double all_below_ = 0.0;
  int count_ = 0;
  std::array<std::array<double, 2>, kMost> stretch_{};  ///< ascending, apart from each other
};

/// The proven part of the surface for organs of at least one radius, sector by sector: where a climb need not look.
/// Each organ adds what it forbids in the sectors about it, by bounds that need no root: about eight square roots.
class Skyline {
 public:
  /// Forgets all: organs may have this radius now, or a larger one. With radii by place it is 0.
  void reset(double floor_mm);
  double floor_mm() const { return floor_mm_; }

  ForbiddenStretches& at(double azimuth_rad) { return sectors_[index_of(azimuth_rad)]; }
  double middle_of(double azimuth_rad) const { return (index_of(azimuth_rad) + 0.5) * sector_rad(); }
  double half_angle() const { return (0.5 + 1e-9) * sector_rad(); }

  /// An organ at a place of the curve, at a distance from the axis, that keeps others `distance_mm` away.
  void add(const GeneratorCurve& curve, GeneratorPlace place, double axis_mm, double azimuth_rad, double distance_mm);

 private:
  double sector_rad() const;
  std::uint32_t index_of(double azimuth_rad) const;
  void fit_sectors(double axis_mm, double distance_mm);

  double floor_mm_ = 0.0;
  std::uint64_t since_fit_ = 0;
  std::vector<ForbiddenStretches> sectors_;  ///< a power of two of them
};

}  // namespace anthesis
