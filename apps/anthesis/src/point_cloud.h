#pragma once
#include <string>

#include "anthesis/inflorescence/development.h"

namespace anthesis::cli {

/// The organs at `time` as the points of a PLY text: place, normal, id, kind and area.
std::string point_cloud_ply(const Development& development, double time);

}  // namespace anthesis::cli
