#include "vein_figures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anthesis/base/error.h"
#include "anthesis/base/math.h"

namespace anthesis::cli {

VeinFigures figures_of(const Vasculature& veins, std::span<const VeinPrimordium> primordia,
                       const VasculatureMeasures& measures) {
  std::array<std::size_t, 3> kinds{};
  double own_length = 0.0;
  double to_ring = 0.0;
  double turned = 0.0;
  double sectors = 0.0;
  double resistance = 0.0;
  std::size_t connected = 0;
  for (std::size_t i = 0; i < primordia.size(); ++i) {
    const StrandMeasures& strand = measures.strands[i];
    if (strand.vertex != kNoVertex) {
      ++kinds[static_cast<std::size_t>(primordia[i].kind)];
    }
    if (strand.connected) {
      ++connected;
      own_length += strand.own_length;
      to_ring += strand.length_to_ring;
      turned += std::abs(strand.turned_rad);
      sectors += strand.sectors_crossed;
      resistance = std::max(resistance, veins.vertices[strand.vertex].resistance);
    }
  }
  const double strands = std::max<double>(1.0, static_cast<double>(connected));
  return {{"bracts", std::to_string(kinds[0])},
          {"trans_florets", std::to_string(kinds[1])},
          {"florets", std::to_string(kinds[2])},
          {"connected", std::to_string(connected)},
          {"vertices", std::to_string(veins.vertices.size())},
          {"ring_vertices_used", std::to_string(measures.bundles)},
          {"second_connections", std::to_string(veins.second_connections.size())},
          {"joints", std::to_string(measures.joints)},
          {"loops", std::to_string(measures.loops)},
          {"highest_order", std::to_string(measures.highest_order)},
          {"total_length_mm", to_text(measures.total_length)},
          {"mean_own_length_mm", to_text(own_length / strands)},
          {"mean_length_to_ring_mm", to_text(to_ring / strands)},
          {"mean_turned_deg", to_text(math::degrees(turned / strands))},
          {"mean_sectors_crossed", to_text(sectors / strands)},
          {"greatest_resistance", to_text(resistance)}};
}

}  // namespace anthesis::cli
