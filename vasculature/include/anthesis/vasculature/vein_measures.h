#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "anthesis/vasculature/vasculature.h"

namespace anthesis {

/// The way from one primordium to the ring.
struct StrandMeasures {
  std::uint32_t vertex = kNoVertex;  ///< of the surface; kNoVertex: not yet born, and all else 0
  bool connected = false;
  double own_length = 0.0;      ///< until it joins another strand or the ring
  double length_to_ring = 0.0;  ///< along the first connections
  int order = 0;                ///< 1 joins the ring, 2 joins a strand of order 1, ...
  std::uint32_t bundle = 0;     ///< the ring vertex it ends in
  double turned_rad = 0.0;      ///< azimuth of the ring's vertex less the primordium's, followed along the way
  int sectors_crossed = 0;      ///< borders of sectors that the way crosses, each counted once; the primordium stands
                                ///< in the middle of a sector
};

struct VasculatureMeasures {
  std::vector<StrandMeasures> strands;  ///< one for each primordium
  std::vector<int> strahler;            ///< of each vertex: 1 at tips, one more where two of the highest meet
  std::size_t bundles = 0;              ///< ring vertices with strands
  std::size_t joints = 0;               ///< vertices, but for the ring, where two or more meet
  std::size_t tips = 0;                 ///< connected vertices from which nothing goes outwards
  std::size_t loops = 0;                ///< independent ones, the ring taken as open
  std::size_t loops_through_ring = 0;   ///< independent ones, all bundles taken as joined in the ring
  int highest_order = 0;
  double total_length = 0.0;  ///< of all strands, second connections included
};

/// What a botanist counts and measures. `sectors` equal sectors about the axis, at least 1. O(vertices * depth) at
/// most. Precondition: as grow_veins makes it.
VasculatureMeasures measure(const Vasculature& veins, int sectors = 34);

}  // namespace anthesis
