#pragma once
// Primordia and outlines published with O24. They belong to others and are no part of this project: found through
// ANTHESIS_REFERENCE. Minimal readers; those for all such files are a module higher, in exchange.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "anthesis/vasculature/mean_value_growth.h"
#include "anthesis/vasculature/vasculature.h"

namespace anthesis::test {

inline std::filesystem::path reference() {
  const char* given = std::getenv("ANTHESIS_REFERENCE");
  return given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT;
}

/// A `.prims` file of Bellis (six columns) or sunflower (five); type 1 is a bract.
inline std::vector<VeinPrimordium> published_primordia(const std::string& path, bool with_radius) {
  std::ifstream file(reference() / path);
  std::vector<VeinPrimordium> primordia;
  std::size_t count = 0;
  file >> count;
  VeinPrimordium one;
  double radius = 0.0;
  int type = 0;
  while (file >> one.id >> one.birth_frame >> one.s >> one.azimuth_rad && (!with_radius || file >> radius) &&
         file >> type) {
    one.kind = type == 1 ? PrimordiumKind::kBract : PrimordiumKind::kFloret;
    primordia.push_back(one);
  }
  return primordia;
}

/// A `.cntrs` file, times `scale`.
inline OutlineSequence published_outlines(const std::string& path, double scale) {
  std::ifstream file(reference() / path);
  std::size_t frames = 0;
  OutlineSequence outlines;
  file >> frames >> outlines.points_per_frame;
  int landmark = 0;
  for (std::size_t i = 0; i < outlines.points_per_frame; ++i) {
    file >> landmark;
  }
  Vec2 point;
  double s = 0.0;
  for (std::size_t i = 0; i < frames * outlines.points_per_frame && file >> point.x >> point.y >> s; ++i) {
    outlines.points.push_back(scale * point);
  }
  return outlines;
}

struct PublishedHead {
  std::vector<VeinPrimordium> primordia;
  OutlineSequence outlines;
};

inline PublishedHead published_bellis() {
  PublishedHead head{published_primordia("heads/bellis/vasculature/bellis_stable.prims", true),
                     published_outlines("heads/bellis/bellis.cntrs", 5.0)};
  make_births_ascend(head.primordia);  // as the released program does
  return head;
}

inline PublishedHead published_sunflower() {
  return {published_primordia("heads/sunflower/vasculature/sunflower_stable.prims", false),
          published_outlines("heads/sunflower/sunflower-regenerated.cntrs", 10.0 / 3.0)};
}

inline bool has_published_heads() {
  return std::filesystem::exists(reference() / "heads/sunflower/sunflower-regenerated.cntrs");
}

}  // namespace anthesis::test
