#pragma once
#include <array>
#include <cmath>
#include <cstdint>

namespace anthesis {

struct Vec2 {
  double x = 0.0;
  double y = 0.0;

  friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2 operator-(Vec2 a) { return {-a.x, -a.y}; }
  friend constexpr Vec2 operator*(double k, Vec2 a) { return {k * a.x, k * a.y}; }
  friend constexpr Vec2 operator*(Vec2 a, double k) { return k * a; }
  friend constexpr Vec2 operator/(Vec2 a, double k) { return {a.x / k, a.y / k}; }
  friend constexpr bool operator==(Vec2, Vec2) = default;
};

struct Vec3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(double k, Vec3 a) { return {k * a.x, k * a.y, k * a.z}; }
  friend constexpr Vec3 operator*(Vec3 a, double k) { return k * a; }
  friend constexpr Vec3 operator/(Vec3 a, double k) { return {a.x / k, a.y / k, a.z / k}; }
  friend constexpr bool operator==(Vec3, Vec3) = default;
};

template <class V>
constexpr V& operator+=(V& a, V b) {
  return a = a + b;
}

constexpr double dot(Vec2 a, Vec2 b) {
  return a.x * b.x + a.y * b.y;
}
constexpr double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr double cross(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec2 a) {
  return std::sqrt(dot(a, a));
}
inline double length(Vec3 a) {
  return std::sqrt(dot(a, a));
}

/// Unit vector along `a`; the zero vector stays zero.
template <class V>
V normalized(V a) {
  const double size = length(a);
  return size > 0.0 ? a / size : a;
}

template <class V>
constexpr V lerp(V a, V b, double t) {
  return (1.0 - t) * a + t * b;
}

/// Some unit vector perpendicular to the unit vector `a`.
Vec3 any_perpendicular(Vec3 a);

/// A rotation, as a unit quaternion w + xi + yj + zk.
struct Quaternion {
  double w = 1.0;
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  /// First `b`, then `a`.
  friend constexpr Quaternion operator*(Quaternion a, Quaternion b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
  friend constexpr bool operator==(Quaternion, Quaternion) = default;
};

constexpr Quaternion conjugate(Quaternion q) {
  return {q.w, -q.x, -q.y, -q.z};
}
Quaternion normalized(Quaternion q);
Vec3 rotate(Quaternion q, Vec3 v);

/// Rotation by `angle_rad` about the unit vector `axis`, counter-clockwise seen from its tip.
Quaternion rotation_about(Vec3 axis, double angle_rad);

/// The smallest rotation that turns the unit vector `from` into the unit vector `to`. For opposite vectors the axis is
/// `fallback_axis`, a unit vector perpendicular to both.
Quaternion rotation_between(Vec3 from, Vec3 to, Vec3 fallback_axis);

/// The rotation whose images of the axes are the given right-handed orthonormal vectors.
Quaternion rotation_from_axes(Vec3 x, Vec3 y, Vec3 z);

/// Spherical interpolation along the shorter arc, at constant speed; t in [0, 1].
Quaternion slerp(Quaternion a, Quaternion b, double t);

/// Where a thing stands: scaled, then turned, then moved. `world_from_organ` and the like.
struct Placement {
  Vec3 position_mm;
  Quaternion rotation;
  double scale = 1.0;
};

inline Vec3 apply(const Placement& placement, Vec3 v) {
  return placement.position_mm + rotate(placement.rotation, placement.scale * v);
}

/// Placement a_from_c out of a_from_b and b_from_c.
Placement operator*(const Placement& a, const Placement& b);

}  // namespace anthesis
