#include "vein_pictures.h"

#include <array>

#include "anthesis/base/version.h"

namespace anthesis::cli {
namespace {

/// Strands and films of light have little noise: a third of what petals need.
PictureOptions well_sampled(PictureOptions options) {
  constexpr int kSamples = 16;
  if (!options.samples && options.quality == "final") {
    options.samples = kSamples;
  }
  return options;
}

}  // namespace

VeinPictureOptions::VeinPictureOptions() {
  picture.backdrop = "dark";
  picture.view = "front";
}

void VeinPictureOptions::add_to(CLI::App& app) {
  picture.add_to(app, false);
  app.add_option("--cut", cut,
                 "Pictures: whole (the default), half (without the half in front) or slice (what is near the middle)")
      ->type_name("NAME");
  app.add_flag("--no-receptacle", no_receptacle, "Pictures and GLB: strands alone, without the receptacle");
  app.add_flag("--show-primordia", primordia, "Pictures: a bead where each primordium stands");
  app.add_flag("--own-size", own_size, "Pictures of --frames: each head as large as fits, with its time");
  app.add_flag("--scale-bar", scale_bar, "Pictures: a bar below the head and its length");
}

VeinPhotographer::VeinPhotographer(const VeinPictureOptions& options) : photographer_(well_sampled(options.picture)) {
  scene_.view = photographer_.view();
  scene_.backdrop = photographer_.backdrop();
  constexpr std::array<std::string_view, 3> kCuts = {"whole", "half", "slice"};
  scene_.cut = static_cast<HeadCut>(parse_word("--cut", options.cut, kCuts));
  scene_.receptacle = !options.no_receptacle;
  scene_.primordia = options.primordia;
  scene_.scale_bar = options.scale_bar;
}

Image VeinPhotographer::photograph(const GrownHead& head, const HeadMoment& moment, const HeadExtent& extent,
                                   const Progress& progress) const {
  VeinSceneOptions options = scene_;
  options.extent = extent;
  const std::vector<Vec2> outline = outline_of(head.contours, moment.frame);
  const Scene scene = value_of(make_scene(moment.veins, outline, head.primordia, options));
  return photographer_.photograph(scene, scene, progress, vein_lighting);
}

HeadExtent extent_of(const GrownHead& head) {
  HeadExtent extent;
  for (const HeadMoment& moment : head.moments) {
    extent = together(extent, anthesis::extent_of(outline_of(head.contours, moment.frame)));
  }
  return extent;
}

std::vector<PngText> png_texts(const MadeFrom& lines) {
  std::vector<PngText> texts = {{"Software", std::string("Anthesis ") + kVersion}};
  for (const auto& [key, value] : lines) {
    texts.push_back({key, value});
  }
  return texts;
}

}  // namespace anthesis::cli
