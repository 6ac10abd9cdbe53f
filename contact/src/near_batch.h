#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "anthesis/geometry/vec.h"
#include "nearest.h"

namespace anthesis {

/// What a plane must leave beyond rounding to part two primitives for good, times the size of its direction and of the
/// largest of places, ways and reaches: each of the few terms rounds by at most 8 units; several times that, to be
/// generous.
inline constexpr double kApartRounding = 64.0 * kUnitRoundoff;

/// Pairs of primitives whose nearest points are looked for side by side, one in a lane.
struct NearBatch {
  static constexpr std::size_t kLanes = 8;
  using Lanes = std::array<double, kLanes>;
  using Lanes3 = std::array<Lanes, 3>;

  // In. Lanes that hold nothing must hold numbers.
  alignas(64) std::array<Lanes3, 4> points = {};  ///< as in nearest_vertex_triangle or nearest_edge_edge
  alignas(64) std::array<Lanes3, 4> ways = {};    ///< see ContactBody
  alignas(64) std::array<Lanes, 4> reaches = {};
  std::array<Vec3, 2> rides = {};  ///< of both bodies, in all lanes

  // Out.
  alignas(64) std::array<Lanes, 4> weights = {};  ///< see Contact
  alignas(64) Lanes3 difference = {};
  alignas(64) Lanes distance = {};
  unsigned sound = 0;  ///< a bit for each lane that is certainly right; the others must be asked for one by one
  unsigned apart = 0;  ///< and for those that certainly stay apart, as far as they look around
};

/// The same bits on every processor, and in every lane whatever the others hold.
void find_nearest_edges(NearBatch& batch);
void find_nearest_vertex_triangle(NearBatch& batch);

}  // namespace anthesis
