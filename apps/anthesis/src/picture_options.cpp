#include "picture_options.h"

#include <fmt/format.h>

#include <array>
#include <iterator>

#include "anthesis/base/math.h"
#include "anthesis/base/version.h"

namespace anthesis::cli {
namespace {

constexpr std::uint64_t kSmallestSide = 16;
constexpr std::uint64_t kLargestSide = 8192;

}  // namespace

void PictureOptions::add_to(CLI::App& app, bool with_ground) {
  app.add_option("--view", view, "Pictures: top, bottom, side, front or three-quarter; " + view + " if left out")
      ->type_name("NAME");
  add_number(app, "--azimuth-deg", azimuth_deg, {-360.0, 360.0}, "Direction of the camera about the stem, in degrees");
  add_number(app, "--elevation-deg", elevation_deg, {-90.0, 90.0}, "Height of the camera above the level, in degrees");
  app.add_option("--size", size, "Pixels: 800, or 1200x800 (width x height) [16 to 8192], 1200 if left out")
      ->type_name("N");
  app.add_option("--quality", quality, "draft (seconds) or final (a minute), which is taken if left out")
      ->type_name("NAME");
  add_whole(app, "--samples", samples, 1, 4096, "Light paths per pixel, in place of the quality's own number");
  add_number(app, "--exposure", exposure, {-10.0, 10.0}, "Brighter or darker, in stops");
  app.add_option("--backdrop", backdrop, "light, dark or none (transparent); " + backdrop + " if left out")
      ->type_name("NAME");
  if (with_ground) {
    app.add_flag("--ground", ground, "Let the plant stand on a ground that takes its shadow");
  }
}

Photographer::Photographer(const PictureOptions& options) : exposure_ev_(options.exposure) {
  constexpr std::array<std::string_view, 5> kViews = {"top", "bottom", "side", "front", "three-quarter"};
  view_ = value_of(parse_view(kViews[parse_word("--view", options.view, kViews)]));
  if (options.azimuth_deg) {
    view_.azimuth_rad = math::radians(*options.azimuth_deg);
  }
  if (options.elevation_deg) {
    view_.elevation_rad = math::radians(*options.elevation_deg);
  }

  const std::string_view size = options.size;
  const std::size_t cross = size.find('x');
  const auto side = [&](std::string_view part) {
    return static_cast<int>(parse_whole("--size", part, kSmallestSide, kLargestSide, size));
  };
  const int width = side(size.substr(0, cross));
  const int height = cross == std::string_view::npos ? width : side(size.substr(cross + 1));
  constexpr std::array<std::string_view, 2> kQualities = {"draft", "final"};
  render_ = parse_word("--quality", options.quality, kQualities) == 0 ? RenderOptions::draft(width, height)
                                                                      : RenderOptions::final_quality(width, height);
  if (options.samples) {
    render_.samples = *options.samples;
    render_.denoise = render_.denoise && render_.samples >= 2;
  }

  constexpr std::array<std::string_view, 3> kBackdrops = {"light", "dark", "none"};
  constexpr std::array kMake = {Backdrop::light, Backdrop::dark, Backdrop::none};
  scene_.backdrop = kMake[parse_word("--backdrop", options.backdrop, kBackdrops)]();
  scene_.ground = options.ground;
}

void Photographer::check_sheet(std::size_t pictures) const {
  constexpr double kMostPixels = 400e6;
  const double pixels = static_cast<double>(pictures) * render_.width * render_.height;
  if (pixels > kMostPixels) {
    throw usage(fmt::format("a sheet must have at most 400 million pixels, got {:.0f} million", pixels / 1e6));
  }
}

Scene Photographer::pose(const Development& development, const Canopy& canopy, const Development* finer) const {
  SceneOptions options = scene_;
  options.finer = finer;
  return make_scene(development, canopy, options);
}

Image Photographer::photograph(Scene scene, const Scene& framed, const Progress& progress,
                               Lighting (*light)(const Camera&)) const {
  const Camera camera = frame(framed, view_, render_.width, render_.height);
  scene.lighting = light(camera);
  RenderOptions options = render_;
  options.exposure = metered_exposure(scene.lighting, camera) * math::pow(2.0, exposure_ev_);
  return develop(value_of(trace(scene, camera, options, progress)));
}

Image Photographer::photograph(const Species& species, std::size_t kind, double detail, double stage,
                               bool frame_all_stages, const Progress& progress) const {
  const auto scene_at = [&](double at) { return value_of(make_organ_scene(species, kind, at, detail, scene_)); };
  Scene framed = scene_at(stage);
  if (frame_all_stages) {
    constexpr int kStages = 10;
    for (int i = 0; i <= kStages; ++i) {
      add_to(framed, scene_at(static_cast<double>(i) / kStages));
    }
  }
  return photograph(scene_at(stage), framed, progress);
}

void add_to(Scene& scene, Scene other) {
  const auto first = static_cast<std::uint32_t>(scene.meshes.size());
  for (Instance& instance : other.instances) {
    instance.mesh += first;
  }
  std::move(other.meshes.begin(), other.meshes.end(), std::back_inserter(scene.meshes));
  std::move(other.instances.begin(), other.instances.end(), std::back_inserter(scene.instances));
}

std::vector<PngText> provenance_texts(const Development& drawn, double time, bool resolved) {
  const Species& species = drawn.species();
  std::vector<PngText> texts = {{"Software", std::string("Anthesis ") + kVersion},
                                {"Species", species.name},
                                {"Seed", std::to_string(drawn.options().seed)},
                                {"Detail", to_text(drawn.options().detail)},
                                {"Time", to_text(time)}};
  if (!species.sha256.empty()) {
    texts.push_back({"Species-SHA256", species.sha256});
  }
  if (resolved) {
    texts.push_back({"Collisions", "resolved"});
  }
  return texts;
}

}  // namespace anthesis::cli
