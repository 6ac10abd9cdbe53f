#pragma once
#include <span>
#include <string>

#include "anthesis/base/error.h"
#include "anthesis/exchange/glb.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {

/// Where other programs must find the vertices of a GLB written with the same options: a JSON text for the judges in
/// test/judges, computed from Development::at and OrganTemplate::pose and not from the file.
///
/// `frames` are indices of keys, 0 to options.frames - 1 (only 0 for a still plant): between keys, readers differ in
/// how they turn. For each organ and body: its first, middle and last vertex (counted over the mesh's primitives in
/// order) at each frame, in metres with +Y up, or null while it is not born; and `tolerance_m`, what morphing and
/// single precision may move them. Errors: as to_glb; kInvalidParameter for a frame that does not exist.
Expected<std::string> expected_positions_json(const Development& development, const GlbOptions& options,
                                              std::span<const int> frames);

/// The same for a GLB of given canopies, straight from their numbers: `tolerance_m` is then only what a reader's own
/// single-precision transforms may cost. `sampled` are indices into `frames`.
Expected<std::string> expected_positions_json(const Development& development, std::span<const Canopy> frames,
                                              const GlbOptions& options, std::span<const int> sampled);

}  // namespace anthesis
