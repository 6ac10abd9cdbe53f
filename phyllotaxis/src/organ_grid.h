#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/base/math.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Spheres about the z axis, found by place in cylindrical coordinates: the (radius, height) half plane is cut into
/// squares, the ring of each square into boxes as wide as they are high. Spheres of a kind, up to a factor of two in
/// radius, share a level whose boxes are as wide as their contact distance, so that a level has a handful of
/// candidates.
///
/// Rings take memory when their first sphere comes: about 4 bytes a box and 40 a sphere.
class OrganGrid {
 public:
  struct Entry {
    double x;
    double y;
    double z;
    double radius_mm;
  };

  /// `low`, `high`: bounds of all (radius, height). Spheres near `usual_radius_mm` get boxes to measure; `factor` times
  /// the sum of two radii is the distance that counts.
  OrganGrid(Vec2 low, Vec2 high, double usual_radius_mm, double factor)
      : low_(low), high_(high), usual_(usual_radius_mm), factor_(factor) {}

  /// Spheres are numbered in the order of their insertion.
  void insert(Vec2 position, double azimuth_rad, Vec3 centre, double radius_mm) {
    Level& level = level_for(radius_mm);
    const int a = level.column(position.x);
    const int b = level.row(position.y);
    std::int32_t& ring = level.rings[static_cast<std::size_t>(b) * level.columns + a];
    const int boxes = boxes_of(a);
    if (ring < 0) {
      ring = static_cast<std::int32_t>(level.boxes.size());
      level.boxes.resize(level.boxes.size() + boxes);
    }
    const int box = std::min(static_cast<int>(azimuth_rad * (boxes / math::kTurnRad)), boxes - 1);
    const auto index = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back({centre.x, centre.y, centre.z, radius_mm});
    Box& home = level.boxes[ring + box];
    if (home.first == kNone) {
      home.first = index;
    } else if (home.second == kNone) {
      home.second = index;
    } else {
      others_.push_back({index, home.others});
      home.others = static_cast<std::uint32_t>(others_.size() - 1);
    }
  }

  const Entry& operator[](std::uint32_t index) const { return entries_[index]; }

  /// The spheres that may be nearer than factor * (their radius + own_mm) to the point at `position` and azimuth, and
  /// others nearby. Valid until the next call. The order is that of boxes, the same everywhere.
  std::span<const std::uint32_t> near(Vec2 position, double azimuth_rad, double own_mm) {
    constexpr double kPad = 1.0 + 1e-7;  // contacts are looked for a little further, and rounding must not lose one
    found_ = 0;
    for (const Level& level : levels_) {
      const double reach = kPad * factor_ * (own_mm + level.largest_mm);
      const int a_first = level.column(position.x - reach);
      const int a_last = level.column(position.x + reach);
      const int b_first = level.row(position.y - reach);
      const int b_last = level.row(position.y + reach);
      for (int b = b_first; b <= b_last; ++b) {
        const std::int32_t* rings = level.rings.data() + static_cast<std::size_t>(b) * level.columns;
        // How far the square is off in the half plane.
        const double low_y = level.low_y + b * level.size;
        const double dy = std::max({low_y - position.y, position.y - low_y - level.size, 0.0});
        for (int a = a_first; a <= a_last; ++a) {
          if (rings[a] < 0) {
            continue;
          }
          const double inner = a * level.size;
          const double dx = std::max({inner - position.x, position.x - inner - level.size, 0.0});
          const double rest2 = reach * reach - dx * dx - dy * dy;
          if (rest2 > 0.0) {
            collect(level, rings[a], boxes_of(a), position.x * inner, azimuth_rad, rest2);
          }
        }
      }
    }
    return {buffer_.data(), found_};
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr double kMostSquares = 4e6;  ///< of a level; beyond, squares get larger and boxes hold more

  static constexpr double kMostColumns = 1 << 18;  ///< so that a ring takes no more than 20 MB

  struct Box {
    std::uint32_t first = kNone;
    std::uint32_t second = kNone;
    std::uint32_t others = kNone;  ///< the last of a list in others_
  };
  struct Other {
    std::uint32_t index;
    std::uint32_t next;
  };
  struct Level {
    int power = 0;
    double largest_mm = 0.0;
    double size = 1.0;  ///< of a square
    double inverse_size = 1.0;
    double low_y = 0.0;
    int columns = 1;
    int rows = 1;
    std::vector<std::int32_t> rings;  ///< first box of each square's ring, -1 where no sphere is
    std::vector<Box> boxes;

    int column(double radius) const { return clamp(radius * inverse_size, columns); }
    int row(double height) const { return clamp((height - low_y) * inverse_size, rows); }
    static int clamp(double cell, int count) {
      return cell <= 0.0 ? 0 : cell >= count ? count - 1 : static_cast<int>(cell);
    }
  };

  /// Boxes of the rings in one column: at the column's outer edge they are as wide as high, or a little wider.
  static int boxes_of(int column) { return static_cast<int>(math::kTurnRad * (column + 1)); }

  /// Adds the spheres of a ring within a distance. Two points at radii p and q and azimuths D apart are
  /// sqrt(in-plane distance^2 + 4 p q sin^2(D / 2)) apart; `rest2` is what the in-plane distance leaves, `product` at
  /// most p q.
  void collect(const Level& level, std::int32_t ring, int boxes, double product, double azimuth_rad, double rest2) {
    int first = 0;
    int count = boxes;
    if (rest2 < 4.0 * product) {
      const double sine = std::sqrt(rest2 / (4.0 * product));
      const double angle = 2.0 * sine * (1.0 + (0.5 * math::kPi - 1.0) * sine * sine);  // at least twice the arc sine
      const double to_box = boxes / math::kTurnRad;
      // Truncation is downwards: the arguments are made positive by one turn.
      const int low = static_cast<int>((azimuth_rad - angle) * to_box + boxes);
      const int high = static_cast<int>((azimuth_rad + angle) * to_box + boxes);
      first = low >= boxes ? low - boxes : low;
      count = std::min(high - low + 1, boxes);
    }
    if (found_ + 2 * static_cast<std::size_t>(count) > buffer_.size()) {
      buffer_.resize(2 * (found_ + 2 * static_cast<std::size_t>(count)));
    }
    for (int i = 0, place = first; i < count; ++i) {
      // Written whether there is a sphere or not: whether there is one no processor can foretell.
      const Box& box = level.boxes[ring + place];
      buffer_[found_] = box.first;
      found_ += box.first != kNone ? 1 : 0;
      buffer_[found_] = box.second;
      found_ += box.second != kNone ? 1 : 0;
      if (box.others != kNone) {
        for (std::uint32_t other = box.others; other != kNone; other = others_[other].next) {
          if (found_ + 2 * static_cast<std::size_t>(count) >= buffer_.size()) {
            buffer_.resize(2 * buffer_.size() + 1);
          }
          buffer_[found_++] = others_[other].index;
        }
      }
      place = place + 1 == boxes ? 0 : place + 1;
    }
  }

  Level& level_for(double radius_mm) {
    int power = 0;
    if (std::frexp(radius_mm / usual_, &power) == 0.5) {
      --power;
    }
    for (Level& level : levels_) {
      if (level.power == power) {
        return level;
      }
    }
    Level level;
    level.power = power;
    level.largest_mm = std::ldexp(usual_, power);
    level.low_y = low_.y;
    const double across = high_.x;
    const double along = high_.y - low_.y;
    double size = 2.000001 * factor_ * level.largest_mm;
    size = std::max({size, across / kMostColumns, along / kMostSquares});
    size = std::max(size, std::sqrt(across * along / kMostSquares));
    level.size = size;
    level.inverse_size = 1.0 / size;
    level.columns = static_cast<int>(across / size) + 1;
    level.rows = static_cast<int>(along / size) + 1;
    level.rings.assign(static_cast<std::size_t>(level.columns) * level.rows, -1);
    levels_.push_back(std::move(level));
    return levels_.back();
  }

  Vec2 low_;
  Vec2 high_;
  double usual_;
  double factor_;
  std::vector<Level> levels_;
  std::vector<Entry> entries_;
  std::vector<Other> others_;
  std::vector<std::uint32_t> buffer_;  ///< the answer, `found_` long
  std::size_t found_ = 0;
};

}  // namespace anthesis
