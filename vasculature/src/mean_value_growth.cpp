#include "anthesis/vasculature/mean_value_growth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"

namespace anthesis {
namespace {

constexpr std::size_t kLanes = 8;      // points handled side by side
constexpr std::size_t kPerTask = 256;  // points of one parallel task

/// A corner of the closed, mirrored section and how it moves.
struct Corner {
  Vec2 position;
  Vec2 displacement;
};

/// Down the right side, along the base and up the left side. The displacement is mirrored as it is, its radial part
/// too: then nothing tells the axis from any other line, as in O24, where the fields have no slope across it.
std::vector<Corner> section(std::span<const Vec2> from, std::span<const Vec2> to) {
  const std::size_t count = from.size();
  std::vector<Corner> corners;
  corners.reserve(2 * count + 1);
  for (std::size_t i = 0; i < count; ++i) {
    corners.push_back({from[i], to[i] - from[i]});
  }
  // The displacement is linear along the base, from the rim's to none across the axis: one edge instead of many.
  corners.push_back({{0.0, from.back().y}, {0.0, to.back().y - from.back().y}});
  for (std::size_t i = count; i-- > 0;) {
    if (from[i].x > 0.0 || to[i].x > 0.0) {  // the apex is its own image
      corners.push_back({{-from[i].x, from[i].y}, to[i] - from[i]});
    }
  }
  return corners;
}

/// At the nearest place of the section's border, linear along its edges.
Vec2 border_displacement(std::span<const Corner> corners, Vec2 p) {
  double best = std::numeric_limits<double>::infinity();
  Vec2 result;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner& a = corners[i];
    const Corner& b = corners[i + 1 == corners.size() ? 0 : i + 1];
    const Vec2 edge = b.position - a.position;
    const double square = dot(edge, edge);
    const double t = square > 0.0 ? std::clamp(dot(p - a.position, edge) / square, 0.0, 1.0) : 0.0;
    const Vec2 away = p - lerp(a.position, b.position, t);
    if (dot(away, away) < best) {
      best = dot(away, away);
      result = lerp(a.displacement, b.displacement, t);
    }
  }
  return result;
}

/// Mean value interpolation at kLanes points. Each edge a, b seen from a point under the angle w weighs
/// tan(w / 2) (f_a / r_a + f_b / r_b): linear data over a straight edge weigh the same however it is cut up.
void move_lanes(std::span<const Corner> corners, Vec2* points) {
  double px[kLanes], py[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) {
    px[l] = points[l].x;
    py[l] = points[l].y;
  }
  double ax[kLanes], ay[kLanes], ra[kLanes];
  double sum_w[kLanes] = {}, sum_x[kLanes] = {}, sum_y[kLanes] = {};
  const Corner& last = corners.back();
  for (std::size_t l = 0; l < kLanes; ++l) {
    ax[l] = last.position.x - px[l];
    ay[l] = last.position.y - py[l];
    ra[l] = std::sqrt(ax[l] * ax[l] + ay[l] * ay[l]);
  }
  Vec2 from = last.displacement;
  for (const Corner& corner : corners) {
    const double cx = corner.position.x;
    const double cy = corner.position.y;
    const Vec2 to = corner.displacement;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double bx = cx - px[l];
      const double by = cy - py[l];
      const double rb = std::sqrt(bx * bx + by * by);
      const double across = ax[l] * by - ay[l] * bx;
      const double along = ax[l] * bx + ay[l] * by;
      const double product = ra[l] * rb;
      // Both are tan(w / 2); the one loses its digits near 0, the other near a half turn.
      const bool wide = along < 0.0;
      const double above = wide ? product - along : across;
      const double below = wide ? across : product + along;
      const double tangent = above / (below * product);  // over both distances: one division for three
      const double wa = tangent * rb;
      const double wb = tangent * ra[l];
      sum_w[l] += wa + wb;
      sum_x[l] += wa * from.x + wb * to.x;
      sum_y[l] += wa * from.y + wb * to.y;
      ax[l] = bx;
      ay[l] = by;
      ra[l] = rb;
    }
    from = to;
  }
  for (std::size_t l = 0; l < kLanes; ++l) {
    Vec2 move = {sum_x[l] / sum_w[l], sum_y[l] / sum_w[l]};
    if (!std::isfinite(move.x) || !std::isfinite(move.y)) {  // on a corner or an edge
      move = border_displacement(corners, points[l]);
    }
    points[l] = {std::max(points[l].x + move.x, 0.0), points[l].y + move.y};
  }
}

void move_points(std::span<const Vec2> from, std::span<const Vec2> to, std::span<Vec2> points) {
  const std::vector<Corner> corners = section(from, to);
  parallel_for((points.size() + kPerTask - 1) / kPerTask, [&](std::size_t task) {
    const std::size_t first = task * kPerTask;
    const std::size_t end = std::min(first + kPerTask, points.size());
    std::size_t i = first;
    for (; i + kLanes <= end; i += kLanes) {
      move_lanes(corners, &points[i]);
    }
    if (i < end) {  // the rest, filled up
      Vec2 lanes[kLanes];
      for (std::size_t l = 0; l < kLanes; ++l) {
        lanes[l] = points[std::min(i + l, end - 1)];
      }
      move_lanes(corners, lanes);
      std::copy(lanes, lanes + (end - i), &points[i]);
    }
  });
}

}  // namespace

HeadGrowth mean_value_growth(OutlineSequence outlines) {
  ANTHESIS_ASSERT(outlines.points_per_frame >= 2 && outlines.frames() >= 2);
  const auto shared = std::make_shared<const OutlineSequence>(std::move(outlines));
  return {shared->frames(), [shared](std::size_t frame) { return shared->frame(frame); },
          [shared](std::size_t from, std::size_t to, std::span<Vec2> points) {
            move_points(shared->frame(from), shared->frame(to), points);
          }};
}

}  // namespace anthesis
