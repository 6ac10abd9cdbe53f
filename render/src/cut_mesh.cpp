#include "cut_mesh.h"

#include <algorithm>
#include <map>
#include <utility>

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

LabelledMesh cut(const LabelledMesh& from, const CutPlane& plane) {
  const Mesh& mesh = from.mesh;
  LabelledMesh result;
  const auto add = [&](Vec3 position, Vec3 normal, std::uint8_t label) {
    result.mesh.positions_mm.push_back(position);
    result.mesh.normals.push_back(normal);
    result.labels.push_back(label);
    return static_cast<std::uint32_t>(result.mesh.positions_mm.size() - 1);
  };
  constexpr std::uint32_t kGone = ~0U;
  std::vector<double> beyond(mesh.positions_mm.size());
  std::vector<std::uint32_t> kept(mesh.positions_mm.size(), kGone);
  for (std::size_t i = 0; i < beyond.size(); ++i) {
    beyond[i] = dot(plane.normal, mesh.positions_mm[i]) - plane.distance;
    if (beyond[i] <= 0.0) {
      kept[i] = add(mesh.positions_mm[i], mesh.normals[i], from.labels[i]);
    }
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> crossings;  // of edges, by their ends
  const auto crossing = [&](std::uint32_t near, std::uint32_t far) {
    const auto [place, added] = crossings.try_emplace(std::minmax(near, far), 0U);
    if (added) {
      const double t = beyond[near] / (beyond[near] - beyond[far]);
      place->second = add(lerp(mesh.positions_mm[near], mesh.positions_mm[far], t),
                          normalized(lerp(mesh.normals[near], mesh.normals[far], t)),
                          std::min(from.labels[near], from.labels[far]));
    }
    return place->second;
  };
  std::map<std::uint32_t, std::uint32_t> next;  // along the borders of the faces, which lie to the left
  for (const Triangle& triangle : mesh.triangles) {
    std::array<std::uint32_t, 4> corners{};
    std::size_t count = 0;
    std::uint32_t leaves = kGone;
    std::uint32_t returns = kGone;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k];
      const std::uint32_t b = triangle[(k + 1) % 3];
      if (kept[a] != kGone) {
        corners[count++] = kept[a];
      }
      if (kept[a] != kGone && kept[b] == kGone) {
        corners[count++] = leaves = crossing(a, b);
      } else if (kept[a] == kGone && kept[b] != kGone) {
        corners[count++] = returns = crossing(b, a);
      }
    }
    for (std::size_t k = 2; k < count; ++k) {
      result.mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
    if (leaves != kGone) {
      next[returns] = leaves;
    }
  }

  const Vec3 across = any_perpendicular(plane.normal);
  const Vec3 along = cross(plane.normal, across);
  while (!next.empty()) {
    std::vector<std::uint32_t> border;
    for (auto step = next.begin(); step != next.end(); step = next.find(border.back())) {
      border.push_back(step->second);
      next.erase(step);
    }
    std::vector<Vec2> polygon;
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t i : border) {
      const Vec3 p = result.mesh.positions_mm[i];
      polygon.push_back({dot(p, across), dot(p, along)});
      corners.push_back(add(p, plane.normal, result.labels[i]));
    }
    for (const auto& [a, b, c] : triangulate_polygon(polygon)) {
      result.mesh.triangles.push_back({corners[a], corners[b], corners[c]});
    }
  }
  return result;
}

}  // namespace anthesis
