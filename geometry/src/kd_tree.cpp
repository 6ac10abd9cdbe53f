#include "anthesis/geometry/kd_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace anthesis {
namespace {

constexpr std::uint32_t kLeafSize = 8;

double distance_to(const Box2& box, Vec2 point) {
  const double dx = std::max({box.low.x - point.x, point.x - box.high.x, 0.0});
  const double dy = std::max({box.low.y - point.y, point.y - box.high.y, 0.0});
  return length(Vec2{dx, dy});
}

}  // namespace

KdTree2::KdTree2(std::span<const Vec2> points) : points_(points.begin(), points.end()), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!points_.empty()) {
    build(0, static_cast<std::uint32_t>(points_.size()));
  }
}

void KdTree2::build(std::uint32_t first, std::uint32_t count) {
  Node node;
  node.first = first;
  node.count = count;
  node.box = {points_[order_[first]], points_[order_[first]]};
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Vec2 p = points_[order_[i]];
    node.box.low = {std::min(node.box.low.x, p.x), std::min(node.box.low.y, p.y)};
    node.box.high = {std::max(node.box.high.x, p.x), std::max(node.box.high.y, p.y)};
  }
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back(node);
  if (count <= kLeafSize) {
    return;
  }
  const bool by_x = node.box.high.x - node.box.low.x >= node.box.high.y - node.box.low.y;
  const std::uint32_t half = count / 2;
  std::nth_element(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double ka = by_x ? points_[a].x : points_[a].y;
                     const double kb = by_x ? points_[b].x : points_[b].y;
                     return ka < kb || (ka == kb && a < b);
                   });
  build(first, half);
  nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
  build(first + half, count - half);
}

std::optional<KdTree2::Found> KdTree2::nearest(Vec2 from, const std::function<bool(std::uint32_t)>& accept,
                                               const std::function<bool(const Box2&)>& meets) const {
  std::optional<Found> best;
  if (!nodes_.empty()) {
    search(0, from, accept, meets, best);
  }
  return best;
}

void KdTree2::search(std::uint32_t index, Vec2 from, const std::function<bool(std::uint32_t)>& accept,
                     const std::function<bool(const Box2&)>& meets, std::optional<Found>& best) const {
  const Node& node = nodes_[index];
  if ((best && distance_to(node.box, from) > best->distance) || !meets(node.box)) {
    return;
  }
  if (node.right == 0) {
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const std::uint32_t candidate = order_[i];
      const double distance = length(points_[candidate] - from);
      const bool nearer = !best || distance < best->distance || (distance == best->distance && candidate < best->index);
      if (nearer && accept(candidate)) {
        best = Found{candidate, distance};
      }
    }
    return;
  }
  const std::uint32_t left = index + 1;
  const bool left_first = distance_to(nodes_[left].box, from) <= distance_to(nodes_[node.right].box, from);
  search(left_first ? left : node.right, from, accept, meets, best);
  search(left_first ? node.right : left, from, accept, meets, best);
}

}  // namespace anthesis
