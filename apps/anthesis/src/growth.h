#pragma once
#include <string>

#include "anthesis/inflorescence/development.h"
#include "arguments.h"

namespace anthesis::cli {

/// The species that SPECIES names. A word that names nothing is a mistake in the command, not in data.
Species find_plant(const std::string& name_or_path);

/// The plant, grown within the flags' seed and detail.
Development grow(const GrowthArguments& arguments, const Species& species, Report& report, const Progress& progress);

/// Fills in what --json says of every plant: species, seed, version, organs by kind, triangles, crossings.
void describe_plant(const Development& development, double time, Report& report);

}  // namespace anthesis::cli
