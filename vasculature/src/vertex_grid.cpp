#include "vertex_grid.h"

namespace anthesis::veins {

void VertexGrid::build(std::span<const Vec3> positions, std::span<const double> values,
                       std::vector<std::uint32_t> indices, double least_cell) {
  items_.clear();
  cells_.clear();
  blocks_.clear();
  if (indices.empty()) {
    return;
  }
  Vec3 low = positions[indices.front()];
  Vec3 high = low;
  for (const std::uint32_t i : indices) {
    const Vec3 p = positions[i];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 size = high - low;
  low_ = low;
  cell_ = std::max({least_cell, size.x / kMostCellsAcross, size.y / kMostCellsAcross, size.z / kMostCellsAcross});
  per_cell_ = 1.0 / cell_;
  const double extents[3] = {size.x, size.y, size.z};
  for (int axis = 0; axis < 3; ++axis) {
    const int cells = std::clamp(static_cast<int>(extents[axis] * per_cell_) + 1, 1, kMostCellsAcross);
    across_[axis] = (cells + 3) / 4 * 4;
  }
  // Counting sort; within a cell the order of indices stays.
  starts_.assign(static_cast<std::size_t>(across_[0]) * across_[1] * across_[2] + 1, 0);
  std::vector<std::uint32_t> cell_of(indices.size());
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const Vec3 d = positions[indices[k]] - low_;
    cell_of[k] = id(clamped(d.x, 0), clamped(d.y, 1), clamped(d.z, 2));
    ++starts_[cell_of[k] + 1];
  }
  for (std::size_t c = 1; c < starts_.size(); ++c) {
    starts_[c] += starts_[c - 1];
  }
  items_.resize(indices.size());
  for (std::size_t k = indices.size(); k-- > 0;) {
    items_[--starts_[cell_of[k] + 1]] = {positions[indices[k]], indices[k]};
  }
  // Each start has moved to the place before it: shift back.
  starts_.erase(starts_.begin());
  starts_.push_back(static_cast<std::uint32_t>(indices.size()));

  std::uint32_t block = kNone;
  for (std::uint32_t c = 0; c + 1 < starts_.size(); ++c) {
    if (starts_[c] == starts_[c + 1]) {
      continue;
    }
    Range range{items_[starts_[c]].position, items_[starts_[c]].position, std::numeric_limits<double>::infinity(),
                starts_[c], starts_[c + 1]};
    for (std::uint32_t i = range.first; i < range.end; ++i) {
      const Vec3 p = items_[i].position;
      range.low = {std::min(range.low.x, p.x), std::min(range.low.y, p.y), std::min(range.low.z, p.z)};
      range.high = {std::max(range.high.x, p.x), std::max(range.high.y, p.y), std::max(range.high.z, p.z)};
      range.least = std::min(range.least, values.empty() ? 0.0 : values[items_[i].index]);
    }
    const auto number = static_cast<std::uint32_t>(cells_.size());
    if (c / 64 != block) {
      block = c / 64;
      blocks_.push_back({range.low, range.high, range.least, number, number});
    }
    Range& whole = blocks_.back();
    whole.low = {std::min(whole.low.x, range.low.x), std::min(whole.low.y, range.low.y),
                 std::min(whole.low.z, range.low.z)};
    whole.high = {std::max(whole.high.x, range.high.x), std::max(whole.high.y, range.high.y),
                  std::max(whole.high.z, range.high.z)};
    whole.least = std::min(whole.least, range.least);
    whole.end = number + 1;
    cells_.push_back(range);
  }
}

std::uint32_t VertexGrid::nearest(Vec3 p) const {
  if (items_.empty()) {
    return kNone;
  }
  const Vec3 d = p - low_;
  const int centre[3] = {clamped(d.x, 0), clamped(d.y, 1), clamped(d.z, 2)};
  const int most = std::max({across_[0], across_[1], across_[2]});
  std::uint32_t found = kNone;
  double best = std::numeric_limits<double>::infinity();
  // Shell after shell of cells; all vertices of shell k + 1 and beyond are farther than k cells.
  for (int k = 0; k < most; ++k) {
    const double reach = (k - 1) * cell_;
    if (k >= 1 && best <= reach * reach) {
      break;
    }
    const int z0 = std::max(centre[2] - k, 0), z1 = std::min(centre[2] + k, across_[2] - 1);
    const int y0 = std::max(centre[1] - k, 0), y1 = std::min(centre[1] + k, across_[1] - 1);
    const int x0 = std::max(centre[0] - k, 0), x1 = std::min(centre[0] + k, across_[0] - 1);
    for (int z = z0; z <= z1; ++z) {
      for (int y = y0; y <= y1; ++y) {
        const bool whole_row = std::abs(z - centre[2]) == k || std::abs(y - centre[1]) == k;
        for (int x = x0; x <= x1; ++x) {
          if (!whole_row && x > centre[0] - k && x < centre[0] + k) {
            x = centre[0] + k - 1;  // skip the inside of the shell
            continue;
          }
          const std::uint32_t cell = id(x, y, z);
          for (std::uint32_t i = starts_[cell]; i < starts_[cell + 1]; ++i) {
            const Vec3 away = items_[i].position - p;
            const double square = dot(away, away);
            if (square < best || (square == best && items_[i].index < found)) {
              best = square;
              found = items_[i].index;
            }
          }
        }
      }
    }
  }
  return found;
}

}  // namespace anthesis::veins
