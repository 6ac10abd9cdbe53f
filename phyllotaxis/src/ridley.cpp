#include "anthesis/phyllotaxis/ridley.h"

#include <algorithm>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"

namespace anthesis {

std::size_t place_organs(const SurfaceOfRevolution& surface, std::span<const double> areas_mm2,
                         SpiralDirection direction, std::span<double> t) {
  ANTHESIS_ASSERT(t.size() >= areas_mm2.size());
  const double whole = surface.area_mm2();
  // Rounding must not cost the last organ of a surface that was made to fit; a compensated sum (Kahan) keeps it small
  // however many organs there are.
  const double room = whole * (1.0 + 1e-12);
  double used = 0.0;
  double lost = 0.0;
  for (std::size_t i = 0; i < areas_mm2.size(); ++i) {
    const double step = areas_mm2[i] - lost;
    const double next = used + step;
    if (next > room) {
      return i;
    }
    const double middle = used + 0.5 * step;
    t[i] = surface.t_from_area_mm2(direction == SpiralDirection::kFromApex ? middle : whole - middle);
    lost = (next - used) - step;
    used = next;
  }
  return areas_mm2.size();
}

std::vector<double> place_organs(const SurfaceOfRevolution& surface, const FunctionGraph& area_mm2,
                                 SpiralDirection direction, std::size_t limit) {
  std::vector<double> breaks = surface.profile_mm().knots();
  for (const double s : area_mm2.breaks()) {
    if (s > 0.0 && s < 1.0) {
      breaks.push_back(surface.t_from_s(s));
    }
  }
  std::sort(breaks.begin(), breaks.end());
  const CumulativeIntegral organs(
      [&](double t) {
        return math::kTurnRad * surface.radius_mm(t) * surface.speed_mm(t) / area_mm2(surface.s_from_t(t));
      },
      breaks, 1e-12);
  std::vector<double> t;
  for (std::size_t i = 0; i < limit && static_cast<double>(i + 1) <= organs.total() * (1.0 + 1e-12); ++i) {
    const double middle = static_cast<double>(i) + 0.5;
    t.push_back(organs.inverse(direction == SpiralDirection::kFromApex ? middle : organs.total() - middle));
  }
  return t;
}

}  // namespace anthesis
