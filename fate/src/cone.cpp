#include "anthesis/fate/cone.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/geometry/kd_tree.h"

namespace anthesis {

std::vector<double> nearest_in_cone_mm(std::span<const Vec2> florets_mm, Vec2 centre_mm, double cone_rad) {
  const KdTree2 tree(florets_mm);
  const double sine = math::sin(cone_rad);
  const double cosine = math::cos(cone_rad);
  std::vector<double> distance(florets_mm.size(), std::numeric_limits<double>::infinity());
  parallel_for(florets_mm.size(), [&](std::size_t i) {
    const Vec2 apex = florets_mm[i];
    const Vec2 axis = normalized(apex - centre_mm);
    const bool everywhere = axis == Vec2{};
    const auto accept = [&](std::uint32_t j) {
      if (j == i) {
        return false;
      }
      const Vec2 to = florets_mm[j] - apex;
      return everywhere || dot(to, axis) > cosine * length(to);
    };
    // Inner normals of the cone's two sides. A cone up to a half plane is what both sides allow, a wider one what
    // either allows; a rectangle whose four corners a side forbids is forbidden by it whole.
    const Vec2 left{sine * axis.x + cosine * axis.y, sine * axis.y - cosine * axis.x};
    const Vec2 right{sine * axis.x - cosine * axis.y, sine * axis.y + cosine * axis.x};
    const auto meets = [&](const Box2& box) {
      if (everywhere) {
        return true;
      }
      const auto allowed = [&](Vec2 normal) {
        const Vec2 farthest{normal.x > 0.0 ? box.high.x : box.low.x, normal.y > 0.0 ? box.high.y : box.low.y};
        const Vec2 reach = farthest - apex;
        return dot(reach, normal) >= -1e-12 * (std::abs(reach.x) + std::abs(reach.y));
      };
      return cosine >= 0.0 ? allowed(left) && allowed(right) : allowed(left) || allowed(right);
    };
    if (const auto found = tree.nearest(apex, accept, meets)) {
      distance[i] = found->distance;
    }
  });
  return distance;
}

std::size_t count_with_room(std::span<const Vec2> florets_mm, Vec2 centre_mm, double cone_rad) {
  const std::vector<double> distance = nearest_in_cone_mm(florets_mm, centre_mm, cone_rad);
  return static_cast<std::size_t>(
      std::count(distance.begin(), distance.end(), std::numeric_limits<double>::infinity()));
}

}  // namespace anthesis
