#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "anthesis/geometry/surface_of_revolution.h"

namespace anthesis::detail {

/// The generating curve of a surface of revolution by the conformal coordinate u: du = ds / radius, downwards from a
/// start. Turns of azimuth and u / (2 pi) unroll the surface without distorting angles.
class ConformalProfile {
 public:
  /// From the relative position `s_first` to the base. Precondition: the radius is > 0 there and below.
  ConformalProfile(const SurfaceOfRevolution& surface, double s_first) : s_first_(s_first) {
    places_.reserve(kSteps + 1);
    u_.reserve(kSteps + 1);
    double u = 0.0;
    for (std::size_t i = 0; i <= kSteps; ++i) {
      if (i > 0) {
        // Three-point Gauss: the integrand is smooth but for the knots of the profile. Even steps of a power of s, as
        // fine near a thin start as the radius asks.
        const double from = s_at(i - 1);
        const double to = s_at(i);
        const double centre = 0.5 * (from + to);
        const double reach = 0.5 * (to - from) * 0.7745966692414834;
        const auto density = [&](double s) { return 1.0 / surface.radius_mm(surface.t_from_s(s)); };
        u += surface.length_mm() * (to - from) *
             (5.0 * density(centre - reach) + 8.0 * density(centre) + 5.0 * density(centre + reach)) / 18.0;
      }
      u_.push_back(u);
      places_.push_back(surface.profile_mm().at(surface.t_from_s(s_at(i))));
    }
  }

  double last() const { return u_.back(); }

  /// (radius, height) at u. Below the base the surface goes on as a cylinder.
  Vec2 place_mm(double u) const {
    if (u >= u_.back()) {
      const Vec2 base = places_.back();
      return {base.x, base.y - (u - u_.back()) * base.x};
    }
    const std::size_t i = std::clamp<std::size_t>(std::upper_bound(u_.begin(), u_.end(), u) - u_.begin(), 1, kSteps);
    return lerp(places_[i - 1], places_[i], std::max(0.0, (u - u_[i - 1]) / (u_[i] - u_[i - 1])));
  }

  /// u at the relative position s, at least 0.
  double u_at(double s) const {
    const double share = std::clamp((s - s_first_) / (1.0 - s_first_), 0.0, 1.0);
    const double place = std::sqrt(std::sqrt(share)) * kSteps;
    const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(place), kSteps - 1);
    const double from = s_at(i);
    const double f = std::clamp((s - from) / (s_at(i + 1) - from), 0.0, 1.0);
    return (1.0 - f) * u_[i] + f * u_[i + 1];
  }

 private:
  static constexpr std::size_t kSteps = 4096;

  double s_at(std::size_t i) const {
    const double share = static_cast<double>(i) / kSteps;
    return s_first_ + (1.0 - s_first_) * share * share * share * share;
  }

  double s_first_;
  std::vector<double> u_;
  std::vector<Vec2> places_;
};

}  // namespace anthesis::detail
