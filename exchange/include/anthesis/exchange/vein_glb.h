#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "anthesis/base/error.h"
#include "anthesis/exchange/vein_files.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/vasculature/vasculature.h"
#include "anthesis/vasculature/vein_tubes.h"

namespace anthesis {

struct VeinGlbParams {
  VeinTubeParams tubes = {};
  double duration_s = 4.0;         ///< of the animation, (0, 86400]
  double receptacle_alpha = 0.25;  ///< [0, 1]; 0: no receptacle
  int receptacle_sides = 64;       ///< 3 to 1024
};

/// What is wrong with `params`, if anything.
std::optional<Error> check(const VeinGlbParams& params);

/// A head at one time.
struct VeinFrame {
  double time = 0.0;  ///< of development, [0, 1]
  const Vasculature* veins = nullptr;
  std::span<const Vec2> outline;  ///< (radius, height), apex first, rim of the base last; empty: no receptacle
};

/// Writes a head's veins as a binary glTF 2.0 file: a still, or a development as a flip book.
///
/// The tubes of vein_tubes(), one primitive for each kind there is, each with a material named by the kind; the outline
/// turned about the axis, a translucent two-sided surface open at the base, in a node of its own. Metres and +Y up
/// through the root; one unit of the head is a millimetre. `made_from` and the generator stand in asset.extras.
///
/// Below the root stands a node "frame 0.250" for each frame, with the nodes "veins" and "receptacle" (of several
/// frames "veins 0.250") below it. Since strands come, go and join, shapes cannot be morphed into each other: the
/// animation "development" switches the scale of each frame's node between 1 and 0. A frame is shown from its time to
/// the next one's, the last one as long as the others on average; the times fill the duration in proportion. Without
/// the animation the last frame shows.
///
/// Equal frames give equal bytes. Memory: what the file will have, a few times over at the end, and the mesh of one
/// frame.
class VeinGlb {
 public:
  /// Precondition: check(params) finds nothing (asserted).
  explicit VeinGlb(const VeinGlbParams& params = {}, MadeFrom made_from = {});
  ~VeinGlb();
  VeinGlb(VeinGlb&&) noexcept;
  VeinGlb& operator=(VeinGlb&&) noexcept;

  /// Times must ascend. Copies what it needs.
  /// Errors: those of vein_tubes(); kInvalidParameter for a time or an outline that is none; kTooLarge above 2000
  /// frames or 2 GiB.
  std::optional<Error> add(const VeinFrame& frame);

  /// The bytes. Call once, last.
  /// Errors: kInvalidParameter for no frames, or times nearer than single precision tells apart; kTooLarge; kIo.
  Expected<std::string> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A still.
Expected<std::string> veins_glb(const VeinFrame& frame, const VeinGlbParams& params = {},
                                const MadeFrom& made_from = {});

}  // namespace anthesis
