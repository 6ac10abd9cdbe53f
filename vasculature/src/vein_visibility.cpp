#include "vein_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anthesis/base/math.h"

namespace anthesis::veins {
namespace {

struct Candidate {
  double square;
  std::uint32_t index;
};

/// A cone that is taken: direction and half width.
struct Shield {
  Vec3 direction;
  double half;
  double cosine;
  double sine;
};

bool shields(const Shield& a, const Shield& b) {
  // cos(a + b), so that no arc cosine is needed; beyond a half turn they always meet.
  return a.half + b.half > math::kPi || dot(a.direction, b.direction) > a.cosine * b.cosine - a.sine * b.sine;
}

/// The cones that are taken, by the cell of a grid that their direction lies in.
class TakenCones {
 public:
  /// Whether `own` meets one that is taken. None of those is wider: vertices come nearest first.
  bool meets(const Shield& own) {
    const double reach = 2.0 * own.sine;  // longest chord between directions of cones that meet
    if (own.half > 0.5 * kWidestInCells || taken_.size() < kFewForCells) {
      for (std::size_t k = 0; k < taken_.size(); ++k) {
        if (shields(taken_[k], own)) {
          return true;
        }
      }
      return false;
    }
    const Vec3 d = own.direction;
    const int x0 = cell(d.x - reach), x1 = cell(d.x + reach);
    const int y0 = cell(d.y - reach), y1 = cell(d.y + reach);
    const int z0 = cell(d.z - reach), z1 = cell(d.z + reach);
    for (int z = z0; z <= z1; ++z) {
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
          for (std::uint32_t k = latest_[id(x, y, z)]; k != kNone; k = before_[k]) {
            if (shields(taken_[k], own)) {
              return true;
            }
          }
        }
      }
    }
    return false;
  }

  void take(const Shield& own) {
    if (latest_.empty()) {
      latest_.assign(kAcross * kAcross * kAcross, kNone);
    }
    std::uint32_t& latest = latest_[id(cell(own.direction.x), cell(own.direction.y), cell(own.direction.z))];
    before_.push_back(latest);
    latest = static_cast<std::uint32_t>(taken_.size());
    taken_.push_back(own);
  }

 private:
  static constexpr int kAcross = 16;
  static constexpr double kWidestInCells = 0.4;  // radians; wider ones reach so many cells that all may be asked
  static constexpr std::size_t kFewForCells = 64;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  static int cell(double coordinate) {
    return std::clamp(static_cast<int>((coordinate + 1.0) * (0.5 * kAcross)), 0, kAcross - 1);
  }
  static std::size_t id(int x, int y, int z) { return static_cast<std::size_t>((z * kAcross + y) * kAcross + x); }

  std::vector<Shield> taken_;
  std::vector<std::uint32_t> latest_;  // of each cell
  std::vector<std::uint32_t> before_;  // of each cone, in the same cell
};

}  // namespace

void visit_visible(Vec3 p, std::span<const Vec3> positions, std::span<const std::uint32_t> candidates, double angle_rad,
                   const std::function<bool(std::uint32_t, double)>& visit) {
  std::vector<Candidate> near;
  near.reserve(candidates.size());
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : candidates) {
    const Vec3 way = positions[i] - p;
    const double square = dot(way, way);
    near.push_back({square, i});
    least = std::min(least, square);
  }
  if (near.empty()) {
    return;
  }
  // Half widths of two shields add up to more than a half turn beyond this distance: nothing there is seen.
  const double nearest = std::max(std::sqrt(least), 1e-12);
  const double farthest = nearest * std::max((math::kTurnRad - angle_rad) / angle_rad, 1.0) * (1.0 + 1e-9);
  std::erase_if(near, [&](const Candidate& c) { return c.square > farthest * farthest; });
  const auto later = [](const Candidate& a, const Candidate& b) {
    return a.square != b.square ? a.square > b.square : a.index > b.index;
  };
  std::make_heap(near.begin(), near.end(), later);  // many scans stop early: do not sort what is not needed
  TakenCones taken;
  while (!near.empty()) {
    std::pop_heap(near.begin(), near.end(), later);
    const Candidate candidate = near.back();
    near.pop_back();
    const double distance = std::sqrt(candidate.square);
    const double half = std::min(0.5 * angle_rad * std::max(distance, nearest) / nearest, math::kPi);
    const math::SinCos sc = math::sin_cos(half);
    const Shield own{normalized(positions[candidate.index] - p), half, sc.cos, sc.sin};
    if (taken.meets(own)) {
      continue;
    }
    taken.take(own);
    if (!visit(candidate.index, distance)) {
      return;
    }
  }
}

}  // namespace anthesis::veins
