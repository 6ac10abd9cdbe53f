#pragma once
#include <optional>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/render/camera.h"
#include "anthesis/render/picture.h"
#include "anthesis/render/scene.h"

namespace anthesis {

struct RenderOptions {
  int width = 1200;                ///< pixels, 1 to 16384
  int height = 1200;               ///< pixels, 1 to 16384
  int samples = 48;                ///< light paths per pixel, 1 to 65536; multiples of 16 are the best spread
  int max_bounces = 5;             ///< surfaces a path may meet, 1 to 64; 1 is direct light
  std::optional<double> exposure;  ///< factor from radiance to picture, > 0; none: metered_exposure
  bool denoise = true;             ///< filter what noise is left; needs samples >= 2

  static RenderOptions draft(int width, int height);          ///< a few samples, filtered: a second or two at 600 x 600
  static RenderOptions final_quality(int width, int height);  ///< no visible noise: less than a minute at 1200 x 1200
};

/// What is wrong with `options`, if anything.
std::optional<Error> check(const RenderOptions& options);

/// The exposure that a hand-held meter would choose: a white surface turned half towards the key lamp and half towards
/// the camera comes out just below white. It depends on the light alone, so the frames of an animation match.
double metered_exposure(const Lighting& lighting, const Camera& camera);

/// Paints `scene` by following light backwards from the camera. See docs/rendering.md.
///
/// The same bytes for any number of threads and on any x86-64 processor. Progress stages: "geometry", "light", "noise".
/// Memory: about 200 bytes a pixel (90 without denoising) and 200 bytes a triangle of the shared meshes.
/// Errors: check(options), check(scene), too many triangles (kTooLarge), cancelled.
Expected<Picture> trace(const Scene& scene, const Camera& camera, const RenderOptions& options,
                        const Progress& progress = {});

}  // namespace anthesis
