#include "growth.h"

#include "anthesis/base/version.h"
#include "anthesis/exchange/species_file.h"

namespace anthesis::cli {

Species find_plant(const std::string& name_or_path) {
  Expected<Species> species = find_species(name_or_path);
  if (!species && species.error().where.empty()) {
    throw usage(species.error().message);
  }
  return value_of(std::move(species));
}

Development grow(const GrowthArguments& arguments, const Species& species, Report& report, const Progress& progress) {
  const GrowthOptions options{.seed = arguments.seed, .detail = arguments.detail};
  return value_of(report.time("grow", [&] { return Development::grow(species, options, progress); }));
}

void describe_plant(const Development& development, double time, Report& report) {
  const Canopy canopy = report.time("grow", [&] { return development.at(time); });
  nlohmann::ordered_json organs = nlohmann::ordered_json::object();
  for (const OrganKind& kind : development.species().organs) {
    organs[kind.name] = 0;
  }
  std::size_t triangles = 0;
  for (const OrganState& state : canopy.organs) {
    const Organ& organ = development.organs()[state.id.value - 1];
    nlohmann::ordered_json& count = organs[development.species().organs[organ.kind].name];
    count = count.get<std::size_t>() + 1;
    triangles += development.templates()[organ.template_index].triangles().size();
  }
  for (const Body& body : canopy.bodies) {
    triangles += body.mesh.triangles.size();
  }
  report.values["species"] = development.species().name;
  report.values["seed"] = development.options().seed;
  report.values["version"] = kVersion;
  report.values["organs"] = organs;
  report.values["frames"] = 1;
  report.values["triangles"] = triangles;
  report.values["crossings"] = nullptr;  // not checked
}

}  // namespace anthesis::cli
