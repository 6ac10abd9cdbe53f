#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "anthesis/contact/sheet.h"
#include "slabs.h"

namespace anthesis {

/// A binary tree over things that have a place, by halves along the longest side. Nodes come parents first, each
/// followed by its left child.
struct BinaryTree {
  struct Node {
    std::uint32_t begin = 0;  ///< of `order`
    std::uint32_t end = 0;
    std::uint32_t right = 0;  ///< 0 for a leaf
    std::uint32_t count() const { return end - begin; }
  };
  std::vector<Node> nodes;           ///< empty where there is nothing
  std::vector<std::uint32_t> order;  ///< the things, those of a node side by side

  BinaryTree() = default;
  BinaryTree(std::span<const Vec3> places, std::uint32_t leaf_size) {
    order.resize(places.size());
    std::iota(order.begin(), order.end(), 0);
    if (!places.empty()) {
      nodes.reserve(2 * places.size());
      split(places, leaf_size, 0, static_cast<std::uint32_t>(places.size()));
    }
  }

 private:
  void split(std::span<const Vec3> places, std::uint32_t leaf_size, std::uint32_t begin, std::uint32_t end) {
    const std::size_t node = nodes.size();
    nodes.push_back({begin, end, 0});
    if (end - begin <= leaf_size) {
      return;
    }
    Vec3 low = places[order[begin]];
    Vec3 high = low;
    for (std::uint32_t i = begin; i < end; ++i) {
      const Vec3 p = places[order[i]];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const Vec3 size = high - low;
    double Vec3::*const axis = size.x >= size.y && size.x >= size.z ? &Vec3::x : size.y >= size.z ? &Vec3::y : &Vec3::z;
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return places[a].*axis != places[b].*axis ? places[a].*axis < places[b].*axis : a < b;
                     });
    split(places, leaf_size, begin, middle);
    nodes[node].right = static_cast<std::uint32_t>(nodes.size());
    split(places, leaf_size, middle, end);
  }
};

/// What all organs of a sheet have in common: the tree over its triangles, and which triangle answers for which of its
/// corners and sides, so that each vertex and edge is asked about once (representative triangles, Curtis et al. 2008).
struct SheetHierarchy {
  struct Facet {
    Triangle corners = {};
    std::array<std::uint32_t, 3> sides = {};  ///< indices into `edges`: corner k to corner k + 1
    std::uint32_t triangle = 0;               ///< in the sheet
    std::uint8_t owned_corners = 0;           ///< a bit for each corner it answers for
    std::uint8_t owned_sides = 0;
  };
  BinaryTree tree;
  std::vector<Facet> facets;                        ///< in the tree's order
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< sides of triangles, each once, ascending

  /// Pairs without a common vertex whose facets have one. However the organ bends, these facets' bounds always overlap,
  /// so that it is of no use to look for them.
  std::vector<std::array<std::uint32_t, 2>> neighbour_vertices;  ///< vertex, then facet
  std::vector<std::array<std::uint32_t, 2>> neighbour_edges;     ///< smaller first

  /// `positions_mm`: those of one body.
  SheetHierarchy(const Sheet& sheet, std::span<const Vec3> positions_mm);

 private:
  void collect_neighbours(std::size_t vertex_count);
};

inline bool share_a_vertex(const Triangle& a, const Triangle& b) {
  bool shared = false;
  for (const std::uint32_t v : a) {
    shared |= v == b[0] || v == b[1] || v == b[2];
  }
  return shared;
}

/// The bounds of one body.
struct BodyBounds {
  std::vector<Slabs> vertices;  ///< each vertex with what is within reach of it
  std::vector<Slabs> facets;    ///< in the tree's order
  std::vector<Slabs> nodes;

  /// `from_mm` and `to_mm`: where the vertices are at both ends of their motion.
  /// `vertex_reach_mm` may be empty: all `reach_mm`.
  void fit(const SheetHierarchy& hierarchy, std::span<const Vec3> from_mm, std::span<const Vec3> to_mm, double reach_mm,
           std::span<const double> vertex_reach_mm);
};

inline SheetHierarchy::SheetHierarchy(const Sheet& sheet, std::span<const Vec3> positions_mm) {
  constexpr std::uint32_t kLeafSize = 6;  // the fastest of 2 to 8
  std::vector<Vec3> centres;
  centres.reserve(sheet.triangles.size());
  for (const Triangle& t : sheet.triangles) {
    centres.push_back((positions_mm[t[0]] + positions_mm[t[1]] + positions_mm[t[2]]) / 3.0);
    for (int k = 0; k < 3; ++k) {
      edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  tree = BinaryTree(centres, kLeafSize);
  std::vector<bool> vertex_taken(sheet.vertex_count, false);
  std::vector<bool> edge_taken(edges.size(), false);
  facets.reserve(sheet.triangles.size());
  for (const std::uint32_t triangle : tree.order) {
    Facet facet;
    facet.triangle = triangle;
    facet.corners = sheet.triangles[triangle];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = facet.corners[k];
      const std::uint32_t b = facet.corners[(k + 1) % 3];
      const std::array<std::uint32_t, 2> edge = {std::min(a, b), std::max(a, b)};
      facet.sides[k] = static_cast<std::uint32_t>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin());
      if (!vertex_taken[a]) {
        vertex_taken[a] = true;
        facet.owned_corners = static_cast<std::uint8_t>(facet.owned_corners | 1 << k);
      }
      if (!edge_taken[facet.sides[k]]) {
        edge_taken[facet.sides[k]] = true;
        facet.owned_sides = static_cast<std::uint8_t>(facet.owned_sides | 1 << k);
      }
    }
    facets.push_back(facet);
  }
  collect_neighbours(sheet.vertex_count);
}

inline void SheetHierarchy::collect_neighbours(std::size_t vertex_count) {
  std::vector<std::vector<std::uint32_t>> facets_at(vertex_count);
  for (std::uint32_t i = 0; i < facets.size(); ++i) {
    for (const std::uint32_t v : facets[i].corners) {
      facets_at[v].push_back(i);
    }
  }
  std::vector<std::uint32_t> around;
  for (std::uint32_t i = 0; i < facets.size(); ++i) {
    const Facet& facet = facets[i];
    around.clear();
    for (const std::uint32_t v : facet.corners) {
      around.insert(around.end(), facets_at[v].begin(), facets_at[v].end());
    }
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    for (const std::uint32_t j : around) {
      const Facet& other = facets[j];
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t v = facet.corners[k];
        if ((facet.owned_corners >> k & 1) != 0 && v != other.corners[0] && v != other.corners[1] &&
            v != other.corners[2]) {
          neighbour_vertices.push_back({v, j});
        }
        for (int l = 0; l < 3; ++l) {
          const std::array<std::uint32_t, 2> pair = {facet.sides[k], other.sides[l]};
          const auto& a = edges[pair[0]];
          const auto& b = edges[pair[1]];
          if ((facet.owned_sides >> k & 1) != 0 && (other.owned_sides >> l & 1) != 0 && pair[0] < pair[1] &&
              a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1]) {
            neighbour_edges.push_back(pair);
          }
        }
      }
    }
  }
  std::sort(neighbour_vertices.begin(), neighbour_vertices.end());
  std::sort(neighbour_edges.begin(), neighbour_edges.end());
}

inline void BodyBounds::fit(const SheetHierarchy& hierarchy, std::span<const Vec3> from_mm, std::span<const Vec3> to_mm,
                            double reach_mm, std::span<const double> vertex_reach_mm) {
  const bool moves = from_mm.data() != to_mm.data();
  vertices.resize(from_mm.size());
  for (std::size_t i = 0; i < from_mm.size(); ++i) {
    const double reach = vertex_reach_mm.empty() ? reach_mm : vertex_reach_mm[i];
    vertices[i] = slabs_around(from_mm[i], reach);
    if (moves) {
      vertices[i] = joined(vertices[i], slabs_around(to_mm[i], reach));
    }
  }
  facets.resize(hierarchy.facets.size());
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const Triangle& t = hierarchy.facets[i].corners;
    facets[i] = joined(joined(vertices[t[0]], vertices[t[1]]), vertices[t[2]]);
  }
  nodes.resize(hierarchy.tree.nodes.size());
  for (std::size_t i = nodes.size(); i-- > 0;) {  // children come after their parents
    const BinaryTree::Node& node = hierarchy.tree.nodes[i];
    if (node.right != 0) {
      nodes[i] = joined(nodes[i + 1], nodes[node.right]);
      continue;
    }
    nodes[i] = facets[node.begin];
    for (std::uint32_t k = node.begin + 1; k < node.end; ++k) {
      nodes[i] = joined(nodes[i], facets[k]);
    }
  }
}

}  // namespace anthesis
