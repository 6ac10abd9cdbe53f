#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "anthesis/base/error.h"
#include "anthesis/inflorescence/species.h"

namespace anthesis {

/// Species files are TOML 1.0; docs/species-files.md shows one. One set of tables reads them, checks every range,
/// writes them back and makes the JSON Schema, so that the four cannot disagree.

inline constexpr std::size_t kSpeciesFileLimit = 1 << 20;  ///< bytes

/// The species that `text` states, checked as a whole (check(Species) finds nothing), with the SHA-256 of `text`.
///
/// One error at a time, with its place: "daisy.toml:14:12: head.interval must be > 0 and at most 1, got -0.4". Unknown
/// keys are errors, with the nearest known key. Bounded in time and memory for any bytes: more than kSpeciesFileLimit
/// of them is kTooLarge, nesting beyond 32 values or 16 parts of a key is kParse.
Expected<Species> read_species(std::string_view text, std::string_view file_name);

/// The species in a file.
Expected<Species> load_species(const std::string& path);

/// A species file that is part of the library.
struct BuiltinSpecies {
  std::string_view name;  ///< "sunflower"
  std::string_view text;  ///< the bytes of species/sunflower.toml
};

/// By name.
std::span<const BuiltinSpecies> builtin_species();

/// What people mean by SPECIES: the name of a built-in species, or the path of a file if it contains '/', ends with
/// ".toml" or exists. Another word is kUnknownParameter, with the nearest built-in name.
Expected<Species> find_species(const std::string& name_or_path);

/// JSON Schema (draft 7) of species files, for editors: keys, meaning, units, ranges, defaults.
std::string species_schema();

/// `species` as the text of a species file, in canonical form: keys in the order of the tables, values that equal their
/// default left out. Reading it gives the same species again, apart from `sha256`, and apart from colours, which are
/// rounded to "#rrggbb". Precondition: check(species) finds nothing.
std::string write_species(const Species& species);

}  // namespace anthesis
