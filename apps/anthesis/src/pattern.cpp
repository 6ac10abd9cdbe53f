#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/version.h"
#include "anthesis/exchange/csv.h"
#include "anthesis/exchange/positions_csv.h"
#include "anthesis/exchange/svg.h"
#include "disc.h"
#include "growth.h"
#include "outputs.h"
#include "parastichy_options.h"
#include "picture_options.h"
#include "point_cloud.h"
#include "study.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 4> kPlantFormats = {"csv", "svg", "png", "ply"};

struct Arguments {
  GrowthArguments growth;
  std::vector<std::string> outputs;
  double at = 1.0;
  ParastichyArguments parastichies;
  std::string measured;
  DiscArguments disc;
  StudyArguments study;
};

/// The plan as a picture: a bead for each organ, in the colour of its kind, seen from straight above.
std::string bead_picture(const Development& development, double time, const Progress& progress) {
  constexpr std::array<Colour, 6> kColours = {Colour{0.85, 0.45, 0.03}, Colour{0.25, 0.10, 0.04},
                                              Colour{0.10, 0.30, 0.06}, Colour{0.45, 0.05, 0.15},
                                              Colour{0.05, 0.20, 0.45}, Colour{0.50, 0.50, 0.50}};
  constexpr int kSide = 1200;
  Scene scene;
  scene.meshes.push_back({unit_sphere(), {}});
  scene.pigments.emplace_back();
  for (const OrganState& organ : development.at(time).organs) {
    Instance bead;
    bead.world_from_mesh.position_mm = organ.world_from_organ.position_mm;
    bead.world_from_mesh.scale = 0.9 * std::sqrt(organ.area_mm2 / math::kPi);
    bead.colour = kColours[development.organs()[organ.id.value - 1].kind % kColours.size()];
    scene.instances.push_back(std::move(bead));
  }
  const Camera camera = frame(scene, View::top(), kSide, kSide);
  scene.lighting = studio_lighting(camera);
  return value_of(encode_png(value_of(trace(scene, camera, RenderOptions::draft(kSide, kSide), progress)),
                             provenance_texts(development, time, false)));
}

std::string sentence(const PatternWarning& warning) {
  const std::string measure = fmt::format("{:.2g}, more than {:.2g}", warning.measure, warning.threshold);
  switch (warning.flaw) {
    case PatternFlaw::kCurvature:
      return "organs are large for the curvature of the receptacle: their radius over its radius is " + measure;
    case PatternFlaw::kRadiusRatio:
      return "neighbours differ too much in size: the ratio of their radii is " + measure;
    case PatternFlaw::kGap:
      return "organs leave gaps: to the further neighbour, in distances at contact, " + measure;
    case PatternFlaw::kJump:
      return "organs jump along the receptacle: from one to the next, in diameters, " + measure;
    case PatternFlaw::kIrregular:
      break;
  }
  return "organs rest on others than in spirals: a share of " + measure;
}

/// Says where the pattern stops being phyllotactic.
void report_warnings(const Development& development, Console& console, Report& report) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [head, warning] : development.warnings()) {
    console.say(fmt::format("anthesis: warning: {} from {:.3f} to {:.3f} (0 apex, 1 base): {}", head, warning.s_from,
                            warning.s_to, sentence(warning)));
    list.push_back({{"head", head},
                    {"flaw", flaw_name(warning.flaw)},
                    {"from", warning.s_from},
                    {"to", warning.s_to},
                    {"measure", warning.measure},
                    {"threshold", warning.threshold}});
  }
  report.values["warnings"] = std::move(list);
}

void run_species(const Arguments& arguments, Console& console) {
  const std::vector<Output> outputs = check_outputs(arguments.outputs, kPlantFormats);
  arguments.parastichies.check();
  const ThreadLimit threads(arguments.growth.threads);
  const Progress progress = console.progress();
  Report report;
  const Species species = report.time("species", [&] { return find_plant(arguments.growth.species); });
  const Development development = grow(arguments.growth, species, report, progress);
  describe_plant(development, arguments.at, report);
  if (species.head.rule == PlacementRule::kActiveRing) {
    report.values["divergence_deg"] = nullptr;  // nobody states it: it comes about
  } else {
    report.values["divergence_deg"] = species.head.divergence_deg;
  }
  report_warnings(development, console, report);
  const std::vector<PatternOrgan> pattern = pattern_of(development, arguments.at);
  ParastichyFile file;
  file.title = species.latin.empty() ? species.name : species.name + " (" + species.latin + ")";
  file.caption = fmt::format("Anthesis {}, seed {}, time {}", kVersion, arguments.growth.seed, to_text(arguments.at));
  file.length_mm = development.receptacle(arguments.at).length_mm();
  file.first_is_1 = true;
  ParastichyOptions options;
  const bool several =
      species.head.rule == PlacementRule::kDivergent || species.head.rule == PlacementRule::kActiveRing;
  options.in_order_of_birth = !several;  // several places bear organs by turns
  arguments.parastichies.analyse(pattern, options, file, arguments.outputs.empty() && !arguments.growth.json, report);
  for (const Output& output : outputs) {
    const std::string bytes = report.time(output.format.c_str(), [&] {
      if (output.format == "csv") {
        return value_of(organs_csv(development, arguments.at));
      }
      if (output.format == "svg") {
        return plan_svg(value_of(plan_of(development, arguments.at)));
      }
      return output.format == "png" ? bead_picture(development, arguments.at, progress)
                                    : point_cloud_ply(development, arguments.at);
    });
    write_output(report, output.path, bytes);
  }
  if (arguments.growth.json) {
    print(report.text());
  }
}

/// Organs of a plant that was digitised.
void run_measured(const Arguments& arguments) {
  if (!arguments.outputs.empty()) {
    throw usage("--measured has its places already: write what was found with --parastichies");
  }
  arguments.parastichies.check();
  Report report;
  const std::vector<Vec3> positions_mm =
      report.time("read", [&] { return value_of(load_positions(arguments.measured)); });
  const std::vector<PatternOrgan> pattern = pattern_organs(positions_mm);
  ParastichyOptions options;
  options.in_order_of_birth = false;
  ParastichyFile file;
  file.title = arguments.measured;
  file.caption = fmt::format("Anthesis {}, {} measured organs", kVersion, positions_mm.size());
  file.first_is_1 = true;
  report.values["version"] = kVersion;
  report.values["organs"] = positions_mm.size();
  arguments.parastichies.analyse(pattern, options, file, !arguments.growth.json, report);
  if (arguments.growth.json) {
    print(report.text());
  }
}

void run(const Arguments& arguments, Console& console) {
  const bool other = arguments.disc.wanted() || arguments.study.wanted() || !arguments.measured.empty();
  if (!other && arguments.growth.species.empty()) {
    throw usage("say which pattern: a species, --measured FILE, --vogel N for a flat disc, or --study divergence");
  }
  if (arguments.disc.wanted() + arguments.study.wanted() + !arguments.measured.empty() +
          !arguments.growth.species.empty() >
      1) {
    throw usage("a species, --measured, --study, and --vogel or --sweep each have their own pattern: give one of them");
  }
  if (arguments.disc.wanted()) {
    return run_disc(arguments.disc, {arguments.outputs, arguments.growth.threads, arguments.growth.json}, console);
  }
  if (arguments.study.wanted()) {
    return run_study(arguments.study, arguments.outputs, arguments.growth.threads, arguments.growth.json, console);
  }
  if (!arguments.measured.empty()) {
    return run_measured(arguments);
  }
  run_species(arguments, console);
}

}  // namespace

Command add_pattern(CLI::App& app) {
  CLI::App* command =
      add_command(app, "pattern", "Find where a plant's organs are, and what pattern they make",
                  "  anthesis pattern sunflower\n"
                  "  anthesis pattern sunflower -o organs.csv -o organs.svg\n"
                  "  anthesis pattern sunflower --parastichies families.svg --parastichies regions.csv\n"
                  "  anthesis pattern --measured organs.csv --parastichies measured.svg\n"
                  "  anthesis pattern --study divergence -o study.svg\n"
                  "  anthesis pattern --vogel 82 --cone-deg 38\n"
                  "  anthesis pattern --vogel 82 --sweep cone-deg=20:89:0.5 -o rays.svg\n"
                  "  anthesis pattern --cone-deg 75 --sweep organs=20:400:1 -o rays.csv");
  auto arguments = std::make_shared<Arguments>();
  add_outputs(*command, arguments->outputs, kPlantFormats);
  arguments->growth.add_to(*command, false);
  add_number(*command, "--at", arguments->at, {0.0, 1.0}, "Time of development: 0 bud, 1 bloom");
  arguments->parastichies.add_to(*command);
  command
      ->add_option("--measured", arguments->measured,
                   "Places of organs that were measured, in place of a species: a CSV with columns x, y, z")
      ->type_name("FILE");
  arguments->study.add_to(*command);
  arguments->disc.add_to(*command);
  return {command, [arguments](Console& console) { run(*arguments, console); }};
}

}  // namespace anthesis::cli
