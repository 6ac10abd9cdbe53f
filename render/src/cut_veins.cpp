#include "cut_veins.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace anthesis {
namespace {

constexpr double kShortest = 12.0;  // length of a piece that was cut off, in radii

/// Which vertices hang together.
class Pieces {
 public:
  explicit Pieces(std::size_t vertices) : next_(vertices) { std::iota(next_.begin(), next_.end(), 0U); }

  std::uint32_t of(std::uint32_t v) {
    while (next_[v] != v) {
      v = next_[v] = next_[next_[v]];
    }
    return v;
  }

  void join(std::uint32_t a, std::uint32_t b) { next_[of(a)] = of(b); }

 private:
  std::vector<std::uint32_t> next_;
};

/// Strands before they are cut.
struct Uncut {
  const Vasculature& veins;
  std::vector<double> beyond;  ///< of vertices, distance
  std::vector<double> reach;   ///< of vertices, the radius of the thickest edge

  Uncut(const Vasculature& all, const CutPlane& plane, const VeinCutParams& params)
      : veins(all), beyond(all.vertices.size()), reach(all.vertices.size(), 0.0) {
    for (std::size_t v = 0; v < beyond.size(); ++v) {
      const VeinVertex& vertex = veins.vertices[v];
      beyond[v] = dot(plane.normal, vertex.position) - plane.distance;
      if (vertex.parent != kNoVertex) {
        const double radius = std::min(params.most_reach_mm, 0.5 * params.radius_factor * vertex.diameter);
        reach[v] = std::max(reach[v], radius);
        reach[vertex.parent] = std::max(reach[vertex.parent], radius);
      }
    }
  }

  /// Of the edge between a vertex that stays and one that does not.
  double share_behind(std::uint32_t inner, std::uint32_t outer) const {
    return beyond[inner] < 0.0 ? beyond[inner] / (beyond[inner] - beyond[outer]) : 0.0;
  }

  /// What is behind the plane, and what comes out by less than `reach` between two such places or up to an end.
  std::vector<bool> stays() const {
    const std::size_t n = beyond.size();
    std::vector<bool> stays(n);
    for (std::size_t v = 0; v < n; ++v) {
      stays[v] = beyond[v] <= reach[v] || beyond[v] <= 0.0;
    }
    // Children one after the other.
    std::vector<std::uint32_t> first(n + 1, 0);
    for (const VeinVertex& vertex : veins.vertices) {
      if (vertex.parent != kNoVertex) {
        ++first[vertex.parent + 1];
      }
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> children(first[n]);
    std::vector<std::uint32_t> place(first.begin(), first.end() - 1);
    std::vector<std::uint32_t> neighbours(n, 0);  // that stay
    std::vector<bool> loses(n, false);            // one that does not
    for (std::uint32_t v = 0; v < n; ++v) {
      const std::uint32_t parent = veins.vertices[v].parent;
      if (parent == kNoVertex) {
        continue;
      }
      children[place[parent]++] = v;
      neighbours[v] += stays[parent] ? 1 : 0;
      neighbours[parent] += stays[v] ? 1 : 0;
      loses[v] = loses[v] || !stays[parent];
      loses[parent] = loses[parent] || !stays[v];
    }
    // What comes out and does not go back is eaten up from where it is lost.
    std::vector<std::uint32_t> eaten;
    const auto look_at = [&](std::uint32_t v) {
      if (stays[v] && beyond[v] > 0.0 && loses[v] && neighbours[v] <= 1) {
        stays[v] = false;
        eaten.push_back(v);
      }
    };
    for (std::uint32_t v = 0; v < n; ++v) {
      look_at(v);
    }
    while (!eaten.empty()) {
      const std::uint32_t v = eaten.back();
      eaten.pop_back();
      const auto lose = [&](std::uint32_t neighbour) {
        neighbours[neighbour] -= neighbours[neighbour] > 0 ? 1 : 0;
        loses[neighbour] = true;
        look_at(neighbour);
      };
      if (veins.vertices[v].parent != kNoVertex) {
        lose(veins.vertices[v].parent);
      }
      std::for_each(children.begin() + first[v], children.begin() + first[v + 1], lose);
    }
    return stays;
  }
};

}  // namespace

Vasculature cut(const Vasculature& veins, const CutPlane& plane, const VeinCutParams& params) {
  const Uncut uncut(veins, plane, params);
  const std::size_t n = veins.vertices.size();
  std::vector<bool> stays = uncut.stays();

  Pieces pieces(n);
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    if (stays[a] && stays[b]) {
      pieces.join(a, b);
    }
  };
  for (std::uint32_t v = 0; v < n; ++v) {
    if (veins.vertices[v].parent != kNoVertex) {
      join(v, veins.vertices[v].parent);
    }
  }
  for (const SecondConnection& second : veins.second_connections) {
    join(second.from, second.to);
  }
  struct Piece {
    bool opened = false;
    bool deep = false;
    double length = 0.0;
    double radius = 0.0;
  };
  std::vector<Piece> measured(n);
  for (std::uint32_t v = 0; v < n; ++v) {
    const std::uint32_t parent = veins.vertices[v].parent;
    if (stays[v]) {
      Piece& piece = measured[pieces.of(v)];
      piece.radius = std::max(piece.radius, uncut.reach[v]);
      piece.deep = piece.deep || -uncut.beyond[v] > uncut.reach[v];
    }
    if (parent != kNoVertex && (stays[v] || stays[parent])) {
      const std::uint32_t inner = stays[v] ? v : parent;
      const std::uint32_t outer = stays[v] ? parent : v;
      Piece& piece = measured[pieces.of(inner)];
      piece.opened = piece.opened || !stays[outer];
      const double share = stays[outer] ? 1.0 : uncut.share_behind(inner, outer);
      piece.length += share * length(veins.vertices[v].position - veins.vertices[parent].position);
    }
  }
  for (std::uint32_t v = 0; v < n; ++v) {
    const Piece& piece = measured[pieces.of(v)];
    stays[v] = stays[v] && (!piece.opened || (piece.deep && piece.length > kShortest * piece.radius));
  }

  Vasculature result;
  std::vector<std::uint32_t> now(n, kNoVertex);
  const auto add = [&](VeinVertex vertex, double beyond) {
    vertex.position = vertex.position - std::max(0.0, beyond) * plane.normal;
    vertex.parent = kNoVertex;
    result.vertices.push_back(vertex);
    return static_cast<std::uint32_t>(result.vertices.size() - 1);
  };
  for (std::uint32_t v = 0; v < n; ++v) {
    if (stays[v]) {
      now[v] = add(veins.vertices[v], uncut.beyond[v]);
    }
  }
  for (std::uint32_t v = 0; v < n; ++v) {
    const VeinVertex& vertex = veins.vertices[v];
    const std::uint32_t parent = vertex.parent;
    if (parent == kNoVertex || (!stays[v] && !stays[parent])) {
      continue;
    }
    if (stays[v] && stays[parent]) {
      result.vertices[now[v]].parent = now[parent];
      continue;
    }
    const std::uint32_t inner = stays[v] ? v : parent;
    const std::uint32_t outer = stays[v] ? parent : v;
    const double t = uncut.share_behind(inner, outer);
    if (!(t > 0.0)) {
      continue;  // a side branch of what was laid into the plane
    }
    VeinVertex crossing = vertex;
    crossing.position = lerp(veins.vertices[inner].position, veins.vertices[outer].position, t);
    const std::uint32_t end = add(crossing, dot(plane.normal, crossing.position) - plane.distance);
    if (stays[v]) {
      result.vertices[now[v]].parent = end;
    } else {
      result.vertices[end].parent = now[parent];
    }
  }
  for (SecondConnection second : veins.second_connections) {
    second.from = now[second.from];
    second.to = now[second.to];
    if (second.from != kNoVertex && second.to != kNoVertex) {
      result.second_connections.push_back(second);
    }
  }
  return result;
}

}  // namespace anthesis
