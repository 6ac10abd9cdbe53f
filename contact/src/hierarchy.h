#pragma once
#include <algorithm>
#include <array>
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

  /// The triangles of a leaf are a patch, nearly flat: their vertices, eight at a time, the last ones repeated.
  struct Patch {
    std::uint32_t first_block = 0;  ///< of `patch_vertices`
    std::uint32_t end_block = 0;
  };
  static constexpr std::size_t kBlock = 8;
  std::vector<std::uint32_t> patch_of_node;  ///< leaves only; empty if there are no patches
  std::vector<Patch> patches;
  std::vector<std::array<std::uint32_t, kBlock>> patch_vertices;

  /// `positions_mm`: those of one body.
  SheetHierarchy(const Sheet& sheet, std::span<const Vec3> positions_mm);

 private:
  void collect_neighbours(std::size_t vertex_count);
  void collect_patches();
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

  /// Where a patch and what is within reach of it lies along its mean normal: between two planes that fit it better
  /// than slabs do, since their direction is its own. In single precision, with all rounding allowed for.
  struct Patch {
    std::array<float, 3> normal = {};  ///< at most 1 long, or hardly more
    float low = 0.0f;
    float high = 0.0f;
  };
  /// Of eight vertices of a patch: places, ways and reaches.
  struct alignas(32) Block {
    std::array<std::array<float, SheetHierarchy::kBlock>, 3> place;
    std::array<std::array<float, SheetHierarchy::kBlock>, 3> way;
    std::array<float, SheetHierarchy::kBlock> reach;
  };
  std::vector<Patch> patches;  ///< as in the hierarchy; empty: none
  std::vector<Block> blocks;
  std::array<float, 3> ride = {};
  float patch_slack = 0.0f;  ///< of the height of any of the vertices, for rounding

  /// Where the vertices are at both ends of their motion, how far they look around, and what else they may do.
  struct Reaches {
    std::span<const Vec3> from_mm;
    std::span<const Vec3> to_mm;
    double reach_mm = 0.0;
    std::span<const double> vertex_reach_mm;  ///< empty: all `reach_mm`
    double less_mm = 0.0;                     ///< that each reaches less far
    Vec3 ride_mm;
    std::span<const Vec3> vertex_way_mm;  ///< empty: none
  };
  void fit(const SheetHierarchy& hierarchy, const Reaches& reaches);

 private:
  void fit_patches(const SheetHierarchy& hierarchy, const Reaches& reaches);
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
  // What patches part depends on how triangles are grouped: only if this does not depend on what happened before.
  if (!sheet.shape_mm.empty()) {
    collect_patches();
  }
}

inline void SheetHierarchy::collect_patches() {
  patch_of_node.assign(tree.nodes.size(), 0);
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const BinaryTree::Node& node = tree.nodes[i];
    if (node.right != 0) {
      continue;
    }
    corners.clear();
    for (std::uint32_t k = node.begin; k < node.end; ++k) {
      corners.insert(corners.end(), facets[k].corners.begin(), facets[k].corners.end());
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    corners.resize((corners.size() + kBlock - 1) / kBlock * kBlock, corners.back());
    patch_of_node[i] = static_cast<std::uint32_t>(patches.size());
    Patch patch;
    patch.first_block = static_cast<std::uint32_t>(patch_vertices.size());
    for (std::size_t k = 0; k < corners.size(); k += kBlock) {
      std::array<std::uint32_t, kBlock> block;
      std::copy_n(corners.begin() + static_cast<std::ptrdiff_t>(k), kBlock, block.begin());
      patch_vertices.push_back(block);
    }
    patch.end_block = static_cast<std::uint32_t>(patch_vertices.size());
    patches.push_back(patch);
  }
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

inline void BodyBounds::fit(const SheetHierarchy& hierarchy, const Reaches& reaches) {
  const std::size_t count = reaches.from_mm.size();
  const bool moves = reaches.from_mm.data() != reaches.to_mm.data();
  const bool goes_on = reaches.ride_mm != Vec3{} || !reaches.vertex_way_mm.empty();
  const Heights ride_heights = heights_of_way(reaches.ride_mm);
  const double size_of_ride = sum_of_sizes(reaches.ride_mm);
  vertices.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double all = reaches.vertex_reach_mm.empty() ? reaches.reach_mm : reaches.vertex_reach_mm[i];
    const double reach = std::max(0.0, all - reaches.less_mm);
    if (goes_on) {
      const Vec3 way = reaches.vertex_way_mm.empty() ? Vec3{} : reaches.vertex_way_mm[i];
      vertices[i] = slabs_around(reaches.from_mm[i], reach, way, ride_heights, size_of_ride);
    } else {
      vertices[i] = slabs_around(reaches.from_mm[i], reach);
    }
    if (moves) {
      vertices[i] = joined(vertices[i], slabs_around(reaches.to_mm[i], reach));
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
  fit_patches(hierarchy, reaches);
}

inline void BodyBounds::fit_patches(const SheetHierarchy& hierarchy, const Reaches& reaches) {
  patches.resize(hierarchy.patches.size());
  blocks.resize(hierarchy.patch_vertices.size());
  if (patches.empty()) {
    return;
  }
  const bool moves = reaches.from_mm.data() != reaches.to_mm.data();
  const auto way_of = [&](std::uint32_t v) {
    return moves                           ? reaches.to_mm[v] - reaches.from_mm[v]
           : reaches.vertex_way_mm.empty() ? Vec3{}
                                           : reaches.vertex_way_mm[v];
  };
  const auto reach_of = [&](std::uint32_t v) {
    const double all = reaches.vertex_reach_mm.empty() ? reaches.reach_mm : reaches.vertex_reach_mm[v];
    return std::max(0.0, all - reaches.less_mm);
  };
  double largest = 0.0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (std::size_t lane = 0; lane < SheetHierarchy::kBlock; ++lane) {
      const std::uint32_t vertex = hierarchy.patch_vertices[b][lane];
      const Vec3 place = reaches.from_mm[vertex];
      const Vec3 way = way_of(vertex);
      const double reach = reach_of(vertex);
      largest = std::max(largest, sum_of_sizes(place) + sum_of_sizes(way) + reach);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        blocks[b].place[axis][lane] = static_cast<float>(axis == 0 ? place.x : axis == 1 ? place.y : place.z);
        blocks[b].way[axis][lane] = static_cast<float>(axis == 0 ? way.x : axis == 1 ? way.y : way.z);
      }
      blocks[b].reach[lane] = static_cast<float>(reach);
    }
  }
  ride = {static_cast<float>(reaches.ride_mm.x), static_cast<float>(reaches.ride_mm.y),
          static_cast<float>(reaches.ride_mm.z)};
  // A height takes some ten operations, each of which rounds by a unit of its size; and a normal is not quite 1 long.
  patch_slack =
      static_cast<float>(32.0 * std::numeric_limits<float>::epsilon() * (largest + sum_of_sizes(reaches.ride_mm)));
  for (std::size_t i = 0; i < hierarchy.tree.nodes.size(); ++i) {
    const BinaryTree::Node& node = hierarchy.tree.nodes[i];
    if (node.right != 0) {
      continue;
    }
    Vec3 sum{};
    for (std::uint32_t k = node.begin; k < node.end; ++k) {
      const Triangle& t = hierarchy.facets[k].corners;
      sum += cross(reaches.from_mm[t[1]] - reaches.from_mm[t[0]], reaches.from_mm[t[2]] - reaches.from_mm[t[0]]);
    }
    const Vec3 normal = normalized(sum);
    Patch& patch = patches[hierarchy.patch_of_node[i]];
    patch.normal = {static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z)};
    const auto height = [&](float x, float y, float z) {
      return patch.normal[0] * x + patch.normal[1] * y + patch.normal[2] * z;
    };
    patch.low = std::numeric_limits<float>::max();
    patch.high = -patch.low;
    const SheetHierarchy::Patch& held = hierarchy.patches[hierarchy.patch_of_node[i]];
    for (std::uint32_t b = held.first_block; b < held.end_block; ++b) {
      const Block& block = blocks[b];
      for (std::size_t lane = 0; lane < SheetHierarchy::kBlock; ++lane) {
        const float here = height(block.place[0][lane], block.place[1][lane], block.place[2][lane]);
        const float further = height(block.way[0][lane], block.way[1][lane], block.way[2][lane]);
        patch.low = std::min(patch.low, here + std::min(further, 0.0f) - block.reach[lane]);
        patch.high = std::max(patch.high, here + std::max(further, 0.0f) + block.reach[lane]);
      }
    }
    const float carried = height(ride[0], ride[1], ride[2]);
    patch.low += std::min(carried, 0.0f) - patch_slack;
    patch.high += std::max(carried, 0.0f) + patch_slack;
  }
}

}  // namespace anthesis
