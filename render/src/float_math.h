#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "anthesis/corolla/pigment.h"
#include "anthesis/geometry/vec.h"

/// Single precision vectors and functions for the inner loops. Only +, -, *, / and square roots: the same bits on every
/// processor, and cheap.
namespace anthesis {

struct Vec3f {
  float x = 0.0F;
  float y = 0.0F;
  float z = 0.0F;

  constexpr Vec3f() = default;
  constexpr Vec3f(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
  constexpr explicit Vec3f(float all) : x(all), y(all), z(all) {}
  explicit Vec3f(Vec3 v) : x(static_cast<float>(v.x)), y(static_cast<float>(v.y)), z(static_cast<float>(v.z)) {}
  explicit Vec3f(Colour c) : x(static_cast<float>(c.r)), y(static_cast<float>(c.g)), z(static_cast<float>(c.b)) {}

  friend constexpr Vec3f operator+(Vec3f a, Vec3f b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3f operator-(Vec3f a, Vec3f b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3f operator-(Vec3f a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3f operator*(float k, Vec3f a) { return {k * a.x, k * a.y, k * a.z}; }
  friend constexpr Vec3f operator*(Vec3f a, Vec3f b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
};

constexpr Vec3f& operator+=(Vec3f& a, Vec3f b) {
  return a = a + b;
}
constexpr Vec3f& operator*=(Vec3f& a, Vec3f b) {
  return a = a * b;
}
constexpr float dot(Vec3f a, Vec3f b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3f cross(Vec3f a, Vec3f b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(Vec3f a) {
  return std::sqrt(dot(a, a));
}
inline Vec3f normalized(Vec3f a) {
  const float size = length(a);
  return size > 0.0F ? (1.0F / size) * a : Vec3f(0.0F, 0.0F, 1.0F);
}
constexpr float max_channel(Vec3f c) {
  return std::max({c.x, c.y, c.z});
}
constexpr float luminance(Vec3f c) {
  return 0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z;
}

/// Two unit vectors that complete the unit vector n to a right-handed frame (Duff et al. 2017).
struct Frame {
  Vec3f x;
  Vec3f y;
  Vec3f z;

  explicit Frame(Vec3f n) : z(n) {
    const float sign = n.z >= 0.0F ? 1.0F : -1.0F;
    const float a = -1.0F / (sign + n.z);
    const float b = n.x * n.y * a;
    x = {1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x};
    y = {b, sign + n.y * n.y * a, -n.y};
  }
  Vec3f from_local(Vec3f v) const { return v.x * x + v.y * y + v.z * z; }
  Vec3f to_local(Vec3f v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
};

inline constexpr float kPiF = 3.14159265F;

/// A point of the unit disc for a point of the unit square: equal areas, little distortion (Shirley and Chiu 1997).
/// Sine and cosine are needed within an eighth of a turn only, where short series are exact to single precision.
struct DiscPoint {
  float x;
  float y;
};
inline DiscPoint disc_from_square(float u, float v) {
  const float a = 2.0F * u - 1.0F;
  const float b = 2.0F * v - 1.0F;
  if (a == 0.0F && b == 0.0F) {
    return {0.0F, 0.0F};
  }
  const bool steep = std::abs(b) > std::abs(a);
  const float radius = steep ? b : a;
  const float t = 0.25F * kPiF * (steep ? a / b : b / a);
  const float t2 = t * t;
  const float sine = t * (1.0F - t2 * (1.0F / 6.0F) * (1.0F - t2 * (1.0F / 20.0F) * (1.0F - t2 * (1.0F / 42.0F))));
  const float cosine =
      1.0F - t2 * 0.5F * (1.0F - t2 * (1.0F / 12.0F) * (1.0F - t2 * (1.0F / 30.0F) * (1.0F - t2 * (1.0F / 56.0F))));
  return steep ? DiscPoint{radius * sine, radius * cosine} : DiscPoint{radius * cosine, radius * sine};
}

/// A direction about +z with density cos / pi.
inline Vec3f cosine_direction(float u, float v) {
  const DiscPoint d = disc_from_square(u, v);
  return {d.x, d.y, std::sqrt(std::max(0.0F, 1.0F - d.x * d.x - d.y * d.y))};
}

/// e^-x for x >= 0, within 2 percent where it matters for weights: (1 - x / 16)^16 until it ends.
inline float fast_fade(float x) {
  float y = std::max(0.0F, 1.0F - x * (1.0F / 16.0F));
  y *= y;
  y *= y;
  y *= y;
  return y * y;
}

inline float pow5(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

}  // namespace anthesis
