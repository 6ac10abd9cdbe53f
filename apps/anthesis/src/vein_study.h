#pragma once
#include <string>
#include <vector>

#include "head.h"
#include "outputs.h"
#include "vein_pictures.h"

namespace anthesis::cli {

/// A number of a species over a range: "mu_sec=0:1:0.25".
struct Variation {
  std::string key;
  std::vector<double> values;
  bool factor = false;  ///< they multiply what the species has

  /// Of its column.
  std::string name() const { return factor ? key + "_factor" : key; }
};

/// Throws a Failure of usage.
Variation parse_variation(const std::string& text);

/// Grows the head once for each combination of the values, the last number changing fastest; writes one table (.csv)
/// and one sheet of pictures (.png).
void run_study(const HeadArguments& arguments, const std::vector<std::string>& variations, double at,
               const VeinPictureOptions& picture, std::optional<int> columns, const std::vector<Output>& outputs,
               bool json, Console& console);

}  // namespace anthesis::cli
