#include "triangle_pair.h"

#include <algorithm>
#include <cmath>

namespace anthesis::detail {
namespace {

using Corners = std::array<Vec3, 3>;

/// `p` without its coordinate `axis`.
Vec2 drop(Vec3 p, int axis) {
  return axis == 0 ? Vec2{p.y, p.z} : axis == 1 ? Vec2{p.z, p.x} : Vec2{p.x, p.y};
}

int turn(Vec3 a, Vec3 b, Vec3 c, int axis) {
  return orient2d(drop(a, axis), drop(b, axis), drop(c, axis));
}

/// The coordinate without which the plane of three points keeps its area; -1 if they are in one line.
int flattening_axis(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 normal = cross(b - a, c - a);
  const Vec3 size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
  const int likely = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  for (int k = 0; k < 3; ++k) {
    const int axis = (likely + k) % 3;
    if (turn(a, b, c, axis) != 0) {
      return axis;
    }
  }
  return -1;
}

/// The order of points along any line that holds them.
bool before(Vec3 a, Vec3 b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

Vec3 middle(Vec3 a, Vec3 b) {
  return 0.5 * a + 0.5 * b;
}

bool ranges_meet(double a, double b, double c, double d) {
  return std::max(std::min(a, b), std::min(c, d)) <= std::min(std::max(a, b), std::max(c, d));
}

/// Where two segments that meet in a plane do so, nearly.
Vec3 meeting_place(Vec3 p, Vec3 q, Vec3 r, Vec3 s) {
  const Vec3 pq = q - p;
  const Vec3 rs = s - r;
  const Vec3 normal = cross(pq, rs);
  const double squared = dot(normal, normal);
  if (squared > 0.0) {
    return lerp(p, q, std::clamp(dot(cross(r - p, rs), normal) / squared, 0.0, 1.0));
  }
  // In one line: the middle of what they share.
  std::array<Vec3, 4> ends = {p, q, r, s};
  std::sort(ends.begin(), ends.end(), before);
  return middle(ends[1], ends[2]);
}

/// Segments whose ends lie in one plane that keeps its area without coordinate `axis`. Points are segments too.
bool segments_meet_in_plane(Vec3 p, Vec3 q, Vec3 r, Vec3 s, int axis, Vec3& place) {
  const int pqr = turn(p, q, r, axis);
  const int pqs = turn(p, q, s, axis);
  if (pqr * pqs > 0) {
    return false;
  }
  const int rsp = turn(r, s, p, axis);
  const int rsq = turn(r, s, q, axis);
  if (rsp * rsq > 0) {
    return false;
  }
  if (pqr == 0 && pqs == 0 && rsp == 0 && rsq == 0) {
    const Vec2 a = drop(p, axis);
    const Vec2 b = drop(q, axis);
    const Vec2 c = drop(r, axis);
    const Vec2 d = drop(s, axis);
    if (!ranges_meet(a.x, b.x, c.x, d.x) || !ranges_meet(a.y, b.y, c.y, d.y)) {
      return false;
    }
  }
  place = meeting_place(p, q, r, s);
  return true;
}

bool segments_meet(Vec3 p, Vec3 q, Vec3 r, Vec3 s, Vec3& place) {
  if (orient3d(p, q, r, s) != 0) {
    return false;
  }
  for (const Corners& three : {Corners{p, q, r}, Corners{p, q, s}, Corners{p, r, s}, Corners{q, r, s}}) {
    const int axis = flattening_axis(three[0], three[1], three[2]);
    if (axis >= 0) {
      return segments_meet_in_plane(p, q, r, s, axis, place);
    }
  }
  // All in one line: each coordinate grows, falls or stands still along it.
  if (!ranges_meet(p.x, q.x, r.x, s.x) || !ranges_meet(p.y, q.y, r.y, s.y) || !ranges_meet(p.z, q.z, r.z, s.z)) {
    return false;
  }
  place = meeting_place(p, q, r, s);
  return true;
}

/// A point in the plane of a triangle, seen without coordinate `axis`.
bool point_in_triangle(Vec3 p, const Corners& t, int axis) {
  const int ab = turn(t[0], t[1], p, axis);
  const int bc = turn(t[1], t[2], p, axis);
  const int ca = turn(t[2], t[0], p, axis);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

/// A segment in the plane of a triangle.
bool coplanar_segment_meets(Vec3 p, Vec3 q, const Corners& t, Vec3& place) {
  const int axis = flattening_axis(t[0], t[1], t[2]);
  const bool p_in = point_in_triangle(p, t, axis);
  const bool q_in = point_in_triangle(q, t, axis);
  if (p_in || q_in) {
    place = p_in && q_in ? middle(p, q) : p_in ? p : q;
    return true;
  }
  for (int k = 0; k < 3; ++k) {
    if (segments_meet_in_plane(p, q, t[k], t[(k + 1) % 3], axis, place)) {
      return true;
    }
  }
  return false;
}

/// A segment and a triangle that has an area; `p_side` and `q_side` say on which side of its plane the ends are.
bool segment_meets(Vec3 p, int p_side, Vec3 q, int q_side, const PlaneSide& triangle, Vec3& place) {
  if (p_side * q_side > 0) {
    return false;
  }
  const Corners& t = triangle.corners();
  if (p_side == 0 && q_side == 0) {
    return coplanar_segment_meets(p, q, t, place);
  }
  // The line meets the plane in one point, within the segment: is it within the triangle?
  const int ab = orient3d(p, q, t[0], t[1]);
  const int bc = orient3d(p, q, t[1], t[2]);
  if (ab * bc < 0) {
    return false;
  }
  const int ca = orient3d(p, q, t[2], t[0]);
  if (ab * ca < 0 || bc * ca < 0) {
    return false;
  }
  const double p_height = std::fabs(dot(triangle.normal(), p - t[0]));
  const double q_height = std::fabs(dot(triangle.normal(), q - t[0]));
  const double sum = p_height + q_height;
  place = lerp(p, q, sum > 0.0 ? p_height / sum : 0.5);
  return true;
}

bool segment_meets(Vec3 p, Vec3 q, const PlaneSide& triangle, Vec3& place) {
  return segment_meets(p, triangle(p), q, triangle(q), triangle, place);
}

/// True if both are on one side and not in the plane.
bool same_side(int a, int b) {
  return a * b > 0;
}

/// Triangles with area and without common vertices.
[[gnu::noinline]] bool apart_triangles_meet(const PlaneSide& one, const PlaneSide& other, Vec3& place) {
  const Corners& a = one.corners();
  const Corners& b = other.corners();
  const std::array<int, 3> b_side = {one(b[0]), one(b[1]), one(b[2])};
  if (same_side(b_side[0], b_side[1]) && same_side(b_side[0], b_side[2])) {
    return false;
  }
  const std::array<int, 3> a_side = {other(a[0]), other(a[1]), other(a[2])};
  if (same_side(a_side[0], a_side[1]) && same_side(a_side[0], a_side[2])) {
    return false;
  }
  // Where two triangles meet, an edge of one meets the other.
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (segment_meets(b[k], b_side[k], b[next], b_side[next], one, place) ||
        segment_meets(a[k], a_side[k], a[next], a_side[next], other, place)) {
      return true;
    }
  }
  return false;
}

/// Triangles with area that have one common vertex: corner i of the one, corner j of the other. A common point
/// elsewhere can be moved away from that vertex until it leaves one of the triangles, through the edge opposite the
/// vertex.
[[gnu::noinline]] bool fan_triangles_cross(const PlaneSide& one, int i, const PlaneSide& other, int j, Vec3& place) {
  const Vec3 p = one.corners()[(i + 1) % 3];
  const Vec3 q = one.corners()[(i + 2) % 3];
  const Vec3 r = other.corners()[(j + 1) % 3];
  const Vec3 s = other.corners()[(j + 2) % 3];
  const int r_side = one(r);
  const int s_side = one(s);
  if (same_side(r_side, s_side)) {
    return false;
  }
  const int p_side = other(p);
  const int q_side = other(q);
  if (same_side(p_side, q_side)) {
    return false;
  }
  return segment_meets(r, r_side, s, s_side, one, place) || segment_meets(p, p_side, q, q_side, other, place);
}

/// Triangles with area that have the edge opposite corner `apex` in common: they overlap if they lie in one plane, on
/// one side of that edge.
bool folded_flat(const PlaneSide& one, int apex, Vec3 other_apex, Vec3& place) {
  if (one(other_apex) != 0) {
    return false;
  }
  const Vec3 a = one.corners()[(apex + 1) % 3];
  const Vec3 b = one.corners()[(apex + 2) % 3];
  const Vec3 c = one.corners()[apex];
  const int axis = flattening_axis(a, b, c);
  if (turn(a, b, c, axis) != turn(a, b, other_apex, axis)) {
    return false;
  }
  place = middle(a, b);
  return true;
}

/// A triangle without area, as the segment it is.
struct Segment {
  Vec3 from;
  Vec3 to;
};

Segment as_segment(const Corners& t) {
  return {std::min({t[0], t[1], t[2]}, before), std::max({t[0], t[1], t[2]}, before)};
}

/// The segment from `v` to `end` and another set that is convex and holds `v`: have they more than `v` in common?
bool ray_meets_beyond(Vec3 v, Vec3 end, Vec3 far_end, Vec3& place) {
  if (end == v || far_end == v || before(v, end) != before(v, far_end) || !collinear(v, end, far_end)) {
    return false;
  }
  place = middle(v, before(end, far_end) == before(v, end) ? end : far_end);
  return true;
}

/// The same for a triangle whose corner k is `v`: it is left through the far end of the segment or the opposite edge.
bool ray_meets_beyond(Vec3 end, const PlaneSide& triangle, int k, Vec3& place) {
  const Corners& t = triangle.corners();
  if (end == t[k]) {
    return false;
  }
  return segment_meets(end, end, triangle, place) || segments_meet(t[k], end, t[(k + 1) % 3], t[(k + 2) % 3], place);
}

/// The vertices that two triangles have in common: corner one[i] of the one is corner other[i] of the other.
struct Common {
  int count = 0;
  std::array<int, 3> one = {};
  std::array<int, 3> other = {};
};

Common common_vertices(const PlacedTriangle& one, const PlacedTriangle& other) {
  Common common;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t vertex = one.vertex[i];
    const bool again = (i > 0 && vertex == one.vertex[0]) || (i > 1 && vertex == one.vertex[1]);
    for (int j = 0; j < 3 && !again; ++j) {
      if (vertex == other.vertex[j]) {
        common.one[common.count] = i;
        common.other[common.count] = j;
        ++common.count;
        break;
      }
    }
  }
  return common;
}

/// Triangles of which one at least has no area.
bool degenerate_cross(const PlacedTriangle& one, const PlacedTriangle& other, const Common& common, Vec3& place) {
  if (!one.degenerate) {
    return degenerate_cross(other, one, {common.count, common.other, common.one}, place);
  }
  const Segment a = as_segment(one.plane.corners());
  if (!other.degenerate) {
    switch (common.count) {
      case 0:
        return segment_meets(a.from, a.to, other.plane, place);
      case 1:
        return ray_meets_beyond(a.from, other.plane, common.other[0], place) ||
               ray_meets_beyond(a.to, other.plane, common.other[0], place);
      default:
        return false;  // a triangle with area has no more than the edge in common with the line of its edge
    }
  }
  const Segment b = as_segment(other.plane.corners());
  if (common.count == 0) {
    return segments_meet(a.from, a.to, b.from, b.to, place);
  }
  const Vec3 v = one.plane.corners()[common.one[0]];
  if (common.count == 1) {
    return ray_meets_beyond(v, a.from, b.from, place) || ray_meets_beyond(v, a.from, b.to, place) ||
           ray_meets_beyond(v, a.to, b.from, place) || ray_meets_beyond(v, a.to, b.to, place);
  }
  // All in one line: do both reach beyond the same end of the edge?
  const Vec3 w = one.plane.corners()[common.one[1]];
  const Vec3 low = std::min(v, w, before);
  const Vec3 high = std::max(v, w, before);
  if (before(a.from, low) && before(b.from, low)) {
    place = middle(std::max(a.from, b.from, before), low);
    return true;
  }
  if (before(high, a.to) && before(high, b.to)) {
    place = middle(std::min(a.to, b.to, before), high);
    return true;
  }
  return false;
}

/// Triangles of which one at least has no area, or with two or three common vertices.
[[gnu::noinline]] bool entangled_cross(const PlacedTriangle& one, const PlacedTriangle& other, Vec3& place) {
  const Common common = common_vertices(one, other);
  const Corners& corners = one.plane.corners();
  if (common.count == 3) {
    place = (corners[0] + corners[1] + corners[2]) / 3.0;
    return true;
  }
  if (one.degenerate || other.degenerate) {
    return degenerate_cross(one, other, common, place);
  }
  const int apex = 3 - common.one[0] - common.one[1];
  const int other_apex = 3 - common.other[0] - common.other[1];
  return folded_flat(one.plane, apex, other.plane.corners()[other_apex], place);
}

}  // namespace

bool collinear(Vec3 a, Vec3 b, Vec3 c) {
  return flattening_axis(a, b, c) < 0;
}

bool triangles_cross(const PlacedTriangle& one, const PlacedTriangle& other, Vec3& place) {
  // Nearly all pairs that come here are not degenerate and have nothing in common, or one vertex; and one of them is on
  // one side of the other's plane, which ordinary arithmetic can tell. What follows decides all others.
  const auto [a, b, c] = one.vertex;
  const auto [d, e, f] = other.vertex;
  const bool d_common = (d == a) | (d == b) | (d == c);
  const bool e_common = (e == a) | (e == b) | (e == c);
  const bool f_common = (f == a) | (f == b) | (f == c);
  if (!(one.degenerate | other.degenerate)) {
    const Corners& corners = other.plane.corners();
    const int d_side = one.plane.quick(corners[0]);
    const int e_side = one.plane.quick(corners[1]);
    const int f_side = one.plane.quick(corners[2]);
    const int common = d_common + e_common + f_common;
    // A common vertex is in the plane and counts for either side.
    const int above = (d_common | (d_side > 0)) & (e_common | (e_side > 0)) & (f_common | (f_side > 0));
    const int below = (d_common | (d_side < 0)) & (e_common | (e_side < 0)) & (f_common | (f_side < 0));
    if ((above | below) & (common < 3)) {
      return false;
    }
    if (common < 2) {
      return common == 0 ? apart_triangles_meet(one.plane, other.plane, place)
                         : fan_triangles_cross(one.plane,
                                               a == d || a == e || a == f   ? 0
                                               : b == d || b == e || b == f ? 1
                                                                            : 2,
                                               other.plane,
                                               d_common   ? 0
                                               : e_common ? 1
                                                          : 2,
                                               place);
    }
  }
  return entangled_cross(one, other, place);
}

}  // namespace anthesis::detail
