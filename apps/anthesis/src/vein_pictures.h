#pragma once
#include <string>
#include <vector>

#include "anthesis/render/scene_of_veins.h"
#include "head.h"
#include "picture_options.h"

namespace anthesis::cli {

/// The flags that say how a picture of veins is taken.
struct VeinPictureOptions {
  PictureOptions picture;
  std::string cut = "whole";
  bool no_receptacle = false;
  bool primordia = false;
  bool scale_bar = false;
  bool own_size = false;

  VeinPictureOptions();
  void add_to(CLI::App& app);
};

/// Takes pictures of heads, all from the same place.
class VeinPhotographer {
 public:
  /// Throws a Failure of usage where a flag's word or size is not known.
  explicit VeinPhotographer(const VeinPictureOptions& options);

  void check_sheet(std::size_t pictures) const { photographer_.check_sheet(pictures); }

  /// A head at a moment, framed by `extent`; nothing: as large as it is.
  Image photograph(const GrownHead& head, const HeadMoment& moment, const HeadExtent& extent,
                   const Progress& progress) const;

 private:
  Photographer photographer_;
  VeinSceneOptions scene_;
};

/// What holds all frames that are shown.
HeadExtent extent_of(const GrownHead& head);

/// The texts of a PNG.
std::vector<PngText> png_texts(const MadeFrom& lines);

}  // namespace anthesis::cli
