#pragma once
#include <optional>
#include <string>
#include <vector>

#include "anthesis/inflorescence/development.h"
#include "anthesis/render/path_tracer.h"
#include "anthesis/render/scene_of_canopy.h"
#include "arguments.h"

namespace anthesis::cli {

/// The flags that say how a picture is taken.
struct PictureOptions {
  std::string view = "three-quarter";
  std::optional<double> azimuth_deg;
  std::optional<double> elevation_deg;
  std::string size = "1200";
  std::string quality = "final";
  std::optional<int> samples;
  double exposure = 0.0;
  std::string backdrop = "light";
  bool ground = false;

  void add_to(CLI::App& app);
};

/// Takes pictures of one plant from one place, so that the pictures of its development match.
class Photographer {
 public:
  /// Throws a Failure of usage where a flag's word or size is not known. The plant may still have to be grown.
  explicit Photographer(const PictureOptions& options);

  /// The plant at `time`. The camera stands where it frames the plant at `framed_time`.
  Image photograph(const Development& development, double time, double framed_time, const Progress& progress);

  /// One kind of organ alone at `stage`, the camera where it frames it at that stage, or at all stages.
  Image photograph(const Species& species, std::size_t kind, double detail, double stage, bool frame_all_stages,
                   const Progress& progress);

  /// The same as the bytes of a PNG.
  std::string take(const Development& development, double time, double framed_time, const Progress& progress);

 private:
  Image expose(Scene scene, const Scene& framed, const Progress& progress);

  View view_;
  RenderOptions render_;
  SceneOptions scene_;
  double exposure_ev_ = 0.0;
};

/// The texts that every PNG carries: what made it, of what.
std::vector<PngText> provenance_texts(const Development& development, double time);

}  // namespace anthesis::cli
