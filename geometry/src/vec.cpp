#include "anthesis/geometry/vec.h"

#include "anthesis/base/math.h"

namespace anthesis {

Vec3 any_perpendicular(Vec3 a) {
  // Crossing with the axis of the smallest component keeps the product far from zero.
  const double x = std::abs(a.x);
  const double y = std::abs(a.y);
  const double z = std::abs(a.z);
  const Vec3 axis = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return normalized(cross(a, axis));
}

Quaternion normalized(Quaternion q) {
  const double size = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / size, q.x / size, q.y / size, q.z / size};
}

Vec3 rotate(Quaternion q, Vec3 v) {
  const Vec3 axis{q.x, q.y, q.z};
  const Vec3 twice = 2.0 * cross(axis, v);
  return v + q.w * twice + cross(axis, twice);
}

Quaternion rotation_about(Vec3 axis, double angle_rad) {
  const auto [s, c] = math::sin_cos(0.5 * angle_rad);
  return {c, s * axis.x, s * axis.y, s * axis.z};
}

Quaternion rotation_between(Vec3 from, Vec3 to, Vec3 fallback_axis) {
  const double cosine = dot(from, to);
  if (cosine < -1.0 + 1e-14) {
    return {0.0, fallback_axis.x, fallback_axis.y, fallback_axis.z};
  }
  const Vec3 axis = cross(from, to);
  return normalized(Quaternion{1.0 + cosine, axis.x, axis.y, axis.z});
}

Quaternion rotation_from_axes(Vec3 x, Vec3 y, Vec3 z) {
  // The largest of the four squared components is found first, so that no division is by a small number (Shepperd
  // 1978).
  const double trace = x.x + y.y + z.z;
  Quaternion q;
  if (trace >= x.x && trace >= y.y && trace >= z.z) {
    q = {1.0 + trace, y.z - z.y, z.x - x.z, x.y - y.x};
  } else if (x.x >= y.y && x.x >= z.z) {
    q = {y.z - z.y, 1.0 + x.x - y.y - z.z, y.x + x.y, z.x + x.z};
  } else if (y.y >= z.z) {
    q = {z.x - x.z, y.x + x.y, 1.0 - x.x + y.y - z.z, z.y + y.z};
  } else {
    q = {x.y - y.x, z.x + x.z, z.y + y.z, 1.0 - x.x - y.y + z.z};
  }
  return normalized(q);
}

Quaternion slerp(Quaternion a, Quaternion b, double t) {
  double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  if (cosine < 0.0) {
    b = {-b.w, -b.x, -b.y, -b.z};
    cosine = -cosine;
  }
  if (t == 0.0) {
    return a;
  }
  if (t == 1.0) {
    return b;
  }
  double from = 1.0 - t;
  double to = t;
  if (cosine < 1.0 - 1e-12) {  // below this angle the chord is the arc
    const double angle = math::acos(cosine);
    const double whole = math::sin(angle);
    from = math::sin((1.0 - t) * angle) / whole;
    to = math::sin(t * angle) / whole;
  }
  return normalized(
      Quaternion{from * a.w + to * b.w, from * a.x + to * b.x, from * a.y + to * b.y, from * a.z + to * b.z});
}

Placement operator*(const Placement& a, const Placement& b) {
  return {apply(a, b.position_mm), a.rotation * b.rotation, a.scale * b.scale};
}

}  // namespace anthesis
