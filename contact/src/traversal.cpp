#include "traversal.h"

#include <array>
#include <bit>

// Highway compiles what lies between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set, by
// including this file again and again, and chooses while the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/traversal.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anthesis::traversal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 8>;

/// As overlap: false only where a plane lies between the two.
HWY_INLINE bool meet(const Slabs& a, const Slabs& b) {
  const Tag d;
  auto lowest = hn::Add(hn::Load(d, a.highest.data()), hn::Load(d, b.highest.data() + 8));
  for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
    if (k > 0) {
      lowest = hn::Min(lowest, hn::Add(hn::Load(d, a.highest.data() + k), hn::Load(d, b.highest.data() + 8 + k)));
    }
    lowest = hn::Min(lowest, hn::Add(hn::Load(d, a.highest.data() + 8 + k), hn::Load(d, b.highest.data() + k)));
  }
  return hn::AllFalse(d, hn::Lt(lowest, hn::Zero(d)));
}

/// Whether a plane square to the normal of patch `i` of `a` parts it from patch `j` of `b`, with all that both reach.
HWY_INLINE bool parted(View a, std::uint32_t i, View b, std::uint32_t j) {
  const Tag d;
  const BodyBounds::Patch& patch = a.bounds->patches[i];
  const auto x = hn::Set(d, patch.normal[0]);
  const auto y = hn::Set(d, patch.normal[1]);
  const auto z = hn::Set(d, patch.normal[2]);
  const std::array<float, 3>& ride = b.bounds->ride;
  const float carried = patch.normal[0] * ride[0] + patch.normal[1] * ride[1] + patch.normal[2] * ride[2];
  // What all heights of b would have to be above or below.
  const auto above = hn::Set(d, patch.high + b.bounds->patch_slack - std::min(carried, 0.0f));
  const auto below = hn::Set(d, patch.low - b.bounds->patch_slack - std::max(carried, 0.0f));
  const auto zero = hn::Zero(d);
  auto all_above = hn::Ge(zero, zero);
  auto all_below = all_above;
  const SheetHierarchy::Patch& other = b.hierarchy->patches[j];
  for (std::uint32_t k = other.first_block; k < other.end_block; ++k) {
    const BodyBounds::Block& block = b.bounds->blocks[k];
    for (std::size_t lane = 0; lane < SheetHierarchy::kBlock; lane += hn::Lanes(d)) {
      const auto height = [&](const std::array<std::array<float, SheetHierarchy::kBlock>, 3>& v) HWY_ATTR {
        return hn::Add(
            hn::Add(hn::Mul(x, hn::Load(d, v[0].data() + lane)), hn::Mul(y, hn::Load(d, v[1].data() + lane))),
            hn::Mul(z, hn::Load(d, v[2].data() + lane)));
      };
      const auto here = height(block.place);
      const auto further = height(block.way);
      const auto reach = hn::Load(d, block.reach.data() + lane);
      all_above = hn::And(all_above, hn::Gt(hn::Sub(hn::Add(here, hn::Min(further, zero)), reach), above));
      all_below = hn::And(all_below, hn::Lt(hn::Add(hn::Add(here, hn::Max(further, zero)), reach), below));
    }
  }
  return hn::AllTrue(d, all_above) || hn::AllTrue(d, all_below);
}

/// As joined.
HWY_INLINE Slabs join(const Slabs& a, const Slabs& b) {
  const Tag d;
  Slabs both;
  for (std::size_t k = 0; k < 16; k += hn::Lanes(d)) {
    hn::Store(hn::Max(hn::Load(d, a.highest.data() + k), hn::Load(d, b.highest.data() + k)), d,
              both.highest.data() + k);
  }
  return both;
}

/// The vertex-triangle and edge-edge pairs of two facets that these answer for and whose bounds overlap.
class FacetPairs {
 public:
  FacetPairs(View first, View second, PrimitivePairs& pairs)
      : first_(first), second_(second), within_(first.bounds == second.bounds), pairs_(pairs) {}

  void test(std::uint32_t i, std::uint32_t j) {
    const SheetHierarchy::Facet& one = first_.hierarchy->facets[i];
    const SheetHierarchy::Facet& other = second_.hierarchy->facets[j];
    if (within_ && share_a_vertex(one.corners, other.corners)) {
      return;  // neighbours() has them
    }
    corners_against(first_, one, second_, other, j, PrimitivePair::kVertexOfFirst);
    corners_against(second_, other, first_, one, i,
                    within_ ? PrimitivePair::kVertexOfFirst : PrimitivePair::kVertexOfSecond);
    const unsigned other_sides = sides_against(second_, other, first_.bounds->facets[i], other_bounds_);
    if (other_sides == 0) {
      return;
    }
    for (unsigned bits = sides_against(first_, one, second_.bounds->facets[j], own_bounds_); bits != 0;
         bits &= bits - 1) {
      const int k = std::countr_zero(bits);
      for (unsigned other_bits = other_sides; other_bits != 0; other_bits &= other_bits - 1) {
        const int l = std::countr_zero(other_bits);
        if (meet(own_bounds_[k], other_bounds_[l])) {
          add_edges(one.sides[k], other.sides[l]);
        }
      }
    }
  }

  /// Those of one body whose facets have a common vertex.
  void neighbours() {
    const SheetHierarchy& hierarchy = *first_.hierarchy;
    const BodyBounds& bounds = *first_.bounds;
    for (const auto& [vertex, facet] : hierarchy.neighbour_vertices) {
      if (meet(bounds.vertices[vertex], bounds.facets[facet])) {
        pairs_.vertices.push_back({PrimitivePair::kVertexOfFirst, vertex, hierarchy.facets[facet].triangle});
      }
    }
    edges_.resize(hierarchy.edges.size());
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      edges_[i] = join(bounds.vertices[hierarchy.edges[i][0]], bounds.vertices[hierarchy.edges[i][1]]);
    }
    for (const auto& [first, second] : hierarchy.neighbour_edges) {
      if (meet(edges_[first], edges_[second])) {
        pairs_.edges.push_back({PrimitivePair::kEdges, first, second});
      }
    }
  }

 private:
  /// The bits of the sides that a facet answers for and that come near the other facet, with their bounds.
  static unsigned sides_against(const View& view, const SheetHierarchy::Facet& facet, const Slabs& target,
                                std::array<Slabs, 3>& bounds) {
    unsigned near = 0;
    for (unsigned bits = facet.owned_sides; bits != 0; bits &= bits - 1) {
      const int k = std::countr_zero(bits);
      bounds[k] = join(view.bounds->vertices[facet.corners[k]], view.bounds->vertices[facet.corners[(k + 1) % 3]]);
      near |= static_cast<unsigned>(meet(bounds[k], target)) << k;
    }
    return near;
  }

  void corners_against(const View& owner, const SheetHierarchy::Facet& facet, const View& target,
                       const SheetHierarchy::Facet& triangle, std::uint32_t triangle_at, PrimitivePair::Kind kind) {
    for (unsigned bits = facet.owned_corners; bits != 0; bits &= bits - 1) {
      const std::uint32_t vertex = facet.corners[std::countr_zero(bits)];
      if (!meet(owner.bounds->vertices[vertex], target.bounds->facets[triangle_at])) {
        continue;
      }
      pairs_.vertices.push_back(kind == PrimitivePair::kVertexOfFirst ? PrimitivePair(kind, vertex, triangle.triangle)
                                                                      : PrimitivePair(kind, triangle.triangle, vertex));
    }
  }

  void add_edges(std::uint32_t first, std::uint32_t second) {
    if (within_) {
      pairs_.edges.push_back({PrimitivePair::kEdges, std::min(first, second), std::max(first, second)});
    } else {
      pairs_.edges.push_back({PrimitivePair::kEdges, first, second});
    }
  }

  View first_;
  View second_;
  bool within_;
  PrimitivePairs& pairs_;
  std::array<Slabs, 3> own_bounds_;    // of sides
  std::array<Slabs, 3> other_bounds_;  // of the other facet's sides
  std::vector<Slabs> edges_;
};

/// Descends two trees together, from a pair of nodes whose bounds overlap to the facets whose bounds overlap.
class PairTraversal {
 public:
  PairTraversal(View first, View second, PrimitivePairs& pairs)
      : first_(first),
        second_(second),
        has_patches_(!first.bounds->patches.empty() && !second.bounds->patches.empty()),
        facets_(first, second, pairs) {}

  void two_bodies() {
    if (meet(first_.bounds->nodes[0], second_.bounds->nodes[0])) {
      across(0, 0);
    }
  }

  void one_body() {
    facets_.neighbours();
    const std::vector<BinaryTree::Node>& nodes = first_.hierarchy->tree.nodes;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      const BinaryTree::Node& node = nodes[i];
      if (node.right == 0) {
        for (std::uint32_t a = node.begin; a < node.end; ++a) {
          for (std::uint32_t b = a + 1; b < node.end; ++b) {
            facets_.test(a, b);
          }
        }
      } else if (meet(first_.bounds->nodes[i + 1], first_.bounds->nodes[node.right])) {
        across(i + 1, node.right);
      }
    }
  }

 private:
  void across(std::uint32_t first_node, std::uint32_t second_node) {
    const BinaryTree::Node* const first_nodes = first_.hierarchy->tree.nodes.data();
    const BinaryTree::Node* const second_nodes = second_.hierarchy->tree.nodes.data();
    const Slabs* const first_bounds = first_.bounds->nodes.data();
    const Slabs* const second_bounds = second_.bounds->nodes.data();
    // Halves make trees of at most 32 levels, and each step leaves one pair more than it took for a level of one tree.
    std::array<std::array<std::uint32_t, 2>, 80> stack;
    std::size_t depth = 0;
    stack[depth++] = {first_node, second_node};
    while (depth > 0) {
      const std::array<std::uint32_t, 2> pair = stack[--depth];
      const std::uint32_t i = pair[0];
      const std::uint32_t j = pair[1];
      const BinaryTree::Node& a = first_nodes[i];
      const BinaryTree::Node& b = second_nodes[j];
      // No branch depends on a test: which way it goes cannot be foretold, and a wrong guess costs more than the test.
      if (a.right == 0 && b.right == 0) {
        if (!has_patches_ || !(parted_patches(i, j))) {
          leaves(a, b, second_bounds[j]);
        }
      } else if (b.right == 0 || (a.right != 0 && a.count() >= b.count())) {
        for (const std::uint32_t child : {i + 1, a.right}) {
          stack[depth] = {child, j};
          depth += meet(first_bounds[child], second_bounds[j]);
        }
      } else {
        for (const std::uint32_t child : {j + 1, b.right}) {
          stack[depth] = {i, child};
          depth += meet(first_bounds[i], second_bounds[child]);
        }
      }
    }
  }

  bool parted_patches(std::uint32_t first_node, std::uint32_t second_node) const {
    const std::uint32_t i = first_.hierarchy->patch_of_node[first_node];
    const std::uint32_t j = second_.hierarchy->patch_of_node[second_node];
    return parted(first_, i, second_, j) || parted(second_, j, first_, i);
  }

  void leaves(const BinaryTree::Node& a, const BinaryTree::Node& b, const Slabs& bounds_of_b) {
    const Slabs* const first = first_.bounds->facets.data() + a.begin;
    const Slabs* const second = second_.bounds->facets.data() + b.begin;
    unsigned rows = 0;
    for (unsigned i = 0; i < a.count(); ++i) {
      rows |= static_cast<unsigned>(meet(first[i], bounds_of_b)) << i;
    }
    for (; rows != 0; rows &= rows - 1) {
      const auto i = static_cast<unsigned>(std::countr_zero(rows));
      unsigned columns = 0;
      for (unsigned j = 0; j < b.count(); ++j) {
        columns |= static_cast<unsigned>(meet(first[i], second[j])) << j;
      }
      for (; columns != 0; columns &= columns - 1) {
        facets_.test(a.begin + i, b.begin + static_cast<unsigned>(std::countr_zero(columns)));
      }
    }
  }

  View first_;
  View second_;
  bool has_patches_;
  FacetPairs facets_;
};

void between(View first, View second, PrimitivePairs& pairs) {
  PairTraversal(first, second, pairs).two_bodies();
}

void within(View body, PrimitivePairs& pairs) {
  PairTraversal(body, body, pairs).one_body();
}

}  // namespace anthesis::traversal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anthesis {
namespace traversal {

HWY_EXPORT(between);
HWY_EXPORT(within);

}  // namespace traversal

void find_pairs_between(View first, View second, PrimitivePairs& pairs) {
  HWY_DYNAMIC_DISPATCH(traversal::between)(first, second, pairs);
}

void find_pairs_within(View body, PrimitivePairs& pairs) {
  HWY_DYNAMIC_DISPATCH(traversal::within)(body, pairs);
}

}  // namespace anthesis
#endif  // HWY_ONCE
