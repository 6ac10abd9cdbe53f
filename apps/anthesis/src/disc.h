#pragma once
#include <optional>
#include <string>
#include <vector>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/vogel.h"
#include "arguments.h"

namespace anthesis::cli {

/// Vogel's disc and the cone rule on it (O16 section 5, figs. 15 and 16).
struct DiscArguments {
  std::optional<int> vogel;
  double divergence_deg = math::degrees(kGoldenAngleRad);
  double cone_deg = 75.0;
  std::string sweep;

  void add_to(CLI::App& app);
  bool wanted() const { return vogel || !sweep.empty(); }
};

/// What to do with the disc.
struct DiscJob {
  const std::vector<std::string>& outputs;
  int threads = 0;
  bool json = false;
};

void run_disc(const DiscArguments& arguments, const DiscJob& job, Console& console);

}  // namespace anthesis::cli
