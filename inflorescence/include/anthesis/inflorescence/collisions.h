#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/contact/growing_sheets.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {

struct CollisionOptions {
  int steps = 96;          ///< of development from 0 to 1 that growth is followed in, 1 to 10000
  GrowingOptions growing;  ///< of each step
  std::string checkpoint;  ///< folder that the run is saved into after each step; empty: none
  bool resume = false;     ///< go on from what is in `checkpoint`, if it is of the same run
};

/// What it took to keep the organs apart.
struct CollisionReport {
  int steps = 0;
  std::uint64_t passes = 0;
  std::uint64_t contacts = 0;
  std::uint64_t triangles = 0;  ///< of the last frame
  double residual_mm = 0.0;     ///< longest move of a vertex in the last pass of a step: largest over the steps
};

/// A development in which organs give way to one another.
struct AccommodatedDevelopment {
  std::vector<Canopy> frames;  ///< one for each time asked for, all organs with their `deformed_mm`
  CollisionReport report;
};

/// Grows a plant with collisions (O16 section 3) and shows it at `times`, ascending, in [0, 1].
///
/// The plant is followed from time 0 in `steps` equal steps, whatever times are asked for: a frame between two steps is
/// a branch off the way that leaves no trace, so frames do not depend on one another.
/// Organs arise shrunk about their attachment, where they cross nothing, and grow into the room there is.
///
/// Every frame is free of crossings: all its coordinates are single-precision numbers on a lattice of 2^-14 mm, and
/// exactly these have been audited (find_crossings). A frame that fails is kCrossing with the pairs named; it would be
/// a fault of this program. Errors: kCrossing also for organs that find no place to start or cross themselves;
/// kTooLarge for plants that reach beyond 1 m; kInvalidParameter for times and options; kIo for the checkpoint;
/// kCancelled.
///
/// Equal developments, times and options give equal frames, for any number of threads, interrupted or not.
Expected<AccommodatedDevelopment> resolve_collisions(const Development& development, std::span<const double> times,
                                                     const CollisionOptions& options, const Progress& progress = {});

/// Removes what a run saved in the folder, and the folder if nothing else is in it: when its result is safe.
void remove_checkpoint(const std::string& folder);

/// The surfaces of a canopy as one mesh: organs by id, then bodies; and which organ each triangle belongs to.
struct CanopySurface {
  std::vector<Vec3> positions_mm;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> owner;  ///< of each triangle: index into the canopy's organs, then its bodies
};
CanopySurface surface_of(const Development& development, const Canopy& canopy);

/// "ray_floret.12", or "receptacle": the name in every file of an owner of CanopySurface.
std::string owner_name(const Development& development, const Canopy& canopy, std::uint32_t owner);

}  // namespace anthesis
