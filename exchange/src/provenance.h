#pragma once
#include <string>
#include <utility>
#include <vector>

#include "anthesis/inflorescence/development.h"

namespace anthesis::detail {

/// "Anthesis 0.1.0"
std::string generator();

/// What a file was made from, as (key, value) in the order it is written: version, species, latin name, seed, detail,
/// and the hash of the species file where there is one; `resolved` adds that collisions are. No time of writing: equal
/// input gives equal bytes.
std::vector<std::pair<std::string, std::string>> provenance(const Development& development, bool resolved = false);

}  // namespace anthesis::detail
