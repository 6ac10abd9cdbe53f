#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "anthesis/base/file.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/version.h"
#include "anthesis/exchange/vein_files.h"
#include "anthesis/exchange/vlab_digitised_head.h"
#include "anthesis/phyllotaxis/active_ring.h"
#include "anthesis/receptacle/interior_growth.h"
#include "anthesis/vasculature/mean_value_growth.h"
#include "outputs.h"
#include "vlab_folder.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 3> kFormats = {"csv", "swc", "ply"};
constexpr double kStepTime = 0.0005;   // of the models of O24
constexpr std::size_t kFrames = 2214;  // of the published sequences
constexpr double kRingScale = 100.0;   // of thresholds in the model of primordia
constexpr std::uint32_t kStride = 8;   // of mean value growth

/// What the programs of O24 state of each of its heads, and not the files.
struct HeadConstants {
  std::string_view name;
  VeinParams (*veins)(VeinSource);
  double scale = 1.0;           ///< from the files' unit to that of the lengths in VeinParams
  double threshold = 1.0;       ///< factor of the function thresholdDistanceFunc
  double threshold_pace = 1.0;  ///< factor of its time
  std::size_t bract_landmark = 0;
  std::size_t trans_landmark = 0;
  double last_ring = 0.0025;
  bool births_ascend = false;  ///< births out of order are mended
  bool three_types = false;    ///< types of primordia in files: 0 bract, 1 trans floret, 2 floret
};

constexpr double kFirstThreshold = 3.5 * math::kPi;

constexpr std::array<HeadConstants, 3> kHeads = {{
    {.name = "bellis",
     .veins = bellis_veins,
     .scale = 15.0,
     .threshold = kFirstThreshold,
     .bract_landmark = 3,
     .last_ring = 0.01,
     .births_ascend = true},
    {.name = "sunflower",
     .veins = sunflower_veins,
     .scale = 10.0,
     .threshold = 0.45 * kFirstThreshold,
     .threshold_pace = 2.0,
     .bract_landmark = 8},
    {.name = "gerbera",
     .veins = gerbera_veins,
     .scale = 15.0,
     .threshold = kFirstThreshold,
     .bract_landmark = 6,
     .trans_landmark = 11,
     .three_types = true},
}};

/// What a file holds.
enum class Content { kVertices, kPrimordia, kMeasures };

struct Arguments {
  std::string folder;
  std::vector<std::string> outputs;
  std::string primordia;
  std::string parameters = "sunflower";
  std::string set = "as-published";
  std::string clock = "published";
  bool as_published = false;
  bool mean_value = false;
  std::optional<double> scale;
  std::optional<int> bract_landmark;
  std::optional<int> trans_landmark;
  std::uint64_t seed = 1;
  int sides = 7;
  int threads = 0;
  bool json = false;
};

const HeadConstants& constants_of(const Arguments& arguments) {
  const auto found =
      std::find_if(kHeads.begin(), kHeads.end(), [&](const auto& head) { return head.name == arguments.parameters; });
  if (found == kHeads.end()) {
    throw usage("--parameters must be bellis, sunflower or gerbera, got " + arguments.parameters);
  }
  return *found;
}

/// Which of two words was given.
bool is_second(const std::string& flag, const std::string& word, std::string_view first, std::string_view second) {
  if (word != first && word != second) {
    throw usage(fmt::format("{} must be {} or {}, got {}", flag, first, second, word));
  }
  return word == second;
}

/// A CSV says by its name what it shall hold: primordia.csv, bellis-measures.csv, veins.csv.
Content content_of(const std::string& path) {
  const std::string name = without_extension(path);
  return name.ends_with("primordia")  ? Content::kPrimordia
         : name.ends_with("measures") ? Content::kMeasures
                                      : Content::kVertices;
}

const VlabFunction* find_smooth(const VlabObject& object, std::string_view name) {
  const VlabFunction* function = object.find_function(name);
  if (function != nullptr) {
    if (auto error = check(*function)) {
      throw failure(*error);
    }
  }
  return function;
}

/// Primordia of a file, which may lie in the folder.
std::vector<VeinPrimordium> read_primordia(const Arguments& arguments, const HeadConstants& constants) {
  std::string path = arguments.primordia;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    const std::string within = (std::filesystem::path(arguments.folder) / path).string();
    if (std::filesystem::exists(within, ignored)) {
      path = within;
    }
  }
  const VlabPrimordia file = value_of(read_vlab_primordia(value_of(read_file(path, kVlabTextLimit)), path));
  std::vector<VeinPrimordium> primordia;
  for (const VlabPrimordium& one : file.primordia) {
    PrimordiumKind kind = one.type == 1 ? PrimordiumKind::kBract : PrimordiumKind::kFloret;
    if (constants.three_types) {
      kind = one.type == 0   ? PrimordiumKind::kBract
             : one.type == 1 ? PrimordiumKind::kTransFloret
                             : PrimordiumKind::kFloret;
    }
    primordia.push_back({one.id, one.step, one.s, one.azimuth_rad, kind});
  }
  return primordia;
}

/// Primordia of the active ring, as they are when they have become stable.
std::vector<VeinPrimordium> grow_primordia(const Arguments& arguments, bool consistent, const HeadConstants& constants,
                                           const VlabObject& object) {
  const VlabFunction* function = find_smooth(object, "thresholdDistanceFunc");
  if (function == nullptr) {
    throw failure({ErrorCode::kInvalidParameter, arguments.folder,
                   "must have a function thresholdDistanceFunc, or say where primordia are: --primordia FILE"});
  }
  const GrowingReceptacle head(value_of(vlab_digitised_head(object.contours, object.knots, kRingScale)),
                               arguments.as_published ? SectionLookup::kAsPublished : SectionLookup::kExact);
  ActiveRingParams params;
  const VlabFunctionTable drawn(*function);
  params.threshold = [&](double time) { return constants.threshold * drawn(constants.threshold_pace * time); };
  const auto landmark = [](std::optional<int> given, std::size_t known) {
    return given ? static_cast<std::size_t>(*given) : known;
  };
  params.bract_landmark = landmark(arguments.bract_landmark, constants.bract_landmark);
  params.trans_landmark = landmark(arguments.trans_landmark, constants.trans_landmark);
  params.last_ring = constants.last_ring;
  const std::vector<RingPrimordium> grown =
      value_of(arguments.as_published ? grow_active_ring_as_published(head, params) : grow_active_ring(head, params));
  const std::vector<double> clock = published_clock(head, kStepTime);
  std::vector<VeinPrimordium> primordia;
  for (std::uint32_t id = 0; id < grown.size(); ++id) {
    const RingMoment& stable = grown[id].stable;
    const std::uint32_t step =
        consistent ? static_cast<std::uint32_t>(std::lround(stable.time / kStepTime))
        : arguments.as_published
            ? stable.step
            : static_cast<std::uint32_t>(std::lower_bound(clock.begin(), clock.end(), stable.time) - clock.begin());
    primordia.push_back({id, step, stable.s, stable.azimuth_rad,
                         stable.kind == HeadOrganKind::kBract   ? PrimordiumKind::kBract
                         : stable.kind == HeadOrganKind::kTrans ? PrimordiumKind::kTransFloret
                                                                : PrimordiumKind::kFloret});
  }
  std::stable_sort(primordia.begin(), primordia.end(),
                   [](const auto& a, const auto& b) { return a.birth_frame < b.birth_frame; });
  return primordia;
}

/// The half section frame by frame. By the published clock, as O24's programs made it: the stages lie equally in time,
/// and the files' pace is that of its frames. Else frame and step of the model of primordia are one.
ContourSequence sample_head(const Arguments& arguments, bool consistent, double scale, const VlabObject& object) {
  const std::vector<double> knots = consistent ? object.knots : std::vector<double>{};
  const GrowingReceptacle head(value_of(vlab_digitised_head(object.contours, knots, scale)),
                               arguments.as_published ? SectionLookup::kAsPublished : SectionLookup::kExact);
  std::vector<double> times(kFrames);
  const VlabFunction* pace = find_smooth(object, "output_dalpha");
  if (consistent) {
    for (std::size_t f = 0; f < times.size(); ++f) {
      times[f] = std::min(1.0, kStepTime * static_cast<double>(f));
    }
  } else if (pace == nullptr) {
    for (std::size_t f = 0; f < times.size(); ++f) {
      times[f] = static_cast<double>(f) / static_cast<double>(times.size() - 1);
    }
  } else {
    times = value_of(contour_times([table = VlabFunctionTable(*pace)](double time) { return table(time); }));
  }
  return sample_contours(head, times);
}

/// Veins within harmonic growth.
Expected<Vasculature> grow_harmonic(const ContourSequence& contours, const VeinParams& params,
                                    const std::vector<VeinPrimordium>& primordia, VeinOptions options) {
  Expected<InteriorGrowth> interior = InteriorGrowth::make(with_base(contours));
  if (!interior) {
    return unexpected(interior.error());
  }
  std::optional<Error> failed;
  const std::size_t outline = contours.points_per_frame();
  const HeadGrowth growth{interior->frames(),
                          [&](std::size_t frame) { return interior->section(frame).first(outline); },
                          [&](std::size_t frame, std::size_t, std::span<Vec2> points) {
                            if (!failed) {
                              failed = interior->advance(frame);
                            }
                            if (!failed) {
                              interior->carry(points);
                            }
                          }};
  options.stride = 1;
  Expected<Vasculature> veins = grow_veins(params, growth, primordia, options);
  if (failed) {
    return unexpected(*failed);
  }
  return veins;
}

Expected<Vasculature> grow_mean_value(const ContourSequence& contours, const VeinParams& params,
                                      const std::vector<VeinPrimordium>& primordia, VeinOptions options) {
  OutlineSequence outlines;
  outlines.points_per_frame = contours.points_per_frame();
  for (const ContourPoint& point : contours.points) {
    outlines.points.push_back(point.position);
  }
  options.stride = kStride;
  return grow_veins(params, mean_value_growth(std::move(outlines)), primordia, options);
}

MadeFrom made_from(const Arguments& arguments, double scale) {
  MadeFrom lines = {
      {"head", std::filesystem::path(arguments.folder).lexically_normal().filename().string()},
      {"parameters", arguments.parameters},
      {"set", arguments.set},
      {"primordia", arguments.primordia.empty() ? (arguments.as_published ? "active ring, as published" : "active ring")
                                                : std::filesystem::path(arguments.primordia).filename().string()},
      {"inside", arguments.mean_value ? "mean value" : "harmonic"},
      {"clock", arguments.clock},
      {"scale", to_text(scale)},
      {"seed", std::to_string(arguments.seed)}};
  if (lines[0].second.empty()) {  // FOLDER ended in a slash
    lines[0].second = std::filesystem::path(arguments.folder).lexically_normal().parent_path().filename().string();
  }
  return lines;
}

void run(const Arguments& arguments, Console& console) {
  const std::vector<Output> outputs = check_outputs(arguments.outputs, kFormats);
  const HeadConstants& constants = constants_of(arguments);
  const bool paper = is_second("--set", arguments.set, "as-published", "paper");
  const bool consistent = is_second("--clock", arguments.clock, "published", "consistent");
  const double scale = arguments.scale.value_or(constants.scale);
  const ThreadLimit threads(arguments.threads);
  Report report;

  const VlabObject object =
      report.time("read", [&] { return value_of(read_vlab_object(vlab_files_of(arguments.folder))); });
  std::vector<VeinPrimordium> primordia = report.time("primordia", [&] {
    return arguments.primordia.empty() ? grow_primordia(arguments, consistent, constants, object)
                                       : read_primordia(arguments, constants);
  });
  if (constants.births_ascend && !paper) {
    make_births_ascend(primordia);
  }
  const ContourSequence contours =
      report.time("contours", [&] { return sample_head(arguments, consistent, scale, object); });
  const VeinParams params = constants.veins(paper ? VeinSource::kPaper : VeinSource::kAsPublished);
  VeinOptions options;
  options.seed = arguments.seed;
  options.progress = console.progress();
  const Vasculature veins = report.time("veins", [&] {
    return value_of(arguments.mean_value ? grow_mean_value(contours, params, primordia, options)
                                         : grow_harmonic(contours, params, primordia, options));
  });
  const VasculatureMeasures measures = report.time("measures", [&] { return measure(veins); });

  const MadeFrom lines = made_from(arguments, scale);
  for (const Output& output : outputs) {
    const std::string bytes = report.time(output.format.c_str(), [&] {
      if (output.format == "swc") {
        return veins_swc(veins, lines);
      }
      if (output.format == "ply") {
        return value_of(veins_ply(veins, {.sides = arguments.sides}, lines));
      }
      switch (content_of(output.path)) {
        case Content::kPrimordia:
          return vein_primordia_csv(veins, primordia, lines);
        case Content::kMeasures:
          return vein_measures_csv(measures, primordia, lines);
        case Content::kVertices:
          break;
      }
      return veins_csv(veins, lines);
    });
    write_output(report, output.path, bytes);
  }

  std::size_t unconnected = 0;
  auto kinds = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < primordia.size(); ++i) {
    auto& count = kinds[std::string(primordium_kind_name(primordia[i].kind))];
    count = count.is_null() ? 1 : count.get<int>() + 1;
    unconnected += measures.strands[i].vertex != kNoVertex && !measures.strands[i].connected ? 1 : 0;
  }
  report.values["version"] = kVersion;
  report.values["seed"] = arguments.seed;
  report.values["primordia"] = kinds;
  report.values["vertices"] = veins.vertices.size();
  report.values["ring_vertices_used"] = measures.bundles;
  report.values["second_connections"] = veins.second_connections.size();
  report.values["unconnected"] = unconnected;
  report.values["total_length"] = measures.total_length;
  report.values["loops"] = measures.loops;
  report.values["highest_order"] = measures.highest_order;
  if (arguments.json) {
    print(report.text());
  } else if (outputs.empty()) {
    print(fmt::format("{} primordia, {} vertices, {} bundles at the ring, {} second connections, {} unconnected\n",
                      primordia.size(), veins.vertices.size(), measures.bundles, veins.second_connections.size(),
                      unconnected));
  }
}

}  // namespace

Command add_vasculature(CLI::App& app) {
  CLI::App* command =
      add_command(app, "vasculature", "Grow the veins of a flower head that was digitised",
                  "  anthesis vasculature my-head -o veins.ply -o veins.csv -o veins.swc\n"
                  "  anthesis vasculature my-head --parameters bellis -o primordia.csv -o measures.csv\n"
                  "  anthesis vasculature my-head --parameters bellis --primordia bellis_stable.prims --json");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("FOLDER", arguments->folder,
                   "A VLab head: contours with markers (.cset), functions (.fset), knotPositions.dat")
      ->required()
      ->type_name("");
  add_outputs(*command, arguments->outputs, kFormats);
  command
      ->add_option("--primordia", arguments->primordia,
                   "Primordia of a file (.prims) in place of those that grow on the head; also looked for in FOLDER")
      ->type_name("FILE");
  command
      ->add_option("--parameters", arguments->parameters,
                   "Whose parameters: bellis, sunflower or gerbera; sunflower if left out")
      ->type_name("NAME");
  command
      ->add_option("--set", arguments->set,
                   "Which of them: as-published (what the released models do, the default) or paper")
      ->type_name("NAME");
  command
      ->add_option("--clock", arguments->clock,
                   "Which outline a frame sees: published (the default) or consistent (that of the primordia's time)")
      ->type_name("NAME");
  command->add_flag("--as-published", arguments->as_published,
                    "Sections and primordia step by step as the released programs make them");
  command->add_flag("--mean-value", arguments->mean_value, "Move the inside by mean values instead of harmonically");
  add_number(*command, "--scale", arguments->scale, {0.0, 1e6, true, false},
             "From the files' unit to that of the parameters; 15, 10 or 15 for bellis, sunflower, gerbera");
  add_whole(*command, "--bract-landmark", arguments->bract_landmark, 0, 10000,
            "Outside this landmark, counted from the base, are bracts; 0: none; 3, 8 or 6 if left out");
  add_whole(*command, "--trans-landmark", arguments->trans_landmark, 0, 10000,
            "The same for trans florets; 0, 0 or 11 if left out");
  add_whole(*command, "--seed", arguments->seed, 0, std::numeric_limits<std::uint64_t>::max(), "Which individual");
  add_whole(*command, "--sides", arguments->sides, 3, 64, "Sides of the tubes of a .ply");
  add_whole(*command, "--threads", arguments->threads, 0, 1024,
            "Threads to use, 0 for all; results do not depend on it");
  command->add_flag("--json", arguments->json, "Print JSON");
  return {command, [arguments](Console& console) { run(*arguments, console); }};
}

}  // namespace anthesis::cli
