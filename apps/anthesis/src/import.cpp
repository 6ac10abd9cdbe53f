#include <array>
#include <optional>

#include "anthesis/base/version.h"
#include "anthesis/exchange/species_file.h"
#include "anthesis/exchange/vlab_species.h"
#include "outputs.h"
#include "vlab_folder.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 1> kFormats = {"toml"};

struct Arguments {
  std::string program;
  std::string folder;
  std::vector<std::string> outputs;
  VlabScale scale;
  std::optional<double> width_mm;
  std::string like;
  bool json = false;
};

void run(const Arguments& arguments) {
  if (arguments.program != "vlab") {
    throw usage("anthesis imports from vlab, not from " + arguments.program);
  }
  const std::vector<Output> outputs = check_outputs(arguments.outputs, kFormats);
  if (outputs.size() != 1) {
    throw usage("say where to write: -o head.toml");
  }
  VlabScale scale = arguments.scale;
  scale.like = arguments.like.empty() ? head_model_in(arguments.folder) : head_model(arguments.like);
  scale.width_mm = arguments.width_mm.value_or(scale.width_mm);
  Report report;
  const VlabObject object =
      report.time("read", [&] { return value_of(read_vlab_object(vlab_files_of(arguments.folder))); });
  if (object.contours.size() > 1 && !scale.like && !arguments.width_mm) {
    throw usage(
        "files of VLab state neither size nor veins of a growing head: say --like bellis, sunflower or gerbera, "
        "or --width-mm for a head without veins");
  }
  const Species species = value_of(species_from_vlab(name_of_folder(arguments.folder), object, scale));
  write_output(report, outputs[0].path, write_species(species));
  report.values["species"] = species.name;
  report.values["version"] = kVersion;
  report.values["contours"] = object.contours.size();
  report.values["functions"] = object.functions.size();
  if (arguments.json) {
    print(report.text());
  }
}

}  // namespace

Command add_import(CLI::App& app) {
  CLI::App* command = add_command(app, "import", "Make a species file of another program's model",
                                  "  anthesis import vlab my-head --like sunflower -o head.toml\n"
                                  "  anthesis import vlab ridley -o ridley.toml --width-mm 30");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("PROGRAM", arguments->program, "What the model is from: vlab")->required()->type_name("");
  command
      ->add_option("FOLDER", arguments->folder,
                   "The model's folder: contours (.con, .cset), functions (.func, .fset), knotPositions.dat")
      ->required()
      ->type_name("");
  add_outputs(*command, arguments->outputs, kFormats);
  add_number(*command, "--width-mm", arguments->width_mm, {0.01, 10000.0},
             "Greatest width of the mature receptacle in mm, 20 if left out; not with --like");
  add_number(*command, "--radius-factor", arguments->scale.radius_factor, {0.0, 1000.0, true, false},
             "Factor of the function rho");
  command
      ->add_option("--like", arguments->like,
                   "Whose size, thresholds, landmarks, veins: bellis, sunflower, gerbera; else by the folder's name")
      ->type_name("NAME");
  command->add_flag("--json", arguments->json, "Print JSON");
  return {command, [arguments](Console&) { run(*arguments); }};
}

}  // namespace anthesis::cli
