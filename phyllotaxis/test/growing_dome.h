#pragma once
#include <algorithm>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/active_ring.h"

namespace anthesis::test {

/// A flat disc that grows evenly from radius 1 to 4 while its ring runs from 0.9 of the radius to the centre.
class GrowingDome final : public GrowingProfile {
 public:
  double radius(double time, double s) const override { return length(time) * s; }
  double length(double time) const override { return 1.0 + 3.0 * time; }
  double ring(double time) const override { return 0.9 * (1.0 - time); }
  double s_from_material(double, double u) const override { return u; }
  double material_from_s(double, double s) const override { return s; }
  std::size_t landmarks() const override { return 2; }
  double landmark(double, std::size_t number) const override { return number == 1 ? 0.6 : number == 2 ? 0.3 : 0.0; }
};

/// Some hundred primordia on it.
inline ActiveRingParams dome_params() {
  ActiveRingParams params;
  params.threshold = [](double time) { return 0.3 + 3.0 * math::exp(-8.0 * time); };
  params.last_ring = 0.05;
  params.bract_landmark = 1;
  params.trans_landmark = 2;
  return params;
}

}  // namespace anthesis::test
