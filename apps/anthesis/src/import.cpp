#include <array>
#include <cctype>
#include <filesystem>

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
  bool json = false;
};

/// A species' name out of a folder's: letters, digits, - and _.
std::string name_of(const std::string& folder) {
  std::filesystem::path path = std::filesystem::path(folder).lexically_normal();
  std::string name = (path.has_filename() ? path : path.parent_path()).filename().string().substr(0, 64);
  for (char& c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    c = plain ? c : '-';
  }
  return name.empty() || name == "." || name == "-" ? "head" : name;
}

void run(const Arguments& arguments) {
  if (arguments.program != "vlab") {
    throw usage("anthesis imports from vlab, not from " + arguments.program);
  }
  const std::vector<Output> outputs = check_outputs(arguments.outputs, kFormats);
  if (outputs.size() != 1) {
    throw usage("say where to write: -o head.toml");
  }
  Report report;
  const VlabObject object =
      report.time("read", [&] { return value_of(read_vlab_object(vlab_files_of(arguments.folder))); });
  const Species species = value_of(species_from_vlab(name_of(arguments.folder), object, arguments.scale));
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
                                  "  anthesis import vlab my-head -o head.toml\n"
                                  "  anthesis import vlab ridley -o ridley.toml --width-mm 30");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("PROGRAM", arguments->program, "What the model is from: vlab")->required()->type_name("");
  command
      ->add_option("FOLDER", arguments->folder,
                   "The model's folder: contours (.con, .cset), functions (.func, .fset), primordia (.prims), knots")
      ->required()
      ->type_name("");
  add_outputs(*command, arguments->outputs, kFormats);
  add_number(*command, "--width-mm", arguments->scale.width_mm, {0.01, 10000.0},
             "Greatest width of the mature receptacle in mm");
  add_number(*command, "--radius-factor", arguments->scale.radius_factor, {0.0, 1000.0, true, false},
             "Factor of the function rho");
  command->add_flag("--json", arguments->json, "Print JSON");
  return {command, [arguments](Console&) { run(*arguments); }};
}

}  // namespace anthesis::cli
