#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/exchange/vein_files.h"
#include "anthesis/inflorescence/head_interior.h"
#include "arguments.h"

namespace anthesis::cli {

/// The flags that say which head to grow, and how.
struct HeadArguments {
  std::string species;  ///< or a folder
  std::vector<std::string> with;
  std::string primordia;
  bool by_id = false;
  std::string like;
  std::string source;
  std::string clock;
  bool as_published = false;
  bool mean_value = false;
  std::uint64_t seed = 1;

  void add_to(CLI::App& app);

  HeadRules rules() const { return as_published ? HeadRules::kAsPublished : HeadRules::kExact; }
};

/// A number of a species to set, "mu_sec=0.5", or to multiply, "threshold_mm=x1.1".
struct Setting {
  std::string key;
  double value = 0.0;
  bool factor = false;
};
/// Throws a Failure of usage.
Setting parse_setting(const std::string& flag, const std::string& text);

/// The species with a number changed. Throws a Failure of usage.
void set(Species& species, const std::string& flag, const Setting& setting);

/// The species that the flags name, or the one made of the folder that they name, with all changes; it has veins.
Species find_head(const HeadArguments& arguments);

/// A head at a frame.
struct HeadMoment {
  std::size_t frame = 0;
  double time = 0.0;  ///< share of all frames
  Vasculature veins;
};

/// A head with its inside.
struct GrownHead {
  std::vector<RingPrimordium> ring;  ///< empty where primordia came from a file
  std::vector<VeinPrimordium> primordia;
  ContourSequence contours;
  std::size_t brought_back = 0;     ///< times that growth brought a point back into the section
  std::vector<HeadMoment> moments;  ///< those that were asked for, at least one
};

/// Grows the head and keeps it at `times`, ascending.
GrownHead grow_head(const HeadArguments& arguments, const Species& species, std::vector<double> times, Report& report,
                    const Progress& progress);

/// What files are to say of their making.
MadeFrom made_from(const HeadArguments& arguments, const Species& species, const HeadMoment& moment);

/// The frame nearest to a time of development, [0, 1].
std::uint32_t frame_at(const ContourSequence& contours, double time);

/// The outline of a frame.
std::vector<Vec2> outline_of(const ContourSequence& contours, std::size_t frame);

}  // namespace anthesis::cli
