#include <array>
#include <optional>

#include "anthesis/base/parallel.h"
#include "anthesis/exchange/csv.h"
#include "anthesis/exchange/glb.h"
#include "anthesis/exchange/judge_sample.h"
#include "anthesis/exchange/obj.h"
#include "anthesis/exchange/ply.h"
#include "growth.h"
#include "outputs.h"
#include "picture_options.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 5> kFormats = {"glb", "obj", "ply", "csv", "png"};
constexpr int kDefaultFrames = 25;

struct Arguments {
  GrowthArguments growth;
  std::vector<std::string> outputs;
  std::optional<double> at;
  std::optional<int> frames;
  std::string expected_positions;
  bool no_collisions = false;
  bool diffuse_transmission = false;
};

std::string file_name_of(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

/// Where the judges of test/judges must find vertices, at three keys of the animation.
std::string expected_positions(const Development& development, const GlbOptions& options) {
  const int last = options.time ? 0 : options.frames - 1;
  const std::array<int, 3> frames = {last / 3, 2 * last / 3, last};
  return value_of(expected_positions_json(development, options, frames));
}

void run(const Arguments& arguments, Console& console) {
  if (!arguments.expected_positions.empty()) {
    check_writable(arguments.expected_positions);
  }
  if (arguments.outputs.empty()) {
    throw usage("say where to write: -o flower.glb");
  }
  if (arguments.at && arguments.frames) {
    throw usage("--at is for one time and --frames for an animation: give one of them");
  }
  std::vector<Output> outputs = check_outputs(arguments.outputs, kFormats);
  bool animated = false;
  for (const Output& output : outputs) {
    animated = animated || output.format == "glb";
    if (output.format == "obj") {
      check_writable(without_extension(output.path) + ".mtl");
    }
  }
  animated = animated && !arguments.at && arguments.frames.value_or(kDefaultFrames) > 1;
  if (arguments.frames && !animated && *arguments.frames > 1) {
    throw usage("--frames needs a .glb output; `anthesis render` takes pictures of several times");
  }

  const ThreadLimit threads(arguments.growth.threads);
  const Progress progress = console.progress();
  Report report;
  const Species species = report.time("species", [&] { return find_plant(arguments.growth.species); });
  const Development development = grow(arguments.growth, species, report, progress);
  const double time = arguments.at.value_or(1.0);
  describe_plant(development, time, report);
  report.values["frames"] = animated ? arguments.frames.value_or(kDefaultFrames) : 1;

  for (const Output& output : outputs) {
    std::string bytes;
    if (output.format == "glb") {
      GlbOptions options;
      options.diffuse_transmission = arguments.diffuse_transmission;
      if (animated) {
        options.frames = arguments.frames.value_or(kDefaultFrames);
      } else {
        options.time = time;
      }
      bytes = value_of(report.time("glb", [&] { return to_glb(development, options, progress); }));
      if (!arguments.expected_positions.empty()) {
        write_output(report, arguments.expected_positions, expected_positions(development, options));
      }
    } else if (output.format == "obj") {
      const std::string mtl_path = without_extension(output.path) + ".mtl";
      ObjText text =
          value_of(report.time("obj", [&] { return to_obj(development, time, file_name_of(mtl_path), progress); }));
      write_output(report, mtl_path, text.mtl);
      bytes = std::move(text.obj);
    } else if (output.format == "ply") {
      bytes = value_of(report.time("ply", [&] { return to_ply(development, time, progress); }));
    } else if (output.format == "csv") {
      bytes = value_of(report.time("csv", [&] { return organs_csv(development, time); }));
    } else {
      Photographer photographer({});
      bytes = report.time("png", [&] { return photographer.take(development, time, time, progress); });
    }
    write_output(report, output.path, bytes);
  }
  if (arguments.growth.json) {
    print(report.text());
  }
}

}  // namespace

Command add_grow(CLI::App& app) {
  CLI::App* command = add_command(app, "grow", "Grow a plant and write it as a 3D file",
                                  "  anthesis grow sunflower -o sunflower.glb\n"
                                  "  anthesis grow daisy -o bud.obj -o bud.csv --at 0.3 --seed 7\n"
                                  "  anthesis grow mine.toml -o mine.glb --frames 100 --json");
  auto arguments = std::make_shared<Arguments>();
  add_outputs(*command, arguments->outputs, kFormats);
  arguments->growth.add_to(*command, true);
  add_number(*command, "--at", arguments->at, {0.0, 1.0},
             "Time of development: 0 bud, 1 bloom; 1 if left out, and the whole development in .glb");
  add_whole(*command, "--frames", arguments->frames, 1, 1000, "Key frames of the animation in .glb, 25 if left out");
  command->add_flag("--diffuse-transmission", arguments->diffuse_transmission,
                    "State the petals' translucency in .glb by KHR_materials_diffuse_transmission");
  command->add_flag("--no-collisions", arguments->no_collisions,
                    "Do not push organs apart (this version never does; the flag keeps scripts working)");
  command->add_option("--expected-positions", arguments->expected_positions)
      ->group("");  // for test/judges; not in help
  return {command, [arguments](Console& console) { run(*arguments, console); }};
}

}  // namespace anthesis::cli
