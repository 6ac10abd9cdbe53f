#include "polygon.h"

#include <algorithm>
#include <cstdint>

namespace anthesis {
namespace {

double turn(Vec2 a, Vec2 b, Vec2 c) {
  return cross(b - a, c - a);
}

bool inside(Vec2 p, Vec2 a, Vec2 b, Vec2 c) {
  return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
}

}  // namespace

std::vector<Triangle> triangulate_polygon(std::span<const Vec2> polygon) {
  std::vector<Triangle> triangles;
  if (polygon.size() < 3) {
    return triangles;
  }
  std::vector<std::uint32_t> left(polygon.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) {
    left[i] = i;
  }
  std::size_t at = 0;
  std::size_t tried = 0;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    at %= n;
    const std::uint32_t a = left[(at + n - 1) % n];
    const std::uint32_t b = left[at];
    const std::uint32_t c = left[(at + 1) % n];
    const Vec2 pa = polygon[a];
    const Vec2 pb = polygon[b];
    const Vec2 pc = polygon[c];
    const bool ear = turn(pa, pb, pc) >= 0.0 && std::none_of(left.begin(), left.end(), [&](std::uint32_t i) {
                       const Vec2 p = polygon[i];
                       return p != pa && p != pb && p != pc && inside(p, pa, pb, pc);
                     });
    if (ear || tried >= n) {  // no ear at all: it crosses itself
      triangles.push_back({a, b, c});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
      tried = 0;
    } else {
      ++tried;
    }
    ++at;  // not the same corner again, which would make a fan of slivers
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace anthesis
