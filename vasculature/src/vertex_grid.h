#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis::veins {

/// Vertices sorted into the cells of a box, cells into blocks of 4 by 4 by 4. Each cell and block that is not empty
/// knows the space its vertices take and the least of a value they have. Answers do not depend on the cells.
class VertexGrid {
 public:
  static constexpr int kMostCellsAcross = 48;  // a multiple of 4

  /// Builds in O(vertices + cells). `values` may be empty. Indices ascend.
  void build(std::span<const Vec3> positions, std::span<const double> values, std::vector<std::uint32_t> indices,
             double least_cell);

  bool empty() const { return items_.empty(); }

  /// Calls visit(index, squared distance) for all vertices within `radius` of `p`, in no particular order.
  template <class Visit>
  void within(Vec3 p, double radius, Visit visit) const;

  /// The nearest vertex, the smaller index of equally near ones; kNone if there is none.
  std::uint32_t nearest(Vec3 p) const;

  /// Calls visit(index) for every vertex of each cell for which bound(least squared distance from p, least value) is
  /// not above limit(), asking anew for each block and cell.
  template <class Bound, class Limit, class Visit>
  void below(Vec3 p, Bound bound, Limit limit, Visit visit) const;

  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

 private:
  struct Range {
    Vec3 low;
    Vec3 high;
    double least = 0.0;
    std::uint32_t first = 0;  ///< of items_ for cells, of cells_ for blocks
    std::uint32_t end = 0;
  };
  struct Item {
    Vec3 position;
    std::uint32_t index;
  };

  static double square_from(Vec3 p, const Range& range) {
    const double x = std::max({range.low.x - p.x, p.x - range.high.x, 0.0});
    const double y = std::max({range.low.y - p.y, p.y - range.high.y, 0.0});
    const double z = std::max({range.low.z - p.z, p.z - range.high.z, 0.0});
    return x * x + y * y + z * z;
  }
  int clamped(double offset, int axis) const {
    const double cell = offset * per_cell_;
    return cell <= 0.0 ? 0 : cell >= across_[axis] - 1 ? across_[axis] - 1 : static_cast<int>(cell);
  }
  std::uint32_t id(int x, int y, int z) const {
    const int block = ((z >> 2) * (across_[1] >> 2) + (y >> 2)) * (across_[0] >> 2) + (x >> 2);
    return static_cast<std::uint32_t>(block * 64 + (z & 3) * 16 + (y & 3) * 4 + (x & 3));
  }

  Vec3 low_;
  double cell_ = 1.0;
  double per_cell_ = 1.0;
  int across_[3] = {4, 4, 4};
  std::vector<std::uint32_t> starts_;  ///< of each cell in items_, and the end
  std::vector<Item> items_;
  std::vector<Range> cells_;   ///< not empty, by id
  std::vector<Range> blocks_;  ///< not empty, by id
};

template <class Visit>
void VertexGrid::within(Vec3 p, double radius, Visit visit) const {
  if (items_.empty()) {
    return;
  }
  const Vec3 d = p - low_;
  const int x0 = clamped(d.x - radius, 0), x1 = clamped(d.x + radius, 0);
  const int y0 = clamped(d.y - radius, 1), y1 = clamped(d.y + radius, 1);
  const int z0 = clamped(d.z - radius, 2), z1 = clamped(d.z + radius, 2);
  for (int z = z0; z <= z1; ++z) {
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const std::uint32_t cell = id(x, y, z);
        for (std::uint32_t i = starts_[cell]; i < starts_[cell + 1]; ++i) {
          const Vec3 away = items_[i].position - p;
          const double square = dot(away, away);
          if (square <= radius * radius) {
            visit(items_[i].index, square);
          }
        }
      }
    }
  }
}

template <class Bound, class Limit, class Visit>
void VertexGrid::below(Vec3 p, Bound bound, Limit limit, Visit visit) const {
  for (const Range& block : blocks_) {
    if (bound(square_from(p, block), block.least) > limit()) {
      continue;
    }
    for (std::uint32_t c = block.first; c < block.end; ++c) {
      const Range& cell = cells_[c];
      if (bound(square_from(p, cell), cell.least) > limit()) {
        continue;
      }
      for (std::uint32_t i = cell.first; i < cell.end; ++i) {
        visit(items_[i].index);
      }
    }
  }
}

}  // namespace anthesis::veins
