#pragma once
#include <optional>
#include <span>
#include <string>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {

struct GlbOptions {
  std::optional<double> time =
      std::nullopt;         ///< a still plant at this developmental time in [0, 1]; none: its whole development
  int frames = 25;          ///< keys over the development, first and last included, 2 to 2000
  double duration_s = 4.0;  ///< of the animation, (0, 86400]. 25 frames in 4 s fall on whole frames at 24 a second
  double morph_tolerance =
      0.005;              ///< largest distance between morphed and true surface, as a share of the organ's size
  int morph_targets = 7;  ///< at most this many shapes besides the first for each template, 1 to 64
  bool diffuse_transmission = false;  ///< states the petals' translucency by KHR_materials_diffuse_transmission
};

/// What is wrong with `options`, if anything.
std::optional<Error> check(const GlbOptions& options);

/// The bytes of a binary glTF 2.0 file: metres and +Y up, through the scale and rotation of one root node.
///
/// Organs are nodes `ray_floret.12` (their id after the point), with organ, kind, parent, birth, age and divergence_deg
/// in their extras; organs of one template share one mesh. Opening is morph targets chosen so that the surface stays
/// within `morph_tolerance` where `morph_targets` allow it (each mesh's extras state the deviation reached); weights,
/// translation, rotation and scale are keyed at every frame in one animation named "development". An organ not yet
/// born has scale 0. Without the animation the file shows the plant at the last time. The pigments of a mesh are one
/// two-sided material, its texture their colours on a typical organ side by side; variation of colour between organs is
/// left out.
/// No extension is required to open the file.
///
/// Errors: check(options), kTooLarge above 16 million organs x frames or 2 GiB, kCancelled.
/// Equal developments and options give equal bytes, for any number of threads.
Expected<std::string> to_glb(const Development& development, const GlbOptions& options = {},
                             const Progress& progress = {});

/// The same for canopies of the development that were computed beforehand, such as those of a plant whose organs were
/// bent by touching: one key frame each, times ascending; one canopy makes a still plant. Of `options`, `duration_s`
/// and `diffuse_transmission` count; key frames lie in the animation in proportion to their times.
///
/// Each organ is a mesh of its own whose base is its shape at the last frame, with one morph target for each other
/// shape among its frames; organs of one template share indices, texture coordinates and material. At a key frame one
/// weight is 1 or all are 0, and nodes below the root do not transform what is born: there every coordinate is
/// base + target in single precision, and that sum is the given number itself, to the last bit. Between keys vertices
/// move in straight lines. Before its first frame an organ is a point at its place of birth.
///
/// Errors: also kInvalidParameter for no frames or canopies that are not of this development, kTooLarge for more than
/// 2000 frames, for 2 GiB, and for coordinates whose differences single precision does not hold; multiples of 2^-14 mm
/// below 1024 mm always fit but for differences beyond that.
Expected<std::string> to_glb(const Development& development, std::span<const Canopy> frames, const GlbOptions& options,
                             const Progress& progress = {});

}  // namespace anthesis
