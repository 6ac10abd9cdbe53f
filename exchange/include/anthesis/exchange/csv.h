#pragma once
#include <string>

#include "anthesis/base/error.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {

/// A tidy table of the organs at `time`, one row for each organ born by then, by id.
///
/// Lines that begin with `#` say what made it (version, species, seed, hash); then a line of column names:
/// id, parent, kind, birth, age, x_mm, y_mm, z_mm, nx, ny, nz, divergence_deg, azimuth_deg, s, radius_mm, area_mm2,
/// size, stage. docs/files.md says what each means. Numbers read back as the same doubles, with a point whatever the
/// locale. Errors: kInvalidParameter for a time outside [0, 1].
Expected<std::string> organs_csv(const Development& development, double time);

}  // namespace anthesis
