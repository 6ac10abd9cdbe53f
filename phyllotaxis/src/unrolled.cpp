#include "unrolled.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "anthesis/base/math.h"
#include "anthesis/geometry/delaunay.h"

namespace anthesis::detail {
namespace {

/// The grid on which copies of an organ are exact shifts of each other; delaunay() takes points 2^-27 apart.
constexpr double kGrid = 0x1p26;

/// Integral of ds / r over a stretch along which r runs evenly from `r0` to `r1`.
double conformal_length(double ds, double r0, double r1) {
  const double mean = 0.5 * (r0 + r1);
  const double x = 0.5 * (r1 - r0) / mean;
  // The quotient of logarithm and difference loses all digits where r hardly changes.
  return std::abs(x) < 1e-3 ? ds / mean * (1.0 + x * x / 3.0) : ds * math::log(r1 / r0) / (r1 - r0);
}

double wrapped(double azimuth_rad) {
  const double turns = azimuth_rad / math::kTurnRad;
  const double rest = azimuth_rad - math::kTurnRad * std::floor(turns);
  return rest >= math::kTurnRad || rest < 0.0 ? 0.0 : rest;
}

/// A number in [-1, 1] that depends on the organ alone.
double scatter(std::uint32_t organ, std::uint32_t salt) {
  std::uint64_t x = (std::uint64_t{salt} << 32 | organ) + 0x9E3779B97F4A7C15ull;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  x ^= x >> 31;
  return static_cast<double>(x >> 11) * 0x1p-52 - 1.0;
}

/// Spacing out of the number of organs per u, counted over `reach` ranks to either side.
template <class Reach>
std::vector<double> spacings(const std::vector<Vec2>& place, Reach reach) {
  const std::size_t n = place.size();
  std::vector<double> result(n);
  const double whole = std::max(place.back().y - place.front().y, 1e-9);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t r = std::clamp<std::size_t>(reach(i), 1, n - 1);
    const std::size_t low = i > r ? i - r : 0;
    const std::size_t high = std::min(n - 1, i + r);
    // Whorls have ranks without height between them.
    const double height = std::max(place[high].y - place[low].y, 1e-6 * whole);
    result[i] = std::sqrt(math::kTurnRad * height / static_cast<double>(high - low));
  }
  return result;
}

}  // namespace

Unrolled unroll(std::span<const PatternOrgan> organs) {
  Unrolled unrolled;
  double widest = 0.0;
  const auto finite = [](const PatternOrgan& organ) {
    return std::isfinite(organ.azimuth_rad) && std::isfinite(organ.s_mm) && std::isfinite(organ.radius_mm);
  };
  for (const PatternOrgan& organ : organs) {
    if (finite(organ)) {
      widest = std::max(widest, organ.radius_mm);
    }
  }
  for (std::size_t i = 0; i < organs.size(); ++i) {
    if (finite(organs[i]) && organs[i].radius_mm > 1e-9 * widest) {
      unrolled.organ.push_back(static_cast<std::uint32_t>(i));
    }
  }
  std::sort(unrolled.organ.begin(), unrolled.organ.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (organs[a].s_mm != organs[b].s_mm) {
      return organs[a].s_mm < organs[b].s_mm;
    }
    const double x = wrapped(organs[a].azimuth_rad);
    const double y = wrapped(organs[b].azimuth_rad);
    return x != y ? x < y : a < b;
  });
  const auto twins = [&](std::uint32_t a, std::uint32_t b) {
    return organs[a].s_mm == organs[b].s_mm && wrapped(organs[a].azimuth_rad) == wrapped(organs[b].azimuth_rad);
  };
  unrolled.organ.erase(std::unique(unrolled.organ.begin(), unrolled.organ.end(), twins), unrolled.organ.end());
  const std::size_t n = unrolled.organ.size();
  if (n < 3) {
    return unrolled;
  }
  double u = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const PatternOrgan& organ = organs[unrolled.organ[i]];
    if (i > 0) {
      const PatternOrgan& before = organs[unrolled.organ[i - 1]];
      u += conformal_length(organ.s_mm - before.s_mm, before.radius_mm, organ.radius_mm);
    }
    unrolled.place.push_back({wrapped(organ.azimuth_rad), u});
  }
  // First a guess over a fixed number of organs, then over about three rows of them.
  const std::vector<double> guess = spacings(unrolled.place, [](std::size_t) { return 24; });
  unrolled.spacing = spacings(unrolled.place, [&](std::size_t i) {
    return static_cast<std::size_t>(std::min(1e9, std::ceil(1.5 * math::kTurnRad / guess[i])));
  });

  // One turn is a power of two of the unit square, so that an organ and its copies to the left and right lie on the
  // same grid and are triangulated alike.
  double turn = 0.25;
  while (unrolled.place.back().y * turn / math::kTurnRad > 0.99) {
    turn *= 0.5;
  }
  const double scale = turn / math::kTurnRad;
  struct Point {
    double x, y;
    std::uint32_t rank;
    std::int32_t shift;
  };
  std::vector<Point> points;
  points.reserve(n + n / 2);
  for (std::uint32_t i = 0; i < n; ++i) {
    // Four organs of a square share a circle. A thousandth of a spacing decides which diagonal is taken, the same way
    // for all copies; whoever needs the lattice's own answer must not ask the diagonal.
    const double loose = 1e-3 * unrolled.spacing[i];
    const double x = scale * (unrolled.place[i].x + loose * scatter(unrolled.organ[i], 1));
    const double y = scale * (unrolled.place[i].y + loose * scatter(unrolled.organ[i], 2));
    points.push_back({0.5 * (1.0 - turn) + std::nearbyint(x * kGrid) / kGrid,
                      std::clamp(std::nearbyint(y * kGrid) / kGrid, 0.0, 1.0), i, 0});
  }
  // Organs at one place but for a hair would be one point twice: the second goes without neighbours.
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::array{points[a].y, points[a].x, double(a)} < std::array{points[b].y, points[b].x, double(b)};
  });
  std::vector<bool> twice(n, false);
  for (std::size_t i = 1; i < n; ++i) {
    twice[order[i]] = points[order[i]].x == points[order[i - 1]].x && points[order[i]].y == points[order[i - 1]].y;
  }
  std::erase_if(points, [&](const Point& point) { return twice[point.rank]; });

  const std::size_t originals = points.size();
  for (std::size_t k = 0; k < originals; ++k) {
    const Point point = points[k];
    // Ten rows of copies to either side, and half a turn on small heads, so that even a gap is bridged right. Where an
    // organ can be its own neighbour around the axis that is the whole turn.
    const double margin =
        std::clamp(10.0 * unrolled.spacing[point.rank], n < 20'000 ? math::kPi : 0.25 * math::kPi, math::kTurnRad);
    const double azimuth = unrolled.place[point.rank].x;
    if (azimuth < margin) {
      points.push_back({point.x + turn, point.y, point.rank, 1});
    }
    if (azimuth >= math::kTurnRad - margin) {
      points.push_back({point.x - turn, point.y, point.rank, -1});
    }
  }
  std::vector<Vec2> plane;
  plane.reserve(points.size());
  for (const Point& point : points) {
    plane.push_back({point.x, point.y});
  }
  for (const Triangle& triangle : delaunay(plane)) {
    // Of a triangle's copies the one counts whose first organ, or the leftmost if it is there twice, is itself.
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      return points[a].rank != points[b].rank ? points[a].rank < points[b].rank : points[a].shift < points[b].shift;
    };
    const std::uint32_t first = *std::min_element(triangle.begin(), triangle.end(), before);
    if (points[first].shift != 0) {
      continue;
    }
    Cell cell;
    std::array<Vec2, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& point = points[triangle[k]];
      cell.rank[k] = point.rank;
      corner[k] = unrolled.place[point.rank] + Vec2{math::kTurnRad * point.shift, 0.0};
    }
    for (std::size_t k = 0; k < 3; ++k) {
      cell.side[k] = corner[(k + 1) % 3] - corner[k];
    }
    unrolled.cells.push_back(cell);
  }
  return unrolled;
}

}  // namespace anthesis::detail
