#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "hierarchy.h"

namespace anthesis {

/// A pair of primitives of two bodies, or of one: its kind, then the primitives' indices in their sheets. As numbers
/// they sort into an order that does not depend on the hierarchy.
struct PrimitivePair {
  enum Kind : std::uint64_t { kVertexOfFirst = 0, kVertexOfSecond = 1, kEdges = 2 };
  std::uint64_t key;

  PrimitivePair(Kind kind, std::uint32_t first, std::uint32_t second)
      : key(kind << 62 | static_cast<std::uint64_t>(first) << 31 | second) {}
  Kind kind() const { return static_cast<Kind>(key >> 62); }
  std::uint32_t first() const { return static_cast<std::uint32_t>(key >> 31 & 0x7fffffff); }
  std::uint32_t second() const { return static_cast<std::uint32_t>(key & 0x7fffffff); }
  friend bool operator<(PrimitivePair a, PrimitivePair b) { return a.key < b.key; }
};

/// What a traversal finds: pairs of vertex and triangle, and of edges.
struct PrimitivePairs {
  std::vector<PrimitivePair> vertices;
  std::vector<PrimitivePair> edges;

  void clear() {
    vertices.clear();
    edges.clear();
  }
  void sort() {
    std::sort(vertices.begin(), vertices.end());
    std::sort(edges.begin(), edges.end());
  }
};

/// One body as the traversal sees it.
struct View {
  const SheetHierarchy* hierarchy = nullptr;
  const BodyBounds* bounds = nullptr;
};

/// Appends all pairs of primitives of two bodies whose bounds overlap; in an order that depends on the trees.
void find_pairs_between(View first, View second, PrimitivePairs& pairs);

/// And those of one body, but for pairs with a common vertex.
void find_pairs_within(View body, PrimitivePairs& pairs);

}  // namespace anthesis
