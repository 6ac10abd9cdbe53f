#include <fmt/format.h>

#include "anthesis/exchange/species_file.h"
#include "arguments.h"

namespace anthesis::cli {
namespace {

struct Arguments {
  std::string species;
  bool schema = false;
  bool check = false;
  bool json = false;
};

void list_builtin(bool json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::string lines;
  for (const BuiltinSpecies& builtin : builtin_species()) {
    const Species species = value_of(find_species(std::string(builtin.name)));
    list.push_back({{"name", species.name}, {"latin", species.latin}, {"summary", species.summary}});
    lines += fmt::format("{:<12} {:<20} {}\n", species.name, species.latin, species.summary);
  }
  print(json ? nlohmann::ordered_json{{"species", list}}.dump() + '\n' : lines);
}

void run(const Arguments& arguments) {
  if (arguments.schema) {
    return print(species_schema());
  }
  if (arguments.species.empty()) {
    if (arguments.check) {
      throw usage("--check needs a species or a file");
    }
    return list_builtin(arguments.json);
  }
  const Species species = value_of(find_species(arguments.species));
  if (arguments.json) {
    const auto names = [](const auto& elements) {
      nlohmann::ordered_json result = nlohmann::ordered_json::array();
      for (const auto& element : elements) {
        result.push_back(element.name);
      }
      return result;
    };
    return print(nlohmann::ordered_json{{"name", species.name},
                                        {"latin", species.latin},
                                        {"summary", species.summary},
                                        {"organs", names(species.organs)},
                                        {"pigments", names(species.pigments)},
                                        {"sha256", species.sha256}}
                     .dump() +
                 '\n');
  }
  if (arguments.check) {
    return print(fmt::format("{}: no errors\n", arguments.species));
  }
  for (const BuiltinSpecies& builtin : builtin_species()) {
    if (builtin.name == arguments.species) {
      return print(builtin.text);
    }
  }
  print(write_species(species));
}

}  // namespace

Command add_species(CLI::App& app) {
  CLI::App* command = add_command(app, "species", "List the built-in species, or print one's file",
                                  "  anthesis species\n"
                                  "  anthesis species sunflower > mine.toml\n"
                                  "  anthesis species mine.toml --check\n"
                                  "  anthesis species --schema > species.schema.json");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("SPECIES", arguments->species,
                   "A built-in species, whose file is printed, or a species file, which is printed in canonical form")
      ->type_name("");
  command->add_flag("--check", arguments->check, "Only say whether the file has errors");
  command->add_flag("--schema", arguments->schema, "Print the JSON Schema of species files");
  command->add_flag("--json", arguments->json, "Print JSON");
  return {command, [arguments](Console&) { run(*arguments); }};
}

}  // namespace anthesis::cli
