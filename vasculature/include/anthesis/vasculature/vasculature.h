#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/vasculature/head_growth.h"
#include "anthesis/vasculature/vein_params.h"

namespace anthesis {

/// A primordium as the model of phyllotaxis leaves it.
struct VeinPrimordium {
  std::uint32_t id = 0;  ///< unique
  std::uint32_t birth_frame = 0;
  double s = 0.0;  ///< on the outline of that frame: share of its length, 0 apex, 1 rim
  double azimuth_rad = 0.0;
  PrimordiumKind kind = PrimordiumKind::kFloret;
};

/// Puts primordia in the order of their ids and makes their births ascend: a birth earlier than the one before becomes
/// one frame later than that. The released model of Bellis does so.
void make_births_ascend(std::vector<VeinPrimordium>& primordia);

inline constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();
inline constexpr std::uint32_t kNoPrimordium = std::numeric_limits<std::uint32_t>::max();

/// A vertex of a strand and the edge from it towards the base.
struct VeinVertex {
  Vec3 position;                     ///< +z is up
  std::uint32_t parent = kNoVertex;  ///< the next towards the ring; none: of the ring, or not yet connected
  VeinKind kind = VeinKind::kAbaxial;
  int age_frames = 0;        ///< since it was made; on an edge that was halved, that of the end towards the base;
                             ///< before the start of a strand its primordium has a negative age
  double diameter = 0.0;     ///< of the edge to the parent
  double resistivity = 0.0;  ///< of the edge to the parent
  double resistance = 0.0;   ///< from here to the ring; infinite while not connected
  std::uint32_t primordium =
      kNoPrimordium;  ///< id of the one whose strand this is; none: ring, adaxial by colonisation
};

/// A second way towards the base: `from` is joined to `to` as well as to its parent.
struct SecondConnection {
  std::uint32_t from = 0;
  std::uint32_t to = 0;          ///< near `from`; the outer end of the second strand
  std::uint32_t primordium = 0;  ///< whose second connection it is
  double diameter = 0.0;
};

/// The strands of a head: a forest rooted in the ring, and second connections that close its loops.
struct Vasculature {
  std::vector<VeinVertex> vertices;  ///< the ring first, counter-clockwise
  std::size_t ring_vertices = 0;
  std::vector<std::uint32_t> primordia;  ///< the surface vertex of each primordium; kNoVertex: not yet born
  std::vector<SecondConnection> second_connections;
  std::vector<Vec3> attraction_points;     ///< of colonisation, still unused
  std::size_t most_attraction_points = 0;  ///< there have been at once
  std::size_t brought_back = 0;  ///< times that growth had to bring a point back into the section, if growth counts
};

struct VeinOptions {
  std::uint64_t seed = 1;

  /// Frames over which the growth is asked for at once, at least 1; between, tissue moves straight on. With 1, as
  /// published, it is asked for frame by frame, one call each, in ascending order; long edges are halved once a stride.
  std::uint32_t stride = 8;

  /// Ascending frames whose vasculature is handed to `at_frame`. They leave no trace in the result.
  std::vector<std::uint32_t> frames;
  std::function<void(std::uint32_t frame, const Vasculature&)> at_frame;

  Progress progress;
};

/// Grows the veins of a head from its primordia (O24, V-model). See docs/vasculature.md.
///
/// Starts frame by frame in the order of `primordia`. Every strand that starts is connected. Primordia born after the
/// last frame are left out. The same bits for any number of threads. The sunflower of O24, 497 primordia and 38,000
/// vertices over 2,214 frames, takes some seconds, most of it growth.
///
/// Errors: check(params); `primordia[i].s` out of [0, 1], an azimuth that is not finite, an id twice; an outline of no
/// length; more than 5,000,000 vertices (kTooLarge); kCancelled.
Expected<Vasculature> grow_veins(const VeinParams& params, const HeadGrowth& growth,
                                 std::span<const VeinPrimordium> primordia, const VeinOptions& options = {});

}  // namespace anthesis
