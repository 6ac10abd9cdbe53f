#include "skyline.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

constexpr std::size_t kFewestSectors = 16;
constexpr std::size_t kMostSectors = 1 << 20;

}  // namespace

void ForbiddenStretches::add_all_below(double place) {
  all_below_ = std::max(all_below_, place);
  int passed = 0;
  while (passed < count_ && stretch_[passed][0] <= all_below_) {
    all_below_ = std::max(all_below_, stretch_[passed][1]);
    ++passed;
  }
  std::copy(stretch_.begin() + passed, stretch_.begin() + count_, stretch_.begin());
  count_ -= passed;
}

void ForbiddenStretches::add(double from, double to) {
  if (to <= all_below_) {
    return;
  }
  if (from <= all_below_) {
    add_all_below(to);
    return;
  }
  int first = 0;
  while (first < count_ && stretch_[first][1] < from) {
    ++first;
  }
  int last = first;  // those in [first, last) meet the new one
  while (last < count_ && stretch_[last][0] <= to) {
    from = std::min(from, stretch_[last][0]);
    to = std::max(to, stretch_[last][1]);
    ++last;
  }
  if (last > first) {
    stretch_[first] = {from, to};
    std::copy(stretch_.begin() + last, stretch_.begin() + count_, stretch_.begin() + first + 1);
    count_ -= last - first - 1;
    return;
  }
  if (count_ == kMost) {  // the shortest is forgotten: less is proven, nothing wrong
    int shortest = 0;
    for (int i = 1; i < count_; ++i) {
      if (stretch_[i][1] - stretch_[i][0] < stretch_[shortest][1] - stretch_[shortest][0]) {
        shortest = i;
      }
    }
    if (to - from <= stretch_[shortest][1] - stretch_[shortest][0]) {
      return;
    }
    std::copy(stretch_.begin() + shortest + 1, stretch_.begin() + count_, stretch_.begin() + shortest);
    --count_;
    first -= shortest < first ? 1 : 0;
  }
  std::copy_backward(stretch_.begin() + first, stretch_.begin() + count_, stretch_.begin() + count_ + 1);
  stretch_[first] = {from, to};
  ++count_;
}

ForbiddenStretches common(const ForbiddenStretches& a, const ForbiddenStretches& b) {
  ForbiddenStretches both;
  both.all_below_ = std::min(a.all_below_, b.all_below_);
  // The part below everything is a stretch like the others.
  int i = -1;
  int j = -1;
  while (i < a.count_ && j < b.count_) {
    const double a_from = i < 0 ? 0.0 : a.stretch_[i][0];
    const double a_to = i < 0 ? a.all_below_ : a.stretch_[i][1];
    const double b_from = j < 0 ? 0.0 : b.stretch_[j][0];
    const double b_to = j < 0 ? b.all_below_ : b.stretch_[j][1];
    const double from = std::max(a_from, b_from);
    const double to = std::min(a_to, b_to);
    if (from < to && from > 0.0) {
      both.add(from, to);
    }
    (a_to < b_to ? i : j) += 1;
  }
  return both;
}

void Skyline::reset(double floor_mm) {
  floor_mm_ = floor_mm;
  since_fit_ = 0;
  sectors_.assign(sectors_.empty() ? kFewestSectors : sectors_.size(), {});
}

double Skyline::sector_rad() const {
  return math::kTurnRad / static_cast<double>(sectors_.size());
}

std::uint32_t Skyline::index_of(double azimuth_rad) const {
  const auto count = static_cast<double>(sectors_.size());
  return static_cast<std::uint32_t>(std::min(azimuth_rad * (count / math::kTurnRad), count - 1.0));
}

/// Sectors between a fifth and a half of the distance wide, where organs are being laid.
void Skyline::fit_sectors(double axis_mm, double distance_mm) {
  const double arc_mm = axis_mm * sector_rad();
  // Not for each organ of a surface that goes in and out: halving costs as much as some organs for each sector.
  if (++since_fit_ < sectors_.size() / 2 && sectors_.size() > kFewestSectors) {
    return;
  }
  if (arc_mm > 0.5 * distance_mm && sectors_.size() < kMostSectors) {
    std::vector<ForbiddenStretches> halves(2 * sectors_.size());
    for (std::size_t i = 0; i < halves.size(); ++i) {
      halves[i] = sectors_[i / 2];
    }
    sectors_ = std::move(halves);
    since_fit_ = 0;
  } else if (arc_mm < 0.2 * distance_mm && sectors_.size() > kFewestSectors) {
    for (std::size_t i = 0; i < sectors_.size() / 2; ++i) {
      sectors_[i] = common(sectors_[2 * i], sectors_[2 * i + 1]);
    }
    sectors_.resize(sectors_.size() / 2);
    since_fit_ = 0;
  }
}

/// A place at most d along the curve away from the organ, at an azimuth that differs by at most D, is at most
/// sqrt(d^2 + 4 r (r + d) sin^2(D / 2)) away from it, r being the organ's distance from the axis.
void Skyline::add(const GeneratorCurve& curve, GeneratorPlace place, double axis_mm, double azimuth_rad,
                  double distance_mm) {
  fit_sectors(axis_mm, distance_mm);
  const double width = sector_rad();
  const auto count = static_cast<std::uint32_t>(sectors_.size());
  const std::uint32_t home = index_of(azimuth_rad);
  const double off = azimuth_rad - home * width;  // into the home sector
  const auto add_to = [&](std::uint32_t sector, double furthest_rad) {
    const double half = axis_mm * furthest_rad;  // at least 2 r sin(D / 2)
    const double linear = 0.5 * half * furthest_rad;
    const double rest = linear * linear - half * half + distance_mm * distance_mm;
    const double way_mm = std::sqrt(std::max(rest, 0.0)) - linear;
    if (!(way_mm > 0.0)) {
      return false;
    }
    const auto [low, high] = curve.stretch_about(place, way_mm);
    sectors_[sector].add(low, high);
    return true;
  };
  add_to(home, std::max(off, width - off) * (1.0 + 1e-12));
  std::uint32_t sector = home;
  std::uint32_t seen = 1;
  for (double furthest = 2.0 * width - off; seen < count; furthest += width) {
    sector = sector + 1 == count ? 0 : sector + 1;
    ++seen;
    if (!add_to(sector, furthest * (1.0 + 1e-12))) {
      break;
    }
  }
  sector = home;
  for (double furthest = off + width; seen < count; furthest += width) {
    sector = sector == 0 ? count - 1 : sector - 1;
    ++seen;
    if (!add_to(sector, furthest * (1.0 + 1e-12))) {
      break;
    }
  }
}

}  // namespace anthesis
