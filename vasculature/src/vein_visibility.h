#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis::veins {

/// Goes through the vertices `candidates` that can be seen from `p`, nearest first, until visit(index, distance) says
/// no. A vertex at distance d shields a cone of width min(A d / d_1, 2 pi) about its direction, d_1 the distance of the
/// nearest and A `angle_rad`; it is seen if its cone meets none of those seen before. Equally near ones by index.
void visit_visible(Vec3 p, std::span<const Vec3> positions, std::span<const std::uint32_t> candidates, double angle_rad,
                   const std::function<bool(std::uint32_t, double)>& visit);

}  // namespace anthesis::veins
