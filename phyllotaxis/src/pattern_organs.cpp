// The profile under organs of which only the positions are known.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/parastichies.h"

namespace anthesis {
namespace {

/// Means of the points in each box of a grid that holds any, at most some hundreds.
std::vector<Vec2> means_by_box(std::span<const Vec2> points) {
  Vec2 low = points[0];
  Vec2 high = points[0];
  for (const Vec2 p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const double extent = std::max({high.x - low.x, high.y - low.y, 1e-300});
  // About as many organs in a box as there are in a row; in large patterns the curve needs no more than 96.
  const double boxes = std::clamp(0.7 * std::sqrt(static_cast<double>(points.size())), 4.0, 96.0);
  const double size = extent / boxes;
  struct Mean {
    Vec2 sum;
    double count = 0.0;
  };
  std::map<std::pair<int, int>, Mean> means;
  for (const Vec2 p : points) {
    Mean& mean = means[{static_cast<int>((p.x - low.x) / size), static_cast<int>((p.y - low.y) / size)}];
    mean.sum += p;
    mean.count += 1.0;
  }
  std::vector<Vec2> result;
  for (const auto& [box, mean] : means) {
    result.push_back(mean.sum / mean.count);
  }
  return result;
}

/// The longest path in the shortest tree through all points: a curve through a cloud that is one, side twigs left out.
std::vector<Vec2> spine(const std::vector<Vec2>& points) {
  const std::size_t n = points.size();
  std::vector<std::vector<std::size_t>> tree(n);
  std::vector<double> distance(n, std::numeric_limits<double>::infinity());
  std::vector<std::size_t> parent(n, 0);
  std::vector<bool> taken(n, false);
  std::size_t next = 0;
  for (std::size_t round = 0; round < n; ++round) {
    taken[next] = true;
    if (round > 0) {
      tree[next].push_back(parent[next]);
      tree[parent[next]].push_back(next);
    }
    std::size_t nearest = next;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      if (taken[i]) {
        continue;
      }
      const double away = length(points[i] - points[next]);
      if (away < distance[i]) {
        distance[i] = away;
        parent[i] = next;
      }
      if (distance[i] < least) {
        least = distance[i];
        nearest = i;
      }
    }
    next = nearest;
  }
  std::vector<std::size_t> came(n, 0);
  const auto farthest = [&](std::size_t start) {
    std::vector<double> way(n, -1.0);
    std::vector<std::size_t> stack = {start};
    way[start] = 0.0;
    came[start] = start;
    std::size_t best = start;
    while (!stack.empty()) {
      const std::size_t at = stack.back();
      stack.pop_back();
      if (way[at] > way[best]) {
        best = at;
      }
      for (const std::size_t to : tree[at]) {
        if (way[to] < 0.0) {
          way[to] = way[at] + length(points[to] - points[at]);
          came[to] = at;
          stack.push_back(to);
        }
      }
    }
    return best;
  };
  std::size_t at = farthest(farthest(0));
  std::vector<Vec2> path = {points[at]};
  while (came[at] != at) {
    at = came[at];
    path.push_back(points[at]);
  }
  return path;
}

}  // namespace

std::vector<PatternOrgan> pattern_organs(std::span<const Vec3> positions_mm) {
  std::vector<PatternOrgan> organs(positions_mm.size());
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < organs.size(); ++i) {
    const Vec3 p = positions_mm[i];
    organs[i] = {math::atan2(p.y, p.x), std::numeric_limits<double>::quiet_NaN(), std::sqrt(p.x * p.x + p.y * p.y),
                 p.z};
    if (std::isfinite(organs[i].radius_mm) && std::isfinite(p.z)) {
      points.push_back({organs[i].radius_mm, p.z});
    }
  }
  if (points.size() < 2) {
    return organs;
  }
  std::vector<Vec2> curve = spine(means_by_box(points));
  if (curve.size() < 2) {
    curve.push_back(curve[0] + Vec2{1.0, 0.0});
  }
  for (int round = 0; round < 3; ++round) {
    std::vector<Vec2> smooth = curve;
    for (std::size_t i = 1; i + 1 < curve.size(); ++i) {
      smooth[i] = 0.25 * curve[i - 1] + 0.5 * curve[i] + 0.25 * curve[i + 1];
    }
    curve = std::move(smooth);
  }
  if (curve.front().x > curve.back().x) {
    std::reverse(curve.begin(), curve.end());
  }
  std::vector<double> along = {0.0};
  for (std::size_t i = 1; i < curve.size(); ++i) {
    along.push_back(along.back() + length(curve[i] - curve[i - 1]));
  }
  double first = std::numeric_limits<double>::infinity();
  for (PatternOrgan& organ : organs) {
    const Vec2 p = {organ.radius_mm, organ.height_mm};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
      const Vec2 side = curve[i + 1] - curve[i];
      const double size = length(side);
      if (!(size > 0.0)) {
        continue;
      }
      // Beyond its ends the curve goes straight on.
      const double from = i == 0 ? -1e9 : 0.0;
      const double to = i + 2 == curve.size() ? 1e9 : 1.0;
      const double t = std::clamp(dot(p - curve[i], side) / (size * size), from, to);
      const double away = length(p - curve[i] - t * side);
      if (away < least) {
        least = away;
        organ.s_mm = along[i] + t * size;
      }
    }
    if (std::isfinite(organ.s_mm)) {
      first = std::min(first, organ.s_mm);
    }
  }
  // The apex itself carries no organ: the first one is taken to lie as far from it as from the axis.
  double radius_there = 0.0;
  for (const PatternOrgan& organ : organs) {
    if (organ.s_mm == first) {
      radius_there = organ.radius_mm;
    }
  }
  for (PatternOrgan& organ : organs) {
    organ.s_mm += radius_there - first;
  }
  return organs;
}

}  // namespace anthesis
