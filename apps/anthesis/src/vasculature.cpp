#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "anthesis/base/file.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/sha256.h"
#include "anthesis/base/version.h"
#include "anthesis/exchange/harmonic_fields.h"
#include "anthesis/exchange/section_figures.h"
#include "anthesis/exchange/vein_files.h"
#include "anthesis/exchange/vein_glb.h"
#include "anthesis/render/caption.h"
#include "anthesis/vasculature/vein_measures.h"
#include "collision_options.h"
#include "head.h"
#include "outputs.h"
#include "vein_figures.h"
#include "vein_pictures.h"
#include "vein_study.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 8> kFormats = {"csv", "swc", "ply", "glb", "png", "svg", "prims", "cntrs"};
constexpr std::array<std::string_view, 2> kStudyFormats = {"csv", "png"};
constexpr std::array<std::string_view, 1> kWeightFormats = {"raw"};
constexpr std::size_t kShownFields = 5;  // unless --control names some
constexpr std::size_t kGridFrames = 4;   // of a figure of growth, unless --frames says so
constexpr std::size_t kMostGridFrames = 60;

struct Arguments {
  HeadArguments head;
  VeinPictureOptions picture;
  std::vector<std::string> outputs;
  std::vector<std::string> vary;
  std::vector<std::string> weights;
  std::vector<std::string> controls;
  std::optional<double> at;
  std::optional<int> frames;
  std::optional<int> columns;
  int sides = 7;
  int threads = 0;
  bool json = false;
};

/// Whether a file's name without its extension ends so: veins-primordia.csv, head_initial.prims, growth.svg.
bool is_about(const Output& output, std::string_view what) {
  return without_extension(output.path).ends_with(what);
}

/// All of what one run has made.
struct Made {
  const Arguments& arguments;
  const Species& species;
  const GrownHead& head;
  const Progress& progress;

  const HeadMoment& last() const { return head.moments.back(); }
  MadeFrom lines(const HeadMoment& moment) const { return made_from(arguments.head, species, moment); }
};

std::string csv(const Made& made, const HeadMoment& moment, const Output& output) {
  if (is_about(output, "primordia")) {
    return vein_primordia_csv(moment.veins, made.head.primordia, made.lines(moment));
  }
  if (is_about(output, "measures")) {
    return vein_measures_csv(measure(moment.veins), made.head.primordia, made.lines(moment));
  }
  return veins_csv(moment.veins, made.lines(moment));
}

/// What was measured of the head at each moment.
std::string development_csv(const Made& made) {
  std::string table = fmt::format("# generator: Anthesis {}\n", kVersion);
  for (const auto& [key, value] : made.lines(made.last())) {
    if (key != "time") {
      table += fmt::format("# {}: {}\n", key, value);
    }
  }
  for (const HeadMoment& moment : made.head.moments) {
    std::string header = "time,frame";
    std::string row = fmt::format("{},{}", to_text(moment.time), moment.frame);
    for (const auto& [key, value] : figures_of(moment.veins, made.head.primordia, measure(moment.veins))) {
      header += "," + key;
      row += "," + value;
    }
    table += (&moment == &made.head.moments.front() ? header + "\n" : "") + row + "\n";
  }
  return table;
}

std::string glb(const Made& made) {
  VeinGlbParams params;
  params.tubes.sides = made.arguments.sides;
  params.receptacle_alpha = made.arguments.picture.no_receptacle ? 0.0 : params.receptacle_alpha;
  VeinGlb glb(params, made.lines(made.last()));
  for (const HeadMoment& moment : made.head.moments) {
    go_on(made.progress, "glb", moment.time);
    const std::vector<Vec2> outline = outline_of(made.head.contours, moment.frame);
    if (auto error = glb.add({moment.time, &moment.veins, outline})) {
      throw failure(*error);
    }
  }
  return value_of(glb.finish());
}

/// Control points whose fields are shown: some along the outline, apex and rim among them.
std::vector<std::uint32_t> shown_controls(const Made& made, std::size_t count) {
  std::vector<std::uint32_t> shown;
  for (const std::string& control : made.arguments.controls) {
    shown.push_back(static_cast<std::uint32_t>(parse_whole("--control", control, 0, count - 1)));
  }
  const std::size_t outline = made.head.contours.points_per_frame();
  for (std::size_t i = 0; made.arguments.controls.empty() && i < kShownFields; ++i) {
    shown.push_back(static_cast<std::uint32_t>(i * (outline - 1) / (kShownFields - 1)));
  }
  return shown;
}

std::string svg(const Made& made, const Output& output) {
  SectionFigureParams params;
  params.title = made.species.latin.empty() ? made.species.name : made.species.latin;
  params.caption = fmt::format("Anthesis {}, {}, time {}", kVersion, made.species.name, to_text(made.last().time));
  params.unit_mm = 1.0;
  params.interior.mesh.max_edge = made.species.vasculature->max_edge;
  params.interior.axis = made.species.vasculature->axis;
  params.progress = made.progress;
  const SectionSequence sections = head_sections(made.head.contours);
  if (is_about(output, "growth")) {
    const std::size_t last = made.head.contours.frames() - 1;
    const bool chosen = made.arguments.frames.has_value();
    const std::size_t count = std::min(chosen ? made.head.moments.size() : kGridFrames, kMostGridFrames);
    std::vector<std::size_t> frames;
    for (std::size_t i = 0; i < count; ++i) {
      frames.push_back(chosen ? made.head.moments[i * made.head.moments.size() / count].frame : (i + 1) * last / count);
    }
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    return value_of(section_growth_svg(sections, frames, 16, params));
  }
  if (is_about(output, "displacement")) {
    const std::size_t to = std::max<std::size_t>(made.last().frame, 1);
    return value_of(section_displacement_svg(sections, to / 2, to, params));
  }
  return value_of(
      section_weights_svg(sections.frame(made.last().frame), shown_controls(made, sections.points_per_frame), params));
}

std::string prims(const Made& made, const Output& output) {
  const VlabPrimordiaMoment moment = is_about(output, "initial") ? VlabPrimordiaMoment::kInitial
                                     : is_about(output, "final") ? VlabPrimordiaMoment::kFinal
                                                                 : VlabPrimordiaMoment::kStable;
  const VlabOrganCodes codes =
      made.species.head.active_ring->trans_landmark > 0 ? VlabOrganCodes::kGerbera : VlabOrganCodes::kBractOrFloret;
  return write_vlab_primordia(vlab_primordia(made.head.ring, moment, codes));
}

/// flower_0012.png
std::string numbered(const Output& output, std::size_t moment) {
  return fmt::format("{}_{:04d}.{}", without_extension(output.path), moment, output.format);
}

/// Files that hold one moment, of which --frames makes several.
bool holds_a_moment(const Output& output) {
  return output.format == "swc" || output.format == "ply" ||
         (output.format == "csv" && !is_about(output, "development"));
}

void write_pictures(const Made& made, const Output& output, const VeinPhotographer& photographer, Report& report,
                    const Progress& progress) {
  const Arguments& arguments = made.arguments;
  const HeadExtent extent = extent_of(made.head);
  if (arguments.picture.scale_bar) {
    report.values["scale_bar_mm"] = scale_bar_mm(extent.radius_mm());
  }
  std::vector<Image> images;
  for (std::size_t i = 0; i < made.head.moments.size(); ++i) {
    const HeadMoment& moment = made.head.moments[i];
    const std::string stage =
        arguments.frames ? fmt::format("picture {} of {}: ", i + 1, made.head.moments.size()) : "";
    const Progress watch = [&](std::string_view part, double fraction) {
      return progress(stage + std::string(part), fraction);
    };
    const HeadExtent own = anthesis::extent_of(outline_of(made.head.contours, moment.frame));
    const HeadExtent& framed = arguments.picture.own_size ? own : extent;
    images.push_back(report.time("render", [&] { return photographer.photograph(made.head, moment, framed, watch); }));
    if (arguments.picture.own_size) {
      write_caption(images.back(), fmt::format("time {:.3g}", moment.time));
    }
    if (!arguments.columns) {
      write_output(report, arguments.frames ? numbered(output, i) : output.path,
                   value_of(encode_png(images.back(), png_texts(made.lines(moment)))));
      images.clear();
    }
  }
  if (arguments.columns) {
    const Image sheet = contact_sheet(images, std::min<int>(*arguments.columns, static_cast<int>(images.size())));
    write_output(report, output.path, value_of(encode_png(sheet, png_texts(made.lines(made.last())))));
  }
}

/// All harmonic coordinates of all frames: too many for memory.
void write_weights(const Output& output, const GrownHead& head, Report& report, const Progress& progress) {
  Sha256 hash;
  std::optional<Error> error;
  report.time("weights", [&] {
    Expected<FileWriter> file = FileWriter::create(output.path);
    if (!file) {
      throw failure(file.error());
    }
    const InteriorGrowthParams params{.mesh = kVlabSectionMesh};
    const InteriorGrowth growth = value_of(InteriorGrowth::make(head_sections(head.contours), params));
    const ByteSink sink = [&](std::string_view bytes) {
      hash.add(bytes);
      return file->write(bytes);
    };
    error = write_harmonic_fields(growth, sink, progress);
    if (!error) {
      error = file->finish();
    }
  });
  if (error) {
    throw failure(*error);
  }
  report.add_hashed_output(output.path, hash.digits());
}

void describe(const Made& made, const VasculatureMeasures& measures, Report& report) {
  std::size_t unconnected = 0;
  auto kinds = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < made.head.primordia.size(); ++i) {
    auto& count = kinds[std::string(primordium_kind_name(made.head.primordia[i].kind))];
    count = count.is_null() ? 1 : count.get<int>() + 1;
    unconnected += measures.strands[i].vertex != kNoVertex && !measures.strands[i].connected ? 1 : 0;
  }
  report.values["species"] = made.species.name;
  report.values["seed"] = made.arguments.head.seed;
  report.values["version"] = kVersion;
  report.values["primordia"] = kinds;
  report.values["vertices"] = made.last().veins.vertices.size();
  report.values["ring_vertices_used"] = measures.bundles;
  report.values["second_connections"] = made.last().veins.second_connections.size();
  report.values["attraction_points_max"] = made.last().veins.most_attraction_points;
  report.values["unconnected"] = unconnected;
  report.values["brought_back"] = made.head.brought_back;
  report.values["total_length_mm"] = measures.total_length;
  report.values["loops"] = measures.loops;
  report.values["highest_order"] = measures.highest_order;
}

std::vector<double> times_of(const Arguments& arguments) {
  if (arguments.at && arguments.frames) {
    throw usage("--at is for one time and --frames for several: give one of them");
  }
  if (arguments.columns && !arguments.frames && arguments.vary.empty()) {
    throw usage("--columns is for the pictures of --frames or --vary: give one of them");
  }
  return arguments.frames ? even_times(*arguments.frames) : std::vector<double>{arguments.at.value_or(1.0)};
}

void run(const Arguments& arguments, Console& console) {
  const ThreadLimit threads(arguments.threads);
  const std::vector<double> times = times_of(arguments);
  if (!arguments.vary.empty()) {
    if (arguments.frames || !arguments.weights.empty()) {
      throw usage("--vary goes with neither --frames nor --weights");
    }
    const std::vector<Output> outputs = check_outputs(arguments.outputs, kStudyFormats);
    return run_study(arguments.head, arguments.vary, times.back(), arguments.picture, arguments.columns, outputs,
                     arguments.json, console);
  }
  const std::vector<Output> outputs = check_outputs(arguments.outputs, kFormats);
  for (const Output& output : outputs) {
    if (output.format == "prims" && !arguments.head.primordia.empty()) {
      throw usage("a .prims file is of primordia that grow on the head: leave --primordia out");
    }
  }
  const std::vector<Output> weights = check_outputs(arguments.weights, kWeightFormats, "--weights");
  const VeinPhotographer photographer(arguments.picture);
  if (arguments.columns) {
    photographer.check_sheet(times.size());
  }
  const Progress progress = console.progress();
  Report report;
  const Species species = report.time("species", [&] { return find_head(arguments.head); });
  if (!arguments.controls.empty()) {
    const ContourSequence contours = value_of(head_contours(species, arguments.head.rules()));
    const std::size_t count = head_sections(contours).points_per_frame;
    for (const std::string& control : arguments.controls) {
      parse_whole("--control", control, 0, count - 1);
    }
  }
  const GrownHead head = grow_head(arguments.head, species, times, report, progress);
  const VasculatureMeasures measures = report.time("measures", [&] { return measure(head.moments.back().veins); });
  const Made made{arguments, species, head, progress};
  const auto bytes_of = [&](const Output& output, const HeadMoment& moment) {
    if (output.format == "swc") {
      return veins_swc(moment.veins, made.lines(moment));
    }
    if (output.format == "ply") {
      return value_of(veins_ply(moment.veins, {.sides = arguments.sides}, made.lines(moment)));
    }
    if (output.format == "glb") {
      return glb(made);
    }
    if (output.format == "svg") {
      return svg(made, output);
    }
    if (output.format == "prims") {
      return prims(made, output);
    }
    if (output.format == "cntrs") {
      return write_vlab_contour_sequence(vlab_contour_sequence(head.contours));
    }
    return is_about(output, "development") ? development_csv(made) : csv(made, moment, output);
  };
  for (const Output& output : outputs) {
    if (output.format == "png") {
      write_pictures(made, output, photographer, report, progress);
      continue;
    }
    const bool several = arguments.frames && holds_a_moment(output);
    for (std::size_t i = several ? 0 : head.moments.size() - 1; i < head.moments.size(); ++i) {
      go_on(progress, output.format, head.moments[i].time);
      const std::string bytes = report.time(output.format.c_str(), [&] { return bytes_of(output, head.moments[i]); });
      write_output(report, several ? numbered(output, i) : output.path, bytes);
    }
  }
  for (const Output& output : weights) {
    write_weights(output, head, report, progress);
  }
  describe(made, measures, report);
  if (arguments.json) {
    print(report.text());
  } else if (outputs.empty() && weights.empty()) {
    print(fmt::format("{} primordia, {} vertices, {} bundles at the ring, {} second connections, {} unconnected\n",
                      head.primordia.size(), made.last().veins.vertices.size(), measures.bundles,
                      made.last().veins.second_connections.size(), report.values["unconnected"].get<std::size_t>()));
  }
}

}  // namespace

Command add_vasculature(CLI::App& app) {
  CLI::App* command =
      add_command(app, "vasculature", "Grow the veins inside a flower head",
                  "  anthesis vasculature sunflower-head -o veins.glb -o veins.csv -o veins.swc\n"
                  "  anthesis vasculature bellis-head -o veins.png --view side --cut half\n"
                  "  anthesis vasculature gerbera-head -o growing.glb --frames 13\n"
                  "  anthesis vasculature sunflower-head --vary mu_sec=0:1:0.25 -o sheet.png -o table.csv\n"
                  "  anthesis vasculature bellis-head -o primordia.csv -o measures.csv -o section.svg\n"
                  "  anthesis vasculature my-vlab-folder --like bellis --primordia bellis_stable.prims --json");
  auto arguments = std::make_shared<Arguments>();
  add_outputs(*command, arguments->outputs, kFormats);
  arguments->head.add_to(*command);
  add_number(*command, "--at", arguments->at, {0.0, 1.0},
             "Time of development: 0 first primordium, 1 grown; 1 if left out");
  add_whole(
      *command, "--frames", arguments->frames, 1, 250,
      "So many moments of the development: an animated .glb; else x_0000.png, x_0001.png ..., so .csv, .swc, .ply");
  add_whole(*command, "--columns", arguments->columns, 1, 100, "Put several pictures into one, so many in a row");
  command
      ->add_option(
          "--vary", arguments->vary,
          "KEY=FROM:TO:STEP (or xFROM:TO:STEP, factors): a head for each value; a .csv table, a .png sheet; repeatable")
      ->type_name("KEY=A:B:C")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
  command
      ->add_option("--weights", arguments->weights, "Write all harmonic coordinates of all frames for VLab: head.raw")
      ->type_name("FILE");
  command
      ->add_option("--control", arguments->controls,
                   "Control points whose harmonic coordinates an .svg shows, 0 the apex; five if left out")
      ->type_name("N")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
  arguments->picture.add_to(*command);
  add_whole(*command, "--sides", arguments->sides, 3, 64, "Sides of the tubes of a .ply and a .glb");
  add_whole(*command, "--threads", arguments->threads, 0, 1024,
            "Threads to use, 0 for all; results do not depend on it");
  command->add_flag("--json", arguments->json, "Print JSON");
  return {command, [arguments](Console& console) { run(*arguments, console); }};
}

}  // namespace anthesis::cli
