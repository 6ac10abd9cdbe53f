#pragma once
#include <span>
#include <string>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {

/// A point cache (PC2, version 1) that moves the vertices of to_obj(development, frames.back(), ...): one sample for
/// each canopy, from frame 0 on, one frame apart, in the OBJ's vertex order. Millimetres, +z up, single precision;
/// vertices of bent organs are the given numbers to the last bit. Before its first frame an organ is a point at its
/// place of birth.
///
/// Errors: kInvalidParameter for no frames, times that do not ascend, or canopies that are not of this development;
/// kTooLarge above 2000 frames, 50 million vertices or 2 GiB; kCancelled.
Expected<std::string> to_pc2(const Development& development, std::span<const Canopy> frames,
                             const Progress& progress = {});

}  // namespace anthesis
