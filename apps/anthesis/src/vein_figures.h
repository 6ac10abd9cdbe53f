#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "anthesis/vasculature/vein_measures.h"

namespace anthesis::cli {

/// Columns and values of a row.
using VeinFigures = std::vector<std::pair<std::string, std::string>>;

/// What stands in a table for one head at one moment: what is there by then, lengths in mm, means over the strands that
/// reach the ring.
VeinFigures figures_of(const Vasculature& veins, std::span<const VeinPrimordium> primordia,
                       const VasculatureMeasures& measures);

}  // namespace anthesis::cli
