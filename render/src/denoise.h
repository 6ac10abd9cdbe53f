#pragma once
#include "anthesis/base/progress.h"
#include "film.h"

namespace anthesis {

/// Takes the noise out of `film.light` and `film.shadow`, guided by what the paths met first. See docs/rendering.md.
/// Returns false if `progress` (stage "noise") asked to stop.
bool denoise(Film& film, int samples, const Progress& progress);

}  // namespace anthesis
