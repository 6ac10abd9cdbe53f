#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis {

/// An axis-aligned rectangle.
struct Box2 {
  Vec2 low;
  Vec2 high;
};

/// Points of the plane arranged for nearest-neighbour search in a part of the plane. Built in O(n log n).
class KdTree2 {
 public:
  explicit KdTree2(std::span<const Vec2> points);

  struct Found {
    std::uint32_t index = 0;
    double distance = 0.0;
  };

  /// The point nearest to `from` for which `accept(index)` holds; the smaller index where two are equally near.
  /// `meets(box)` may answer false for boxes that hold no acceptable point and are then skipped; it must not answer
  /// false otherwise. O(log n) for a part of the plane that is not almost empty.
  std::optional<Found> nearest(Vec2 from, const std::function<bool(std::uint32_t)>& accept,
                               const std::function<bool(const Box2&)>& meets) const;

 private:
  struct Node {
    Box2 box;
    std::uint32_t first = 0;  ///< into order_
    std::uint32_t count = 0;
    std::uint32_t right = 0;  ///< index of the right child, 0 for a leaf; the left child follows its parent
  };
  void build(std::uint32_t first, std::uint32_t count);
  void search(std::uint32_t node, Vec2 from, const std::function<bool(std::uint32_t)>& accept,
              const std::function<bool(const Box2&)>& meets, std::optional<Found>& best) const;

  std::vector<Vec2> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace anthesis
