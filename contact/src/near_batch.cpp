#include "near_batch.h"

#include <cstdint>

// Highway compiles what lies between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set, by
// including this file again and again, and chooses while the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/near_batch.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// The same bits for every instruction set: only operations that IEEE 754 rounds exactly, no fused multiply-add, nothing
// across lanes, and no result of a division by zero that goes on.
HWY_BEFORE_NAMESPACE();
namespace anthesis::near_batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, NearBatch::kLanes>;
using V = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 operator-(V3 a, V3 b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 operator+(V3 a, V3 b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 operator*(V k, V3 a) {
  return {hn::Mul(k, a.x), hn::Mul(k, a.y), hn::Mul(k, a.z)};
}
HWY_INLINE V dot(V3 a, V3 b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE V sum_of_sizes(V3 a) {
  return hn::Add(hn::Add(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}
HWY_INLINE V largest_of(V3 a) {
  return hn::Max(hn::Max(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}
HWY_INLINE V3 load(const NearBatch::Lanes3& from, std::size_t lane) {
  const Tag d;
  return {hn::Load(d, from[0].data() + lane), hn::Load(d, from[1].data() + lane), hn::Load(d, from[2].data() + lane)};
}
HWY_INLINE V3 same(Vec3 v) {
  const Tag d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
HWY_INLINE V unit_share(V share) {
  const Tag d;
  return hn::Min(hn::Max(share, hn::Zero(d)), hn::Set(d, 1.0));
}
HWY_INLINE unsigned bits_of(Mask mask) {
  const Tag d;
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, mask, bits);
  return bits[0];
}

/// Whether the weights are certainly those of the nearest points, and whether a plane across what lies between them
/// parts the two for good: is_nearest and stay_apart of one pair, lane by lane.
template <int FirstCount>
HWY_INLINE void judge(NearBatch& batch, std::size_t lane, const V3 (&r)[3], const V (&weights)[4], Mask regular) {
  const Tag d;
  const V zero = hn::Zero(d);
  const V3 difference = (weights[0] * r[0] + weights[1] * r[1]) + weights[2] * r[2];
  const V distance = hn::Sqrt(dot(difference, difference));
  V extent = hn::Max(hn::Max(largest_of(r[0]), largest_of(r[1])), largest_of(r[2]));
  const V heights[4] = {dot(difference, r[0]), dot(difference, r[1]), dot(difference, r[2]), zero};
  V first = heights[0];
  V second = heights[3];
  V first_ever = first;
  V second_ever = second;
  V largest = extent;
  for (int k = 0; k < 4; ++k) {
    const V3 way = load(batch.ways[k], lane);
    const V further = dot(difference, way);
    const V reach = hn::Load(d, batch.reaches[k].data() + lane);
    const V around = hn::Mul(distance, reach);
    largest = hn::Max(hn::Max(largest, reach), sum_of_sizes(way));
    if (k < FirstCount) {
      const V ever = hn::Sub(hn::Add(heights[k], hn::Min(further, zero)), around);
      first = hn::Min(first, heights[k]);
      first_ever = k == 0 ? ever : hn::Min(first_ever, ever);
    } else {
      const V ever = hn::Add(hn::Add(heights[k], hn::Max(further, zero)), around);
      second = hn::Max(second, heights[k]);
      second_ever = k == FirstCount ? ever : hn::Max(second_ever, ever);
    }
  }
  const V3 first_ride = same(batch.rides[0]);
  const V3 second_ride = same(batch.rides[1]);
  first_ever = hn::Add(first_ever, hn::Min(dot(difference, first_ride), zero));
  second_ever = hn::Add(second_ever, hn::Max(dot(difference, second_ride), zero));
  largest = hn::Max(largest, hn::Max(sum_of_sizes(first_ride), sum_of_sizes(second_ride)));

  const V square = hn::Mul(distance, distance);
  const V least = hn::Sub(hn::Mul(square, hn::Set(d, 1.0 - 1e-9)),
                          hn::Mul(hn::Mul(hn::Set(d, 32.0 * kUnitRoundoff), distance), extent));
  const Mask sound = hn::And(regular, hn::Ge(hn::Sub(first, second), least));
  const V rounding = hn::Mul(hn::Mul(hn::Set(d, kApartRounding), sum_of_sizes(difference)), largest);
  const Mask apart = hn::Gt(hn::Sub(first_ever, second_ever), rounding);

  for (int k = 0; k < 4; ++k) {
    hn::Store(weights[k], d, batch.weights[k].data() + lane);
  }
  hn::Store(difference.x, d, batch.difference[0].data() + lane);
  hn::Store(difference.y, d, batch.difference[1].data() + lane);
  hn::Store(difference.z, d, batch.difference[2].data() + lane);
  hn::Store(distance, d, batch.distance.data() + lane);
  batch.sound |= bits_of(sound) << lane;
  batch.apart |= bits_of(apart) << lane;
}

/// The first three points as the last one sees them.
HWY_INLINE void look_from_last(const NearBatch& batch, std::size_t lane, V3 (&r)[3]) {
  const V3 last = load(batch.points[3], lane);
  for (int k = 0; k < 3; ++k) {
    r[k] = load(batch.points[k], lane) - last;
  }
}

/// As nearest_edge_edge_by_lines.
void edges(NearBatch& batch) {
  const Tag d;
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0);
  batch.sound = 0;
  batch.apart = 0;
  for (std::size_t lane = 0; lane < NearBatch::kLanes; lane += hn::Lanes(d)) {
    V3 r[3];
    look_from_last(batch, lane, r);
    const V3 first = r[1] - r[0];
    const V3 between = r[0] - r[2];
    const V3 second = {hn::Neg(r[2].x), hn::Neg(r[2].y), hn::Neg(r[2].z)};
    const V a = dot(first, first);
    const V e = dot(second, second);
    const V b = dot(first, second);
    const V c = dot(first, between);
    const V f = dot(second, between);
    const Mask regular = hn::And(hn::Gt(a, zero), hn::Gt(e, zero));
    const V safe_a = hn::IfThenElse(regular, a, one);
    const V safe_e = hn::IfThenElse(regular, e, one);
    const V denominator = hn::Sub(hn::Mul(a, e), hn::Mul(b, b));
    const Mask crosswise = hn::Gt(denominator, zero);
    V s = hn::Div(hn::Sub(hn::Mul(b, f), hn::Mul(c, e)), hn::IfThenElse(crosswise, denominator, one));
    s = hn::IfThenElse(crosswise, unit_share(s), hn::Set(d, 0.5));
    const V t = hn::Div(hn::Add(hn::Mul(b, s), f), safe_e);
    const V t_held = unit_share(t);
    // Where t had to be held back, s follows.
    const V at_end = hn::IfThenElse(hn::Lt(t, zero), hn::Neg(c), hn::Sub(b, c));
    const Mask held = hn::Or(hn::Lt(t, zero), hn::Gt(t, one));
    s = hn::IfThenElse(held, unit_share(hn::Div(at_end, safe_a)), s);
    const V weights[4] = {hn::Sub(one, s), s, hn::Sub(t_held, one), hn::Neg(t_held)};
    judge<2>(batch, lane, r, weights, regular);
  }
}

/// As nearest_vertex_triangle_by_regions: all regions at once, then the one that counts.
void vertex_triangle(NearBatch& batch) {
  const Tag d;
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0);
  batch.sound = 0;
  batch.apart = 0;
  for (std::size_t lane = 0; lane < NearBatch::kLanes; lane += hn::Lanes(d)) {
    V3 r[3];
    look_from_last(batch, lane, r);
    const V3 ab = r[2] - r[1];
    const V3 ac = {hn::Neg(r[1].x), hn::Neg(r[1].y), hn::Neg(r[1].z)};
    const V3 ap = r[0] - r[1];
    const V3 bp = r[0] - r[2];
    const V d1 = dot(ab, ap);
    const V d2 = dot(ac, ap);
    const V d3 = dot(ab, bp);
    const V d4 = dot(ac, bp);
    const V d5 = dot(ab, r[0]);
    const V d6 = dot(ac, r[0]);
    const V vc = hn::Sub(hn::Mul(d1, d4), hn::Mul(d3, d2));
    const V vb = hn::Sub(hn::Mul(d5, d2), hn::Mul(d1, d6));
    const V va = hn::Sub(hn::Mul(d3, d6), hn::Mul(d5, d4));
    const V d43 = hn::Sub(d4, d3);
    const V d56 = hn::Sub(d5, d6);
    const auto no_more = [&](V x) HWY_ATTR { return hn::Le(x, zero); };
    const auto no_less = [&](V x) HWY_ATTR { return hn::Ge(x, zero); };
    // From the last to be asked about to the first.
    const V inside = hn::Add(hn::Add(va, vb), vc);
    Mask regular = hn::Gt(inside, zero);
    V numerator = vb;  // of the second corner's share
    V other = vc;      // of the third one's
    V divisor = inside;
    const Mask on_bc =
        hn::And(hn::And(no_more(va), hn::And(no_less(d43), no_less(d56))), hn::Gt(hn::Add(d43, d56), zero));
    other = hn::IfThenElse(on_bc, d43, other);
    divisor = hn::IfThenElse(on_bc, hn::Add(d43, d56), divisor);
    const Mask on_ac = hn::And(hn::And(no_more(vb), hn::And(no_less(d2), no_more(d6))), hn::Gt(hn::Sub(d2, d6), zero));
    numerator = hn::IfThenElse(on_ac, zero, numerator);
    other = hn::IfThenElse(on_ac, d2, other);
    divisor = hn::IfThenElse(on_ac, hn::Sub(d2, d6), divisor);
    const Mask on_ab = hn::And(hn::And(no_more(vc), hn::And(no_less(d1), no_more(d3))), hn::Gt(hn::Sub(d1, d3), zero));
    numerator = hn::IfThenElse(on_ab, d1, numerator);
    other = hn::IfThenElse(on_ab, zero, other);
    divisor = hn::IfThenElse(on_ab, hn::Sub(d1, d3), divisor);
    const Mask at_c = hn::And(no_less(d6), hn::Le(d5, d6));
    const Mask at_b = hn::And(no_less(d3), hn::Le(d4, d3));
    const Mask at_a = hn::And(no_more(d1), no_more(d2));
    const Mask at_corner = hn::Or(at_a, hn::Or(at_b, at_c));
    regular = hn::Or(hn::Or(regular, at_corner), hn::Or(on_ab, hn::Or(on_ac, on_bc)));
    divisor = hn::IfThenElse(hn::Or(at_corner, hn::Le(divisor, zero)), one, divisor);
    V v = unit_share(hn::Div(numerator, divisor));
    V w = hn::Min(hn::Max(hn::Div(other, divisor), zero), one);
    const Mask only_bc = hn::AndNot(hn::Or(on_ac, on_ab), on_bc);
    v = hn::IfThenElse(only_bc, hn::Sub(one, w), v);
    w = hn::IfThenElse(only_bc, w, hn::Min(w, hn::Sub(one, v)));
    const Mask b_alone = hn::AndNot(at_a, at_b);
    const Mask c_alone = hn::AndNot(hn::Or(at_a, at_b), at_c);
    v = hn::IfThenElse(at_corner, hn::IfThenElse(b_alone, one, zero), v);
    w = hn::IfThenElse(at_corner, hn::IfThenElse(c_alone, one, zero), w);
    // Exactly 0 where the first corner has no part in it.
    const Mask without_a = hn::Or(hn::AndNot(at_corner, only_bc), hn::Or(b_alone, c_alone));
    const V u = hn::IfThenElse(without_a, zero, hn::Sub(hn::Add(v, w), one));
    const V weights[4] = {one, u, hn::Neg(v), hn::Neg(w)};
    judge<1>(batch, lane, r, weights, regular);
  }
}

}  // namespace anthesis::near_batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anthesis {
namespace near_batch {

HWY_EXPORT(edges);
HWY_EXPORT(vertex_triangle);

}  // namespace near_batch

void find_nearest_edges(NearBatch& batch) {
  HWY_DYNAMIC_DISPATCH(near_batch::edges)(batch);
}

void find_nearest_vertex_triangle(NearBatch& batch) {
  HWY_DYNAMIC_DISPATCH(near_batch::vertex_triangle)(batch);
}

}  // namespace anthesis
#endif  // HWY_ONCE
