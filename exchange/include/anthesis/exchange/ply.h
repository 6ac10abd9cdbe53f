#pragma once
#include <string>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {

/// The plant at `time` as one binary little-endian PLY mesh: millimetres, +z up along the axis of the plant.
///
/// Each vertex has x y z, nx ny nz, red green blue (sRGB, with the organ's own variation), `organ` (its id; 0: no organ
/// but the receptacle or the stem) and `kind` (index into the kinds that the header's comments list; -1: none).
/// Errors: kInvalidParameter for a time outside [0, 1], kTooLarge above 50 million vertices, kCancelled.
Expected<std::string> to_ply(const Development& development, double time, const Progress& progress = {});

/// The same for a canopy of the development that was computed beforehand. Vertices of organs bent by touching are
/// stated exactly, and so are those of bodies that are exact in single precision; a comment then says
/// "collisions: resolved". Errors: also kInvalidParameter for a canopy that is not one of this development.
Expected<std::string> to_ply(const Development& development, const Canopy& canopy, const Progress& progress = {});

}  // namespace anthesis
