#include "anthesis/contact/continuous.h"

#include <vector>

#include "nearest.h"

namespace anthesis {
namespace {

/// Weights of the two nearest points, each primitive's adding up to 1.
using Weights = std::array<double, 4>;

Nearest with_weights(const std::array<Vec3, 4>& points, const Weights& weights) {
  Nearest nearest;
  nearest.weights = weights;
  for (int i = 0; i < 3; ++i) {
    nearest.difference += weights[i] * (points[i] - points[3]);  // the weights add up to 0
  }
  nearest.distance = length(nearest.difference);
  return nearest;
}

void keep_nearer(Nearest& best, const Nearest& candidate) {
  if (candidate.distance < best.distance) {
    best = candidate;
  }
}

/// Where on the segment from `a` to `b` the nearest point to `p` is, in [0, 1].
double along_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 edge = b - a;
  const double square = dot(edge, edge);
  return square > 0.0 ? std::clamp(dot(p - a, edge) / square, 0.0, 1.0) : 0.0;
}

/// Whether the difference of two points of the primitives is their distance: no other pair of points can be nearer than
/// the slab across it is thick. What is lost to rounding is allowed for.
template <int FirstCount>
bool is_nearest(const std::array<Vec3, 4>& points, const Nearest& nearest) {
  const double square = nearest.distance * nearest.distance;
  return width_along<FirstCount>(points, nearest.difference) >=
         square * (1.0 - 1e-9) - 32.0 * kUnitRoundoff * nearest.distance * extent(points);
}

/// By the regions of the triangle's plane (Ericson 2005, section 5.1.5).
Nearest nearest_vertex_triangle_by_regions(const std::array<Vec3, 4>& points) {
  const Vec3 ab = points[2] - points[1];
  const Vec3 ac = points[3] - points[1];
  const Vec3 ap = points[0] - points[1];
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) {
    return with_weights(points, {1.0, -1.0, 0.0, 0.0});
  }
  const Vec3 bp = points[0] - points[2];
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) {
    return with_weights(points, {1.0, 0.0, -1.0, 0.0});
  }
  const Vec3 cp = points[0] - points[3];
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) {
    return with_weights(points, {1.0, 0.0, 0.0, -1.0});
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 - d3 > 0.0) {
    const double v = d1 / (d1 - d3);
    return with_weights(points, {1.0, v - 1.0, -v, 0.0});
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 - d6 > 0.0) {
    const double w = d2 / (d2 - d6);
    return with_weights(points, {1.0, w - 1.0, 0.0, -w});
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 && (d4 - d3) + (d5 - d6) > 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return with_weights(points, {1.0, 0.0, w - 1.0, -w});
  }
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) {
    return with_weights(points, {1.0, -1.0, 0.0, 0.0});  // a needle; whoever asked finds out and takes the long way
  }
  const double v = std::clamp(vb / sum, 0.0, 1.0);
  const double w = std::clamp(vc / sum, 0.0, 1.0 - v);
  return with_weights(points, {1.0, v + w - 1.0, -v, -w});
}

/// Inside and along each side, the best of all: slower, but never led astray by a needle.
Nearest nearest_vertex_triangle_of_all(const std::array<Vec3, 4>& points) {
  Nearest best = with_weights(points, {1.0, -1.0, 0.0, 0.0});
  for (int k = 0; k < 3; ++k) {
    const int a = 1 + k;
    const int b = 1 + (k + 1) % 3;
    const double s = along_segment(points[0], points[a], points[b]);
    Weights weights = {1.0, 0.0, 0.0, 0.0};
    weights[a] = s - 1.0;
    weights[b] = -s;
    keep_nearer(best, with_weights(points, weights));
  }
  const Vec3 normal = cross(points[2] - points[1], points[3] - points[1]);
  const double square = dot(normal, normal);
  if (square > 0.0) {
    const double v = dot(cross(points[0] - points[1], points[3] - points[1]), normal) / square;
    const double w = dot(cross(points[2] - points[1], points[0] - points[1]), normal) / square;
    if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
      keep_nearer(best, with_weights(points, {1.0, v + w - 1.0, -v, -w}));
    }
  }
  return best;
}

Nearest nearest_at(const std::array<Vec3, 4>& points, double s, double t) {
  return with_weights(points, {1.0 - s, s, t - 1.0, -t});
}

/// The common perpendicular of the two lines, moved back to the edges (Ericson 2005, section 5.1.9).
Nearest nearest_edge_edge_by_lines(const std::array<Vec3, 4>& points) {
  const Vec3 one = points[1] - points[0];
  const Vec3 other = points[3] - points[2];
  const Vec3 between = points[0] - points[2];
  const double a = dot(one, one);
  const double e = dot(other, other);
  const double b = dot(one, other);
  const double c = dot(one, between);
  const double f = dot(other, between);
  if (!(a > 0.0 && e > 0.0)) {
    return nearest_at(points, along_segment(points[2], points[0], points[1]),
                      along_segment(points[0], points[2], points[3]));
  }
  const double denominator = a * e - b * b;
  double s = denominator > 0.0 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.5;
  double t = (b * s + f) / e;
  if (t < 0.0) {
    t = 0.0;
    s = std::clamp(-c / a, 0.0, 1.0);
  } else if (t > 1.0) {
    t = 1.0;
    s = std::clamp((b - c) / a, 0.0, 1.0);
  }
  return nearest_at(points, s, t);
}

/// Across the middle and from each end, the best of all: for edges that are almost parallel.
Nearest nearest_edge_edge_of_all(const std::array<Vec3, 4>& points, const Nearest& guess) {
  Nearest best = guess;
  for (int end = 0; end < 2; ++end) {
    const double at_end = end;
    keep_nearer(best, nearest_at(points, at_end, along_segment(points[end], points[2], points[3])));
    keep_nearer(best, nearest_at(points, along_segment(points[2 + end], points[0], points[1]), at_end));
  }
  return best;
}

/// Four points in straight motion, seen from the last of them, which so comes to rest: what they share cannot touch
/// anything, and the coordinates that are left are as small as the primitives and their relative motion.
struct RelativeMotion {
  std::array<Vec3, 4> from;
  std::array<Vec3, 4> to;
  double size = 0.0;  ///< the largest coordinate

  RelativeMotion(const std::array<Vec3, 4>& from_absolute, const std::array<Vec3, 4>& to_absolute) {
    for (int i = 0; i < 4; ++i) {
      from[i] = from_absolute[i] - from_absolute[3];
      to[i] = to_absolute[i] - to_absolute[3];
      for (const Vec3& r : {from[i], to[i]}) {
        size = std::max({size, std::abs(r.x), std::abs(r.y), std::abs(r.z)});
      }
    }
  }

  std::array<Vec3, 4> at(double time) const {
    return {lerp(from[0], to[0], time), lerp(from[1], to[1], time), lerp(from[2], to[2], time), Vec3{}};
  }
};

/// Distances that rounding cannot tell from a touch, as a share of the largest relative coordinate.
constexpr double kTouchTolerance = 64.0 * kUnitRoundoff;

/// How long from `time` on a plane across the unit vector `direction` certainly keeps the primitives apart: a time up
/// to 1, infinity where they stay apart to the end, or -1 where not even at `time`.
///
/// Between a corner of the one and a corner of the other the height along `direction` is a linear function of time. As
/// long as all of these are positive, a plane lies between the primitives.
template <int FirstCount>
double apart_until(const RelativeMotion& motion, Vec3 direction, double time) {
  std::array<double, 4> at_start;
  std::array<double, 4> at_end;
  for (int i = 0; i < 4; ++i) {
    at_start[i] = dot(direction, motion.from[i]);
    at_end[i] = dot(direction, motion.to[i]);
  }
  // To first order 10 units for a difference of heights and 6 for its interpolation.
  const double rounding = 32.0 * kUnitRoundoff * sum_of_sizes(direction) * motion.size;
  double until = std::numeric_limits<double>::infinity();
  for (int i = 0; i < FirstCount; ++i) {
    for (int j = FirstCount; j < 4; ++j) {
      const double start = at_start[i] - at_start[j] - rounding;
      const double end = at_end[i] - at_end[j] - rounding;
      if (!(lerp(start, end, time) > 0.0)) {
        return -1.0;
      }
      if (!(end > 0.0)) {
        until = std::min(until, start / (start - end) * (1.0 - 8.0 * kUnitRoundoff));
      }
    }
  }
  return until;
}

/// A box of times and places on the primitives, and the vectors between the places in its corners. The vector is linear
/// in each of the three alone, so that all its values lie in the hull of those in the corners.
struct ParameterBox {
  std::array<double, 3> low =
      {};  ///< time; along the first edge, or to the second corner; along the other, or to the third
  std::array<double, 3> high = {};
};

template <int FirstCount>
std::array<Vec3, 8> corners_of(const RelativeMotion& motion, const ParameterBox& box) {
  std::array<Vec3, 8> corners;
  for (int k = 0; k < 8; ++k) {
    const double t = k & 1 ? box.high[0] : box.low[0];
    const double u = k & 2 ? box.high[1] : box.low[1];
    const double v = k & 4 ? box.high[2] : box.low[2];
    const std::array<Vec3, 4> p = motion.at(t);
    corners[k] = FirstCount == 2 ? lerp(p[0], p[1], u) - lerp(p[2], p[3], v)
                                 : p[0] - p[1] - u * (p[2] - p[1]) - v * (p[3] - p[1]);
  }
  return corners;
}

/// Whether a plane across `direction` has all corners on its far side, seen from 0.
bool excludes_zero(const std::array<Vec3, 8>& corners, Vec3 direction, double rounding) {
  return std::all_of(corners.begin(), corners.end(),
                     [&](Vec3 c) { return dot(direction, c) > rounding * sum_of_sizes(direction); });
}

/// By halving boxes of the parameters from `time` on until none can hold a touch or one cannot be told from a touch
/// (after Wang et al. 2021). For motions that keep so close that advancing does not come to an end.
template <int FirstCount>
Touch first_touch_by_boxes(const RelativeMotion& motion, double time) {
  constexpr int kMostBoxes = 2048;
  // A corner rounds by at most 24 units to first order, its product with a direction by 3 more.
  const double rounding = 32.0 * kUnitRoundoff * motion.size;
  std::vector<ParameterBox> boxes = {{{time, 0.0, 0.0}, {1.0, 1.0, 1.0}}};
  for (int tested = 0; !boxes.empty(); ++tested) {
    const ParameterBox box = boxes.back();
    const auto earliest = [&] {
      double least = 1.0;
      for (const ParameterBox& b : boxes) {
        least = std::min(least, b.low[0]);
      }
      return least;
    };
    if (tested == kMostBoxes) {
      return {true, earliest(), true};
    }
    const std::array<Vec3, 8> corners = corners_of<FirstCount>(motion, box);
    Vec3 middle;
    double largest = 0.0;
    for (const Vec3& c : corners) {
      middle += c;
      largest = std::max({largest, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    }
    const double middle_size = length(middle);
    const bool beyond_triangle = FirstCount == 1 && box.low[1] + box.low[2] > 1.0 + 4.0 * kUnitRoundoff;
    if (beyond_triangle || (middle_size > 0.0 && excludes_zero(corners, middle / middle_size, rounding)) ||
        excludes_zero(corners, {1, 0, 0}, rounding) || excludes_zero(corners, {-1, 0, 0}, rounding) ||
        excludes_zero(corners, {0, 1, 0}, rounding) || excludes_zero(corners, {0, -1, 0}, rounding) ||
        excludes_zero(corners, {0, 0, 1}, rounding) || excludes_zero(corners, {0, 0, -1}, rounding)) {
      boxes.pop_back();
      continue;
    }
    std::array<double, 3> change = {};  // across the box, along each parameter
    for (int k = 0; k < 8; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 d = corners[k] - corners[k ^ (1 << axis)];
        change[axis] = std::max({change[axis], std::abs(d.x), std::abs(d.y), std::abs(d.z)});
      }
    }
    const auto axis = static_cast<std::size_t>(std::max_element(change.begin(), change.end()) - change.begin());
    const double middle_value = 0.5 * (box.low[axis] + box.high[axis]);
    if (largest <= kTouchTolerance * motion.size || !(box.low[axis] < middle_value && middle_value < box.high[axis])) {
      return {true, earliest(), false};
    }
    boxes.back().low[axis] = middle_value;
    boxes.push_back(box);
    boxes.back().high[axis] = middle_value;  // the earlier half first
  }
  return {};
}

/// The unit vector from the second nearest point to the first. Of a short vector rounding leaves no good direction, but
/// it is square to the triangle or edges between whose ends the nearest points lie, and those are not short.
template <int FirstCount>
Vec3 direction_between(const std::array<Vec3, 4>& points, const Nearest& nearest, double size) {
  Vec3 direction = nearest.difference / nearest.distance;
  if (nearest.distance > 1e-5 * size) {
    return direction;
  }
  std::array<Vec3, 2> sides;  // along which the nearest points are free to move
  int side_count = 0;
  const std::array<double, 4>& w = nearest.weights;
  if (FirstCount == 2) {
    for (int k = 0; k < 4; k += 2) {
      if (w[k] != 0.0 && w[k + 1] != 0.0) {
        sides[side_count++] = points[k + 1] - points[k];
      }
    }
  } else {
    for (int k = 2; k < 4; ++k) {
      const int other = w[1] != 0.0 ? 1 : 2;
      if (w[k] != 0.0 && k != other) {
        sides[side_count++] = points[k] - points[other];
      }
    }
  }
  if (side_count == 2) {
    const Vec3 across = cross(sides[0], sides[1]);
    const double across_size = length(across);
    if (across_size > 1e-5 * length(sides[0]) * length(sides[1])) {
      // Which side the first is on: of all differences of corners, the one across the nearest points.
      const double height = dot(across, FirstCount == 1 ? points[0] - points[1] : points[0] - points[2]);
      direction = across / (height < 0.0 ? -across_size : across_size);
    }
  } else if (side_count == 1) {
    const Vec3 side = normalized(sides[0]);
    direction = normalized(direction - dot(direction, side) * side);
  }
  return direction;
}

/// By planes between the primitives: each certainly separates for a while, then another one is asked for. Whatever the
/// nearest points are worth from which they are guessed, a plane counts only as long as it certainly separates, so no
/// rounding can skip a touch.
///
/// The plane across the nearest points of the present would bring us ever nearer to a touch by a share of what is left,
/// as turning primitives reach it with their far corners first. That of a time just before the touch holds until close
/// to the touch, and the error shrinks about quadratically.
template <int FirstCount>
Touch first_touch(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to) {
  constexpr int kMostPlanes = 512;  // one is usual for a miss, seven for a touch; turns of a radian take dozens
  constexpr double kTimeTolerance = 1e-10;
  const RelativeMotion motion(from, to);
  if (!(motion.size > 1e-100 && motion.size < 1e100)) {
    return {true, 0.0, motion.size != 0.0};  // beyond the range in which rounding is relative
  }
  double time = 0.0;       // apart until then
  double probe = 0.0;      // the time whose nearest points are asked for
  double touch_at = 2.0;   // cannot be told from a touch then
  double left_out = 1e-1;  // share of the way to the expected touch
  double trust = 1.0;      // in the way to the expected touch, as a share of it
  for (int k = 0; k < kMostPlanes; ++k) {
    const std::array<Vec3, 4> points = probe == 0.0 ? motion.from : motion.at(probe);
    const Nearest nearest =
        FirstCount == 1 ? nearest_vertex_triangle_by_regions(points) : nearest_edge_edge_by_lines(points);
    if (nearest.distance <= kTouchTolerance * motion.size) {
      touch_at = probe;
      if (touch_at - time <= kTimeTolerance) {
        return {true, time, false};
      }
      probe = 0.5 * (time + touch_at);
      continue;
    }
    const Vec3 direction = direction_between<FirstCount>(points, nearest, motion.size);
    const double until = apart_until<FirstCount>(motion, direction, time);
    if (until > 1.0) {
      return {};
    }
    if (until > time) {
      time = until;
      if (touch_at - time <= kTimeTolerance) {
        return {true, time, false};
      }
      double approach = 0.0;
      for (int i = 0; i < 4; ++i) {
        approach -= nearest.weights[i] * dot(direction, motion.to[i] - motion.from[i]);
      }
      const double expected = approach > 0.0 ? probe + trust * (1.0 - left_out) * nearest.distance / approach : time;
      left_out = std::max(0.1 * left_out, 1e-3);
      trust = std::min(1.0, 2.0 * trust);
      probe = std::clamp(expected, time, std::max(time, std::min(touch_at, 1.0)));
    } else if (probe > time) {
      // The guess was beyond the touch, or too far ahead for its plane to separate already now.
      probe = probe - time > kTimeTolerance ? 0.5 * (time + probe) : time;
      trust *= 0.5;
    } else {
      break;
    }
  }
  return touch_at <= 1.0 ? Touch{true, time, false} : first_touch_by_boxes<FirstCount>(motion, time);
}

}  // namespace

Nearest nearest_vertex_triangle(const std::array<Vec3, 4>& points) {
  const Nearest nearest = nearest_vertex_triangle_by_regions(points);
  return is_nearest<1>(points, nearest) ? nearest : nearest_vertex_triangle_of_all(points);
}

Nearest nearest_edge_edge(const std::array<Vec3, 4>& points) {
  const Nearest nearest = nearest_edge_edge_by_lines(points);
  return is_nearest<2>(points, nearest) ? nearest : nearest_edge_edge_of_all(points, nearest);
}

Touch first_touch_vertex_triangle(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to) {
  return first_touch<1>(from, to);
}

Touch first_touch_edge_edge(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to) {
  return first_touch<2>(from, to);
}

}  // namespace anthesis
