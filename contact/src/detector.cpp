#include "anthesis/contact/detector.h"

#include <algorithm>
#include <bit>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"
#include "anthesis/contact/continuous.h"
#include "hierarchy.h"
#include "nearest.h"

namespace anthesis {
namespace {

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

/// One body as the traversal sees it.
struct View {
  const SheetHierarchy* hierarchy = nullptr;
  const BodyBounds* bounds = nullptr;
};

/// The vertex-triangle and edge-edge pairs of two facets that these answer for and whose bounds overlap.
class FacetPairs {
 public:
  FacetPairs(View first, View second, std::vector<PrimitivePair>& pairs)
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
        if (overlap(own_bounds_[k], other_bounds_[l])) {
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
      if (overlap(bounds.vertices[vertex], bounds.facets[facet])) {
        pairs_.push_back({PrimitivePair::kVertexOfFirst, vertex, hierarchy.facets[facet].triangle});
      }
    }
    edges_.resize(hierarchy.edges.size());
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      edges_[i] = joined(bounds.vertices[hierarchy.edges[i][0]], bounds.vertices[hierarchy.edges[i][1]]);
    }
    for (const auto& [first, second] : hierarchy.neighbour_edges) {
      if (overlap(edges_[first], edges_[second])) {
        pairs_.push_back({PrimitivePair::kEdges, first, second});
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
      bounds[k] = joined(view.bounds->vertices[facet.corners[k]], view.bounds->vertices[facet.corners[(k + 1) % 3]]);
      near |= static_cast<unsigned>(overlap(bounds[k], target)) << k;
    }
    return near;
  }

  void corners_against(const View& owner, const SheetHierarchy::Facet& facet, const View& target,
                       const SheetHierarchy::Facet& triangle, std::uint32_t triangle_at, PrimitivePair::Kind kind) {
    for (unsigned bits = facet.owned_corners; bits != 0; bits &= bits - 1) {
      const std::uint32_t vertex = facet.corners[std::countr_zero(bits)];
      if (!overlap(owner.bounds->vertices[vertex], target.bounds->facets[triangle_at])) {
        continue;
      }
      pairs_.push_back(kind == PrimitivePair::kVertexOfFirst ? PrimitivePair(kind, vertex, triangle.triangle)
                                                             : PrimitivePair(kind, triangle.triangle, vertex));
    }
  }

  void add_edges(std::uint32_t first, std::uint32_t second) {
    if (within_) {
      pairs_.push_back({PrimitivePair::kEdges, std::min(first, second), std::max(first, second)});
    } else {
      pairs_.push_back({PrimitivePair::kEdges, first, second});
    }
  }

  View first_;
  View second_;
  bool within_;
  std::vector<PrimitivePair>& pairs_;
  std::array<Slabs, 3> own_bounds_;    // of sides
  std::array<Slabs, 3> other_bounds_;  // of the other facet's sides
  std::vector<Slabs> edges_;
};

/// Descends two trees together, from a pair of nodes whose bounds overlap to the facets whose bounds overlap.
class PairTraversal {
 public:
  PairTraversal(View first, View second, std::vector<PrimitivePair>& pairs)
      : first_(first), second_(second), facets_(first, second, pairs) {}

  void two_bodies() {
    if (overlap(first_.bounds->nodes[0], second_.bounds->nodes[0])) {
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
      } else if (overlap(first_.bounds->nodes[i + 1], first_.bounds->nodes[node.right])) {
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
        leaves(a, b, second_bounds[j]);
      } else if (b.right == 0 || (a.right != 0 && a.count() >= b.count())) {
        for (const std::uint32_t child : {i + 1, a.right}) {
          stack[depth] = {child, j};
          depth += overlap(first_bounds[child], second_bounds[j]);
        }
      } else {
        for (const std::uint32_t child : {j + 1, b.right}) {
          stack[depth] = {i, child};
          depth += overlap(first_bounds[i], second_bounds[child]);
        }
      }
    }
  }

  void leaves(const BinaryTree::Node& a, const BinaryTree::Node& b, const Slabs& bounds_of_b) {
    const Slabs* const first = first_.bounds->facets.data() + a.begin;
    const Slabs* const second = second_.bounds->facets.data() + b.begin;
    unsigned rows = 0;
    for (unsigned i = 0; i < a.count(); ++i) {
      rows |= static_cast<unsigned>(overlap(first[i], bounds_of_b)) << i;
    }
    for (; rows != 0; rows &= rows - 1) {
      const auto i = static_cast<unsigned>(std::countr_zero(rows));
      unsigned columns = 0;
      for (unsigned j = 0; j < b.count(); ++j) {
        columns |= static_cast<unsigned>(overlap(first[i], second[j])) << j;
      }
      for (; columns != 0; columns &= columns - 1) {
        facets_.test(a.begin + i, b.begin + static_cast<unsigned>(std::countr_zero(columns)));
      }
    }
  }

  View first_;
  View second_;
  FacetPairs facets_;
};

/// Some unit vector across the primitives, for those that touch.
Vec3 normal_where_touching(const std::array<Vec3, 4>& points, bool edges) {
  const Vec3 across =
      edges ? cross(points[1] - points[0], points[3] - points[2]) : cross(points[2] - points[1], points[3] - points[1]);
  const double size = length(across);
  if (size > 0.0 && std::isfinite(1.0 / size)) {
    return across / size;
  }
  const Vec3 along = normalized(edges ? points[1] - points[0] : points[2] - points[1]);
  return along == Vec3{} ? Vec3{0.0, 0.0, 1.0} : any_perpendicular(along);
}

/// Two bodies, or one twice.
struct BodyPair {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  friend auto operator<=>(const BodyPair&, const BodyPair&) = default;
};

}  // namespace

struct Detector::State {
  struct Body {
    std::uint32_t sheet = 0;
    std::uint32_t first_vertex = 0;
    double reach_mm = 0.0;
    bool asleep = false;  ///< the bounds hold until it wakes up
    BodyBounds bounds;
  };
  /// What is reused from call to call, for the sake of its memory.
  struct Slot {
    std::vector<PrimitivePair> pairs;
    std::vector<Contact> contacts;
    std::vector<CandidatePair> candidates;
  };

  std::span<const Sheet> sheets;
  std::vector<std::unique_ptr<const SheetHierarchy>> hierarchies;  ///< one for each sheet, once it has positions
  std::vector<Body> bodies;                                        ///< those of the last call
  std::vector<BodyPair> body_pairs;
  std::vector<Slot> slots;

  void fit(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm, std::span<const ContactBody> current);
  void pair_bodies(std::span<const ContactBody> current);

  template <class Item, class Emit>
  void collect(std::vector<Item> Slot::*items, std::vector<Item>& all, const Emit& emit);
};

/// Bounds for the bodies of this call; those of sleepers are taken over where they are known.
void Detector::State::fit(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm,
                          std::span<const ContactBody> current) {
  for (const ContactBody& body : current) {
    ANTHESIS_ASSERT(body.sheet < sheets.size() && body.reach_mm >= 0.0);
    const Sheet& sheet = sheets[body.sheet];
    ANTHESIS_ASSERT(body.vertex_reach_mm.empty() || (body.awake && body.vertex_reach_mm.size() == sheet.vertex_count));
    ANTHESIS_ASSERT(body.first_vertex + sheet.vertex_count <= from_mm.size() && from_mm.size() == to_mm.size());
    if (!hierarchies[body.sheet]) {
      hierarchies[body.sheet] = std::make_unique<const SheetHierarchy>(
          sheet, sheet.shape_mm.empty() ? from_mm.subspan(body.first_vertex, sheet.vertex_count)
                                        : std::span<const Vec3>(sheet.shape_mm));
    }
  }
  std::vector<std::uint32_t> by_place(bodies.size());
  std::iota(by_place.begin(), by_place.end(), 0);
  const auto place = [this](std::uint32_t i) { return std::pair(bodies[i].first_vertex, bodies[i].sheet); };
  std::sort(by_place.begin(), by_place.end(), [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  std::vector<Body> before(current.size());
  before.swap(bodies);
  for (std::size_t i = 0; i < current.size(); ++i) {
    const std::pair wanted(current[i].first_vertex, current[i].sheet);
    const auto found = std::lower_bound(by_place.begin(), by_place.end(), wanted,
                                        [&](std::uint32_t a, const std::pair<std::uint32_t, std::uint32_t>& b) {
                                          return std::pair(before[a].first_vertex, before[a].sheet) < b;
                                        });
    if (found != by_place.end() && std::pair(before[*found].first_vertex, before[*found].sheet) == wanted) {
      bodies[i] = std::move(before[*found]);
    }
  }
  parallel_for(current.size(), [&](std::size_t i) {
    const ContactBody& now = current[i];
    Body& body = bodies[i];
    const SheetHierarchy& hierarchy = *hierarchies[now.sheet];
    const std::size_t count = sheets[now.sheet].vertex_count;
    const bool known =
        !now.awake && body.asleep && body.reach_mm == now.reach_mm && body.bounds.vertices.size() == count;
    if (!known) {
      body.bounds.fit(hierarchy, from_mm.subspan(now.first_vertex, count), to_mm.subspan(now.first_vertex, count),
                      now.reach_mm, now.vertex_reach_mm);
    }
    body.sheet = now.sheet;
    body.first_vertex = now.first_vertex;
    body.reach_mm = now.reach_mm;
    body.asleep = !now.awake;
  });
}

/// Which bodies may be near each other: a tree over them, made anew each time.
void Detector::State::pair_bodies(std::span<const ContactBody> current) {
  body_pairs.clear();
  std::vector<std::uint32_t> held;  // bodies that have triangles
  std::vector<Vec3> centres;
  for (std::uint32_t i = 0; i < current.size(); ++i) {
    if (bodies[i].bounds.nodes.empty()) {
      continue;
    }
    if (current[i].among) {
      const auto& high = bodies[i].bounds.nodes[0].highest;
      held.push_back(i);
      centres.push_back(0.5 * Vec3{high[0] - high[8], high[1] - high[9], high[2] - high[10]});
    }
    if (current[i].awake && current[i].within) {
      body_pairs.push_back({i, i});
    }
  }
  const BinaryTree tree(centres, 1);
  if (tree.nodes.empty()) {
    return;
  }
  struct Bounds {
    Slabs slabs;
    bool awake = false;
  };
  std::vector<Bounds> bounds(tree.nodes.size());
  for (std::size_t i = bounds.size(); i-- > 0;) {
    const BinaryTree::Node& node = tree.nodes[i];
    if (node.right == 0) {
      const std::uint32_t body = held[tree.order[node.begin]];
      bounds[i] = {bodies[body].bounds.nodes[0], current[body].awake};
    } else {
      bounds[i] = {joined(bounds[i + 1].slabs, bounds[node.right].slabs),
                   bounds[i + 1].awake || bounds[node.right].awake};
    }
  }
  const auto may_meet = [&](std::uint32_t a, std::uint32_t b) {
    return (bounds[a].awake || bounds[b].awake) && overlap(bounds[a].slabs, bounds[b].slabs);
  };
  std::vector<BodyPair> stack;
  for (std::uint32_t i = 0; i < tree.nodes.size(); ++i) {
    if (tree.nodes[i].right == 0 || !may_meet(i + 1, tree.nodes[i].right)) {
      continue;
    }
    stack.push_back({i + 1, tree.nodes[i].right});
    while (!stack.empty()) {
      const BodyPair pair = stack.back();
      stack.pop_back();
      const BinaryTree::Node& a = tree.nodes[pair.first];
      const BinaryTree::Node& b = tree.nodes[pair.second];
      if (a.right == 0 && b.right == 0) {
        const std::uint32_t one = held[tree.order[a.begin]];
        const std::uint32_t other = held[tree.order[b.begin]];
        body_pairs.push_back({std::min(one, other), std::max(one, other)});
      } else if (b.right == 0 || (a.right != 0 && a.count() >= b.count())) {
        for (const std::uint32_t child : {pair.first + 1, a.right}) {
          if (may_meet(child, pair.second)) {
            stack.push_back({child, pair.second});
          }
        }
      } else {
        for (const std::uint32_t child : {pair.second + 1, b.right}) {
          if (may_meet(pair.first, child)) {
            stack.push_back({pair.first, child});
          }
        }
      }
    }
  }
  std::sort(body_pairs.begin(), body_pairs.end());
}

/// All pairs of primitives whose bounds overlap, through `emit`, in order.
template <class Item, class Emit>
void Detector::State::collect(std::vector<Item> Slot::*items, std::vector<Item>& all, const Emit& emit) {
  constexpr std::size_t kPairsOfASlot = 8;
  const std::size_t slot_count = (body_pairs.size() + kPairsOfASlot - 1) / kPairsOfASlot;
  if (slots.size() < slot_count) {
    slots.resize(slot_count);
  }
  parallel_for(slot_count, [&](std::size_t s) {
    Slot& slot = slots[s];
    std::vector<Item>& out = slot.*items;
    out.clear();
    for (std::size_t k = s * kPairsOfASlot; k < std::min(body_pairs.size(), (s + 1) * kPairsOfASlot); ++k) {
      const BodyPair bodies_of_pair = body_pairs[k];
      const Body& first = bodies[bodies_of_pair.first];
      const Body& second = bodies[bodies_of_pair.second];
      const View first_view{hierarchies[first.sheet].get(), &first.bounds};
      const View second_view{hierarchies[second.sheet].get(), &second.bounds};
      slot.pairs.clear();
      PairTraversal traversal(first_view, second_view, slot.pairs);
      if (bodies_of_pair.first == bodies_of_pair.second) {
        traversal.one_body();
      } else {
        traversal.two_bodies();
      }
      std::sort(slot.pairs.begin(), slot.pairs.end());
      for (const PrimitivePair& pair : slot.pairs) {
        CandidatePair candidate;
        candidate.first_body = bodies_of_pair.first;
        candidate.second_body = bodies_of_pair.second;
        candidate.edges = pair.kind() == PrimitivePair::kEdges;
        if (candidate.edges) {
          const auto& one = first_view.hierarchy->edges[pair.first()];
          const auto& other = second_view.hierarchy->edges[pair.second()];
          candidate.vertices = {first.first_vertex + one[0], first.first_vertex + one[1],
                                second.first_vertex + other[0], second.first_vertex + other[1]};
        } else {
          const bool of_first = pair.kind() == PrimitivePair::kVertexOfFirst;
          const Body& target = of_first ? second : first;
          const Triangle& triangle = sheets[target.sheet].triangles[of_first ? pair.second() : pair.first()];
          candidate.vertices = {(of_first ? first : second).first_vertex + (of_first ? pair.first() : pair.second()),
                                target.first_vertex + triangle[0], target.first_vertex + triangle[1],
                                target.first_vertex + triangle[2]};
          if (!of_first) {
            std::swap(candidate.first_body, candidate.second_body);
          }
        }
        emit(candidate, out);
      }
    }
  });
  std::size_t total = 0;
  for (std::size_t s = 0; s < slot_count; ++s) {
    total += (slots[s].*items).size();
  }
  all.clear();
  all.reserve(total);
  for (std::size_t s = 0; s < slot_count; ++s) {
    const std::vector<Item>& out = slots[s].*items;
    all.insert(all.end(), out.begin(), out.end());
  }
}

Detector::Detector(std::span<const Sheet> sheets) : state_(std::make_unique<State>()) {
  state_->sheets = sheets;
  state_->hierarchies.resize(sheets.size());
}
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;
Detector::~Detector() = default;

void Detector::find_near(std::span<const Vec3> positions_mm, std::span<const ContactBody> bodies,
                         std::vector<Contact>& contacts) {
  state_->fit(positions_mm, positions_mm, bodies);
  state_->pair_bodies(bodies);
  state_->collect(&State::Slot::contacts, contacts, [&](const CandidatePair& pair, std::vector<Contact>& out) {
    const std::array<Vec3, 4> points = {positions_mm[pair.vertices[0]], positions_mm[pair.vertices[1]],
                                        positions_mm[pair.vertices[2]], positions_mm[pair.vertices[3]]};
    const auto reach = [&](int k) {
      const ContactBody& body = bodies[k < (pair.edges ? 2 : 1) ? pair.first_body : pair.second_body];
      return body.vertex_reach_mm.empty() ? body.reach_mm : body.vertex_reach_mm[pair.vertices[k] - body.first_vertex];
    };
    const double limit = pair.edges ? std::max(reach(0), reach(1)) + std::max(reach(2), reach(3))
                                    : reach(0) + std::max({reach(1), reach(2), reach(3)});
    const Nearest nearest = pair.edges ? nearest_edge_edge(points) : nearest_vertex_triangle(points);
    if (nearest.distance > limit) {
      // Not the distance found but what lies provably between the two decides: that one is wrong on the safe side.
      const double at_least = pair.edges ? distance_at_least<2>(points, nearest.difference)
                                         : distance_at_least<1>(points, nearest.difference);
      if (at_least > limit) {
        return;
      }
    }
    Contact contact;
    contact.vertices = pair.vertices;
    contact.weights = nearest.weights;
    contact.gap_mm = nearest.distance;
    contact.normal =
        nearest.distance > 0.0 ? nearest.difference / nearest.distance : normal_where_touching(points, pair.edges);
    contact.first_body = pair.first_body;
    contact.second_body = pair.second_body;
    contact.edges = pair.edges;
    out.push_back(contact);
  });
}

void Detector::find_on_course(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm,
                              std::span<const ContactBody> bodies, std::vector<CandidatePair>& pairs) {
  state_->fit(from_mm, to_mm, bodies);
  state_->pair_bodies(bodies);
  state_->collect(&State::Slot::candidates, pairs,
                  [](const CandidatePair& pair, std::vector<CandidatePair>& out) { out.push_back(pair); });
}

}  // namespace anthesis
