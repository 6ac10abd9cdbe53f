#pragma once
#include <optional>
#include <string>
#include <vector>

#include "anthesis/inflorescence/development.h"
#include "anthesis/render/path_tracer.h"
#include "anthesis/render/scene_of_canopy.h"
#include "arguments.h"

namespace anthesis::cli {

/// Level of detail that pictures are drawn at: outlines show facets in a large picture that nobody sees in a model.
inline constexpr double kPictureDetail = 2.0;

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

  void add_to(CLI::App& app, bool with_ground = true);
};

/// Takes pictures of one plant from one place, so that the pictures of its development match.
class Photographer {
 public:
  /// Throws a Failure of usage where a flag's word or size is not known. The plant may still have to be grown.
  explicit Photographer(const PictureOptions& options);

  /// Refuses so many pictures in one: they are all in memory at once.
  void check_sheet(std::size_t pictures) const;

  const View& view() const { return view_; }
  const Backdrop& backdrop() const { return scene_.backdrop; }

  /// The plant as it stands for a picture. `finer`: see SceneOptions.
  Scene pose(const Development& development, const Canopy& canopy, const Development* finer) const;

  /// A picture of `scene`. The camera stands where it frames `framed`.
  Image photograph(Scene scene, const Scene& framed, const Progress& progress,
                   Lighting (*light)(const Camera&) = studio_lighting) const;

  /// One kind of organ alone at `stage`, the camera where it frames it at that stage, or at all stages.
  Image photograph(const Species& species, std::size_t kind, double detail, double stage, bool frame_all_stages,
                   const Progress& progress) const;

 private:
  View view_;
  RenderOptions render_;
  SceneOptions scene_;
  double exposure_ev_ = 0.0;
};

/// Adds everything that `other` shows to `scene`: to frame several moments at once.
void add_to(Scene& scene, Scene other);

/// The texts that every PNG carries: what made it, of what. `resolved`: its organs were kept apart.
std::vector<PngText> provenance_texts(const Development& drawn, double time, bool resolved);

}  // namespace anthesis::cli
