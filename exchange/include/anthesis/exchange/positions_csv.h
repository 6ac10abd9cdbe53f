#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Places of organs that were measured: a table with the columns x, y and z (or x_mm, y_mm, z_mm) among any others,
/// named in its first line that is not a comment. Fields are parted by commas, semicolons, tabs or spaces; lines that
/// begin with # are comments. Errors name file, line and column. At most 64 MB and 1,000,000 rows.
Expected<std::vector<Vec3>> read_positions(std::string_view text, std::string_view file_name);
Expected<std::vector<Vec3>> load_positions(const std::string& path);

}  // namespace anthesis
