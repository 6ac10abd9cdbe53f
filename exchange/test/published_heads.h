#pragma once
// The heads published with O24 as the models of growing heads take them, out of the reference files. Without
// GoogleTest, for benchmarks too; they and tests ask published_heads_are_here() first.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "anthesis/base/file.h"
#include "anthesis/exchange/vlab_digitised_head.h"
#include "anthesis/exchange/vlab_function.h"
#include "anthesis/exchange/vlab_head.h"
#include "anthesis/phyllotaxis/active_ring.h"
#include "anthesis/receptacle/growing_receptacle.h"

namespace anthesis::test {

inline std::filesystem::path published_heads() {
  const char* given = std::getenv("ANTHESIS_REFERENCE");
  return std::filesystem::path(given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT) / "heads";
}

inline bool published_heads_are_here() {
  return std::filesystem::exists(published_heads() / "sunflower" / "contours_markers.cset");
}

/// Precondition: the file is there.
inline std::string published_text(const std::string& path) {
  return *read_file((published_heads() / path).string(), std::size_t{1} << 26);
}

/// Contours, landmarks and ring of `species`, "bellis" or "sunflower", in the unit of the P-model.
inline DigitisedHead published_head(const std::string& species, bool uniform_knots = false) {
  constexpr double kModelScale = 100.0;
  const std::string folder = species + "/";
  const auto contours = read_vlab_contours(published_text(folder + "contours_markers.cset"), "contours_markers.cset");
  const auto knots = read_vlab_knots(published_text(folder + "knotPositions.dat"), "knotPositions.dat");
  return *vlab_digitised_head(*contours, uniform_knots ? std::vector<double>{} : *knots, kModelScale);
}

/// The head of Bellis that the paper shows: the released contours with the ring read back from its 420 primordia,
/// exactly. Two sets of landmarks are known for the last section: that of the primordia, to about 0.001, and that of
/// the published sequence of contours, exactly.
enum class PaperLandmarks { kOfPrimordia, kOfSequence };
inline DigitisedHead paper_bellis(PaperLandmarks landmarks, bool uniform_knots = false) {
  DigitisedHead head = published_head("bellis", uniform_knots);
  head.sections[3].ring = 0.327807;
  head.sections[4].ring = 0.05861;
  head.sections[6].landmarks =
      landmarks == PaperLandmarks::kOfPrimordia
          ? std::vector<double>{0.8830, 0.7177, 0.6519, 0.5911, 0.5355, 0.4868, 0.4351, 0.3911, 0.3518,
                                0.3039, 0.2634, 0.2194, 0.1898, 0.1552, 0.1229, 0.0934, 0.0337}
          : std::vector<double>{0.883139, 0.800179, 0.719477, 0.648791, 0.582521, 0.515444,
                                0.463338, 0.419968, 0.37905,  0.33426,  0.289275, 0.246125,
                                0.205639, 0.16963,  0.133539, 0.09579,  0.058623, 0.027118};
  return head;
}

/// A function of the P-model of `species`, as its programs see it.
inline VlabFunctionTable published_function(const std::string& species, const std::string& name) {
  const auto functions = read_vlab_functions(published_text(species + "/functions.fset"), "functions.fset");
  const auto one = std::find_if(functions->begin(), functions->end(),
                                [&](const VlabFunction& function) { return function.name == name; });
  return VlabFunctionTable(*one);
}

/// The patterns of primordia there are files of.
enum class PublishedPattern { kBellisReleased, kBellisPaper, kSunflower };

inline DigitisedHead head_of(PublishedPattern pattern) {
  return pattern == PublishedPattern::kBellisReleased ? published_head("bellis")
         : pattern == PublishedPattern::kBellisPaper  ? paper_bellis(PaperLandmarks::kOfPrimordia)
                                                      : published_head("sunflower");
}

inline ActiveRingParams ring_of(PublishedPattern pattern) {
  const double first = 3.5 * math::kPi;
  ActiveRingParams params;
  if (pattern == PublishedPattern::kSunflower) {
    const VlabFunctionTable table = published_function("sunflower", "thresholdDistanceFunc");
    params.threshold = [=](double time) { return 0.45 * first * table(2.0 * time); };
    params.bract_landmark = 8;
    return params;
  }
  params.bract_landmark = 3;
  params.last_ring = 0.01;
  if (pattern == PublishedPattern::kBellisPaper) {  // read back from the radii in its files
    params.threshold = [=](double time) { return first * math::exp(-15.0 * time); };
    params.threshold_frozen_above = 21;
  } else {
    const VlabFunctionTable table = published_function("bellis", "thresholdDistanceFunc");
    params.threshold = [=](double time) { return first * table(time); };
  }
  return params;
}

}  // namespace anthesis::test
