#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anthesis/inflorescence/collisions.h"
#include "arguments.h"

namespace anthesis::cli {

/// The flags that say how organs give way to one another.
struct CollisionArguments {
  std::optional<bool> resolve;  ///< absent: as the species has it
  int steps = CollisionOptions().steps;
  std::string checkpoint;
  bool resume = false;

  /// `note` ends the help of --collision-steps.
  void add_to(CLI::App& app, const std::string& note = "");

  bool wanted(const Species& species) const { return resolve.value_or(species.collisions); }

  /// Refuses flags that do not go together. `resolving`: the command will look for collisions.
  void check(bool resolving) const;

  /// Removes the checkpoint: everything is written.
  void forget() const;
};

/// The plant at `times`, ascending, its organs kept apart; all in one run. Reports what it took.
std::vector<Canopy> resolve(const Development& development, std::span<const double> times,
                            const CollisionArguments& arguments, Report& report, const Progress& progress);

/// The plant at `times` as its species states it, organs in one another's way or not.
std::vector<Canopy> canopies_at(const Development& development, std::span<const double> times);

/// `count` times evenly over the development, first and last included; one alone is the last.
std::vector<double> even_times(int count);

}  // namespace anthesis::cli
