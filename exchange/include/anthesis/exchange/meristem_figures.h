#pragma once
#include <string>

#include "anthesis/base/error.h"

namespace anthesis {

/// Drawings of what the models of growing meristems do; see docs/meristem-dynamics.md.
enum class MeristemFigure {
  kModes,        ///< centripetal and divergent fractionation and segregation, early and late, by age (O16 fig. 11)
  kSelfSimilar,  ///< elements that become meristems of their own, on a flat meristem that grows evenly (O16 fig. 12)
  kHierarchy,    ///< cones on a cone, each with its first element outwards (O16 fig. 13)
};

/// The figure as SVG. About 0.1 s.
Expected<std::string> meristem_figure_svg(MeristemFigure figure);

}  // namespace anthesis
