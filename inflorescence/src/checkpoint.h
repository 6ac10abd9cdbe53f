#pragma once
#include <string>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/inflorescence/collisions.h"

namespace anthesis::detail {

/// How far a run with collisions has come: everything that its future depends on, and the frames it has seen.
struct Checkpoint {
  int next_step = 0;                       ///< 0: nothing done yet
  std::vector<std::vector<Vec3>> seen_mm;  ///< positions of all sheets in each frame so far
  GrowingSheets::Snapshot snapshot;
  CollisionReport report;
};

/// Saves a run to the folder, which is made if need be. Frames are written once each, so the first `frames_saved` are
/// left alone; the state appears whole, last. `key` names the run: species, seed, options, times, version.
/// Errors: kIo.
std::optional<Error> save_checkpoint(const std::string& folder, const std::string& key, const Checkpoint& checkpoint,
                                     std::size_t frames_saved);

/// What the folder holds; next_step 0 if there is nothing. Errors: kInvalidParameter for another run's checkpoint,
/// kParse for damaged files, kIo.
Expected<Checkpoint> load_checkpoint(const std::string& folder, const std::string& key);

/// Whether the folder holds a checkpoint of any run.
bool has_checkpoint(const std::string& folder);

/// Removes the files that save_checkpoint wrote, the state before its frames, so that a run killed meanwhile can be
/// started afresh; and the folder if nothing else is in it.
void remove_checkpoint(const std::string& folder);

}  // namespace anthesis::detail
