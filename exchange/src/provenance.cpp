#include "provenance.h"

#include "anthesis/base/version.h"
#include "text.h"

namespace anthesis::detail {

std::string generator() {
  return std::string("Anthesis ") + kVersion;
}

std::vector<std::pair<std::string, std::string>> provenance(const Development& development, bool resolved) {
  const Species& species = development.species();
  const GrowthOptions& options = development.options();
  std::vector<std::pair<std::string, std::string>> lines = {{"version", kVersion}, {"species", one_line(species.name)}};
  if (!species.latin.empty()) {
    lines.emplace_back("latin", one_line(species.latin));
  }
  lines.emplace_back("seed", std::to_string(options.seed));
  lines.emplace_back("detail", to_text(options.detail));
  if (!species.sha256.empty()) {
    lines.emplace_back("species_sha256", one_line(species.sha256));
  }
  if (resolved) {
    lines.emplace_back("collisions", "resolved");
  }
  return lines;
}

}  // namespace anthesis::detail
