#include "head.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "anthesis/base/file.h"
#include "anthesis/exchange/species_key.h"
#include "anthesis/exchange/vlab_head.h"
#include "anthesis/exchange/vlab_species.h"
#include "growth.h"
#include "vlab_folder.h"

namespace anthesis::cli {
namespace {

/// The species that was named, or made of the folder that was.
Species read_species_or_folder(const HeadArguments& arguments) {
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(arguments.species, ignored);
  if (!folder) {
    if (!arguments.like.empty() || !arguments.source.empty()) {
      throw usage(fmt::format("{} is for a FOLDER; a species file states its own",
                              arguments.like.empty() ? "--source" : "--like"));
    }
    return find_plant(arguments.species);
  }
  const std::vector<std::string_view> sources(kVeinSourceNames.begin(), kVeinSourceNames.end());
  VlabScale scale;
  scale.like = arguments.like.empty() ? head_model_in(arguments.species) : head_model(arguments.like);
  if (!scale.like) {
    throw usage("files of VLab state neither size nor veins: say --like bellis, sunflower or gerbera for " +
                arguments.species);
  }
  scale.source = arguments.source.empty() ? VeinSource::kAsPublished
                                          : static_cast<VeinSource>(parse_word("--source", arguments.source, sources));
  const VlabObject object = value_of(read_vlab_object(vlab_files_of(arguments.species)));
  return value_of(species_from_vlab(name_of_folder(arguments.species), object, scale));
}

/// Primordia of a file, which may lie in the folder.
std::vector<VeinPrimordium> read_primordia(const HeadArguments& arguments, const Species& species) {
  std::string path = arguments.primordia;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    const std::string within = (std::filesystem::path(arguments.species) / path).string();
    if (std::filesystem::exists(within, ignored)) {
      path = within;
    }
  }
  const VlabPrimordia file = value_of(read_vlab_primordia(value_of(read_file(path, kVlabTextLimit)), path));
  const bool three_types = species.head.active_ring->trans_landmark > 0;  // else 0 is a floret and 1 a bract
  std::vector<VeinPrimordium> primordia;
  for (const VlabPrimordium& one : file.primordia) {
    PrimordiumKind kind = one.type == 1 ? PrimordiumKind::kBract : PrimordiumKind::kFloret;
    if (three_types) {
      kind = one.type == 0   ? PrimordiumKind::kBract
             : one.type == 1 ? PrimordiumKind::kTransFloret
                             : PrimordiumKind::kFloret;
    }
    primordia.push_back({one.id, one.step, one.s, one.azimuth_rad, kind});
  }
  if (arguments.by_id) {
    make_births_ascend(primordia);
  }
  return primordia;
}

}  // namespace

Setting parse_setting(const std::string& flag, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw usage(flag + " must be KEY=NUMBER or KEY=xFACTOR, got " + text);
  }
  const bool factor = text.compare(equals + 1, 1, "x") == 0;
  return {text.substr(0, equals),
          parse_number(flag + " " + text.substr(0, equals), text.substr(equals + (factor ? 2 : 1)), {-1e9, 1e9}),
          factor};
}

void set(Species& species, const std::string& flag, const Setting& setting) {
  const auto change = setting.factor ? scale_number : set_number;
  if (auto error = change(species, setting.key, setting.value)) {
    throw usage(flag + ": " + to_string(*error));
  }
}

Species find_head(const HeadArguments& arguments) {
  if (arguments.by_id && arguments.primordia.empty()) {
    throw usage("--by-id is for the primordia of a file: give --primordia as well");
  }
  Species species = read_species_or_folder(arguments);
  if (!species.vasculature) {
    throw failure({ErrorCode::kInvalidParameter, species.name,
                   "must have a table [vasculature], as bellis-head or sunflower-head has"});
  }
  for (const std::string& setting : arguments.with) {
    set(species, "--with", parse_setting("--with", setting));
  }
  if (!arguments.clock.empty()) {
    constexpr std::array<std::string_view, 2> kClocks = {"consistent", "published"};
    species.vasculature->clock = static_cast<VeinClock>(parse_word("--clock", arguments.clock, kClocks));
  }
  if (arguments.mean_value) {
    species.vasculature->inside = HeadInside::kMeanValue;
  }
  if (auto error = check(species)) {
    throw arguments.with.empty() ? failure(*error) : usage("--with: " + to_string(*error));
  }
  return species;
}

GrownHead grow_head(const HeadArguments& arguments, const Species& species, std::vector<double> times, Report& report,
                    const Progress& progress) {
  GrownHead grown;
  if (arguments.primordia.empty()) {
    report.time("primordia", [&] {
      grown.ring = value_of(head_ring(species, arguments.rules(), progress));
      grown.primordia = head_primordia(species, grown.ring, arguments.rules());
    });
  } else {
    grown.primordia = report.time("primordia", [&] { return read_primordia(arguments, species); });
  }
  grown.contours = report.time("contours", [&] { return value_of(head_contours(species, arguments.rules())); });
  const double last = static_cast<double>(grown.contours.frames() - 1);
  VeinOptions options;
  options.seed = arguments.seed;
  options.progress = progress;
  for (const double time : times) {
    options.frames.push_back(frame_at(grown.contours, time));
  }
  options.frames.erase(std::unique(options.frames.begin(), options.frames.end()), options.frames.end());
  options.at_frame = [&](std::uint32_t frame, const Vasculature& veins) {
    grown.moments.push_back({frame, static_cast<double>(frame) / last, veins});
  };
  const Vasculature whole =
      report.time("veins", [&] { return value_of(head_veins(species, grown.contours, grown.primordia, options)); });
  grown.brought_back = whole.brought_back;
  return grown;
}

std::uint32_t frame_at(const ContourSequence& contours, double time) {
  return static_cast<std::uint32_t>(std::lround(time * static_cast<double>(contours.frames() - 1)));
}

std::vector<Vec2> outline_of(const ContourSequence& contours, std::size_t frame) {
  std::vector<Vec2> outline;
  for (const ContourPoint& point : contours.frame(frame)) {
    outline.push_back(point.position);
  }
  return outline;
}

MadeFrom made_from(const HeadArguments& arguments, const Species& species, const HeadMoment& moment) {
  MadeFrom lines = {{"species", species.name}};
  if (!species.sha256.empty()) {
    lines.push_back({"species-sha256", species.sha256});
  }
  for (const std::string& setting : arguments.with) {
    lines.push_back({"with", setting});
  }
  const HeadVeins& veins = *species.vasculature;
  const std::string file = std::filesystem::path(arguments.primordia).filename().string();
  lines.push_back({"primordia", !file.empty()            ? file
                                : arguments.as_published ? "active ring, as published"
                                                         : "active ring"});
  if (arguments.by_id) {
    lines.push_back({"order", "by id"});
  }
  if (arguments.as_published) {
    lines.push_back({"sections", "as published"});
  }
  if (!arguments.source.empty()) {
    lines.push_back({"source", arguments.source});
  }
  if (!arguments.like.empty()) {
    lines.push_back({"like", arguments.like});
  }
  lines.push_back({"inside", veins.inside == HeadInside::kHarmonic ? "harmonic" : "mean value"});
  lines.push_back({"clock", veins.clock == VeinClock::kPublished ? "published" : "consistent"});
  lines.push_back({"unit", "mm"});
  lines.push_back({"seed", std::to_string(arguments.seed)});
  lines.push_back({"time", to_text(moment.time)});
  return lines;
}

void HeadArguments::add_to(CLI::App& app) {
  app.add_option("SPECIES", species,
                 "A species whose head has an active ring, or a folder of VLab with a digitised head")
      ->required()
      ->type_name("");
  app.add_option(
         "--with", with,
         "KEY=NUMBER: change a number of the species: mu_sec=0.5; KEY=xFACTOR: multiply it, or all of a list: r_G=x1.2")
      ->type_name("KEY=X")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
  app.add_option("--primordia", primordia,
                 "Primordia of a file (.prims) in place of those that grow on the head; also looked for in a FOLDER")
      ->type_name("FILE");
  app.add_flag("--by-id", by_id, "Take them in the order of their ids, as the released model of Bellis does");
  app.add_option("--like", like,
                 "FOLDER: whose size, thresholds, landmarks and veins: bellis, sunflower or gerbera; else by its name")
      ->type_name("NAME");
  app.add_option("--source", source, "FOLDER: parameters of veins as_published (the default) or of the paper")
      ->type_name("NAME");
  app.add_option(
         "--clock", clock,
         "Which outline a frame sees: consistent (that of its time) or published (O24); else as the species says")
      ->type_name("NAME");
  app.add_flag("--as-published", as_published,
               "Sections and primordia step by step as the programs released with O24 make them");
  app.add_flag("--mean-value", mean_value, "Move the inside by mean values instead of harmonically");
  add_whole(app, "--seed", seed, 0, std::numeric_limits<std::uint64_t>::max(), "Which individual");
}

}  // namespace anthesis::cli
