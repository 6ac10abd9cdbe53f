#pragma once
#include <span>
#include <string>

#include "anthesis/phyllotaxis/parastichies.h"

namespace anthesis {

// What analyse_parastichies() found, as files. docs/parastichies.md says what every column and key means. Numbers read
// back as the same doubles, with a point whatever the locale; NaN is an empty field, null in JSON.

/// What a file is called and measured by.
struct ParastichyFile {
  std::string title;        ///< "sunflower (Helianthus annuus)"
  std::string caption;      ///< how the pattern was made; a comment line, or small print under a drawing
  double length_mm = 0.0;   ///< of the whole profile: `from` and `to` are shares of it; 0: up to the last organ
  bool first_is_1 = false;  ///< organs are numbered from 1, as in other files of a species; else from 0
};

/// One row a region, from the apex outwards.
std::string parastichy_regions_csv(const Parastichies& found, const ParastichyFile& file);

/// One row an organ, in the order given to the analysis.
std::string parastichy_organs_csv(const Parastichies& found, std::span<const PatternOrgan> organs,
                                  const ParastichyFile& file);

/// One object; its list `parastichies` of {from, to, families, ...} along the surface has empty `families` where there
/// is no consistent pair.
std::string parastichies_json(const Parastichies& found, const ParastichyFile& file);

enum class ParastichyView {
  kPolar,     ///< apex in the middle, distance from it measured along the surface
  kUnrolled,  ///< azimuth to the right, apex at the top, angles as they are on the surface
};

/// The visible pair drawn through the organs, one colour for each turn, grey where irregular; dislocations ringed.
std::string parastichies_svg(const Parastichies& found, std::span<const PatternOrgan> organs, ParastichyView view,
                             const ParastichyFile& file);

}  // namespace anthesis
