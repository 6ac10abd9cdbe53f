#pragma once
// The published algorithm of the active ring word for word: every angle against every primordium. Slow and plain, to
// compare grow_active_ring_as_published with, in outcome and in speed.
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "anthesis/phyllotaxis/active_ring.h"

namespace anthesis::test {

struct ScannedPrimordium {
  std::uint32_t born = 0;
  double born_azimuth = 0.0;
  double s = 0.0;
  double u = 0.0;
  double azimuth = 0.0;
  double radius = 0.0;
  std::size_t left = 0;
  std::size_t right = 0;
};

inline std::vector<ScannedPrimordium> full_scan(const GrowingProfile& profile, const ActiveRingParams& params) {
  constexpr double kTurn = math::kTurnRad;
  std::vector<ScannedPrimordium> all;
  double time = 0.0;
  double step_size = params.time_step;
  double ring = profile.ring(0.0);
  double ring_radius = profile.radius(0.0, ring);
  double threshold = params.threshold(0.0);
  for (std::uint32_t step = 1; time < 1.0; ++step) {
    if (ring < 0.01 && step_size > 0.1 * params.time_step) {
      step_size *= 0.993;
    }
    time = std::min(1.0, time + step_size);
    const double length = profile.length(time);
    for (ScannedPrimordium& one : all) {
      one.s = profile.s_from_material(time, one.u);
    }
    for (ScannedPrimordium& one : all) {
      const ScannedPrimordium& left = all[one.left];
      const ScannedPrimordium& right = all[one.right];
      if (all.size() > 1 && one.s < params.mobile_zone * ring && one.born >= left.born && one.born >= right.born) {
        const bool to_left = left.born < right.born;
        const ScannedPrimordium& other = to_left ? left : right;
        const double mean = 0.5 * (one.radius + other.radius);
        const double apart = std::abs(one.azimuth - other.azimuth);
        const double across = mean * std::min(apart, kTurn - apart);
        const double along = length * (one.s - other.s);
        const double distance = std::sqrt(across * across + along * along);
        const double a = across / distance;
        const double change = params.relaxation * params.time_step * a * (across - a * threshold) / mean;
        one.azimuth += to_left ? -change : change;
        one.azimuth -= kTurn * std::floor(one.azimuth / kTurn);
      }
      one.radius = profile.radius(time, one.s);
    }
    const auto distance_squared = [&](const ScannedPrimordium& one, double azimuth) {
      const double apart = std::abs(azimuth - one.azimuth);
      const double across = 0.5 * (ring_radius + one.radius) * std::min(apart, kTurn - apart);
      const double along = length * (ring - one.s);
      return across * across + along * along;
    };
    double angle = params.first_azimuth_rad;
    for (; ring > params.last_ring && angle < params.first_azimuth_rad + kTurn; angle += params.angular_step_rad) {
      const double azimuth = angle <= kTurn ? angle : angle - kTurn;
      bool free = true;
      std::array<std::pair<double, std::size_t>, 3> nearest;
      nearest.fill({std::numeric_limits<double>::infinity(), 0});
      for (std::size_t i = 0; i < all.size() && free; ++i) {
        const double squared = distance_squared(all[i], azimuth);
        free = !(squared < threshold * threshold);
        std::pair<double, std::size_t> here{std::sqrt(squared), i};
        for (auto& place : nearest) {
          if (here < place) {
            std::swap(here, place);
          }
        }
      }
      if (!free) {
        continue;
      }
      ScannedPrimordium made;
      made.born = step;
      made.born_azimuth = made.azimuth = azimuth;
      made.s = ring;
      made.u = profile.material_from_s(time, ring);
      made.radius = profile.radius(time, ring);
      if (all.size() >= 2) {
        if (nearest[2].first - nearest[0].first < 1e-5) {
          std::size_t oldest = 0;
          for (std::size_t k = 1; k < 3; ++k) {
            oldest = all[nearest[k].second].born < all[nearest[oldest].second].born ? k : oldest;
          }
          for (std::size_t k = oldest; k < 2; ++k) {
            nearest[k] = nearest[k + 1];
          }
        }
        const double ahead = all[nearest[0].second].azimuth - azimuth;
        const bool first_is_left = ahead - kTurn * std::floor(ahead / kTurn) >= math::kPi;
        made.left = nearest[first_is_left ? 0 : 1].second;
        made.right = nearest[first_is_left ? 1 : 0].second;
      }
      all.push_back(made);
      all[made.left].right = all.size() - 1;
      all[made.right].left = all.size() - 1;
    }
    ring = profile.ring(time);
    ring_radius = profile.radius(time, ring);
    if (all.size() <= params.threshold_frozen_above) {
      threshold = params.threshold(time);
    }
  }
  return all;
}

}  // namespace anthesis::test
