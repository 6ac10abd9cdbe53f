#include "anthesis/contact/detector.h"

#include <algorithm>
#include <limits>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"
#include "anthesis/contact/continuous.h"
#include "hierarchy.h"
#include "near_batch.h"
#include "nearest.h"
#include "traversal.h"

namespace anthesis {
namespace {

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

/// Looks for the nearest points of pairs of primitives, some at a time, and keeps those that look at each other.
class NearPairs {
 public:
  NearPairs(std::span<const Vec3> positions_mm, std::span<const ContactBody> bodies, std::vector<Contact>& contacts)
      : positions_(positions_mm), bodies_(bodies), contacts_(contacts) {}

  void add(const CandidatePair& pair) {
    const std::size_t lane = count_;
    pairs_[count_++] = pair;
    const int firsts = pair.edges ? 2 : 1;
    for (int k = 0; k < 4; ++k) {
      const ContactBody& body = bodies_[k < firsts ? pair.first_body : pair.second_body];
      const std::uint32_t vertex = pair.vertices[k] - body.first_vertex;
      put(batch_.points[k], lane, positions_[pair.vertices[k]]);
      put(batch_.ways[k], lane, body.vertex_way_mm.empty() ? Vec3{} : body.vertex_way_mm[vertex]);
      const double reach = body.vertex_reach_mm.empty() ? body.reach_mm : body.vertex_reach_mm[vertex];
      batch_.reaches[k][lane] =
          pair.first_body == pair.second_body ? std::max(0.0, reach - body.within_less_mm) : reach;
    }
    if (count_ == NearBatch::kLanes) {
      flush();
    }
  }

  /// To be called before pairs of another kind or of other bodies, and at the end.
  void flush() {
    if (count_ == 0) {
      return;
    }
    const CandidatePair& any = pairs_[0];
    const bool within = any.first_body == any.second_body;  // parts of one body ride together
    batch_.rides = {within ? Vec3{} : bodies_[any.first_body].ride_mm,
                    within ? Vec3{} : bodies_[any.second_body].ride_mm};
    any.edges ? find_nearest_edges(batch_) : find_nearest_vertex_triangle(batch_);
    // One of the few that went wrong is found the long way, and kept unless it is far out of sight.
    for (std::size_t lane = 0; lane < count_; ++lane) {
      const bool sound = (batch_.sound >> lane & 1) != 0;
      if (sound && (batch_.apart >> lane & 1) != 0) {
        continue;
      }
      if (sound) {
        keep(pairs_[lane], nearest_in(lane));
      } else {
        const std::array<Vec3, 4> points = points_of(pairs_[lane]);
        const Nearest nearest = any.edges ? nearest_edge_edge(points) : nearest_vertex_triangle(points);
        if (!stay_apart(lane, points, nearest.difference)) {
          keep(pairs_[lane], nearest);
        }
      }
    }
    count_ = 0;
  }

 private:
  static void put(NearBatch::Lanes3& to, std::size_t lane, Vec3 v) {
    to[0][lane] = v.x;
    to[1][lane] = v.y;
    to[2][lane] = v.z;
  }
  static Vec3 in_lane(const NearBatch::Lanes3& from, std::size_t lane) {
    return {from[0][lane], from[1][lane], from[2][lane]};
  }

  Nearest nearest_in(std::size_t lane) const {
    Nearest nearest;
    for (int k = 0; k < 4; ++k) {
      nearest.weights[k] = batch_.weights[k][lane];
    }
    nearest.difference = in_lane(batch_.difference, lane);
    nearest.distance = batch_.distance[lane];
    return nearest;
  }

  std::array<Vec3, 4> points_of(const CandidatePair& pair) const {
    return {positions_[pair.vertices[0]], positions_[pair.vertices[1]], positions_[pair.vertices[2]],
            positions_[pair.vertices[3]]};
  }

  /// Whether a plane square to `direction` lies between all places that the two can get to with what they look around:
  /// certainly, rounding included. Where it comes from does not matter.
  bool stay_apart(std::size_t lane, const std::array<Vec3, 4>& points, Vec3 direction) const {
    const int firsts = pairs_[lane].edges ? 2 : 1;
    const double size = length(direction);
    double first = std::numeric_limits<double>::infinity();
    double second = -std::numeric_limits<double>::infinity();
    double largest = extent(points);
    for (int k = 0; k < 4; ++k) {
      const Vec3 way = in_lane(batch_.ways[k], lane);
      const double reach = batch_.reaches[k][lane];
      const double height = dot(direction, points[k] - points[3]);
      const double further = dot(direction, way);
      largest = std::max({largest, reach, sum_of_sizes(way)});
      if (k < firsts) {
        first = std::min(first, height + std::min(further, 0.0) - size * reach);
      } else {
        second = std::max(second, height + std::max(further, 0.0) + size * reach);
      }
    }
    first += std::min(dot(direction, batch_.rides[0]), 0.0);
    second += std::max(dot(direction, batch_.rides[1]), 0.0);
    largest = std::max({largest, sum_of_sizes(batch_.rides[0]), sum_of_sizes(batch_.rides[1])});
    return first - second > kApartRounding * sum_of_sizes(direction) * largest;
  }

  void keep(const CandidatePair& pair, const Nearest& nearest) {
    Contact contact;
    contact.vertices = pair.vertices;
    contact.weights = nearest.weights;
    contact.gap_mm = nearest.distance;
    contact.normal = nearest.distance > 0.0 ? nearest.difference / nearest.distance
                                            : normal_where_touching(points_of(pair), pair.edges);
    contact.first_body = pair.first_body;
    contact.second_body = pair.second_body;
    contact.edges = pair.edges;
    contacts_.push_back(contact);
  }

  std::span<const Vec3> positions_;
  std::span<const ContactBody> bodies_;
  std::vector<Contact>& contacts_;
  std::array<CandidatePair, NearBatch::kLanes> pairs_;
  std::size_t count_ = 0;
  NearBatch batch_;
};

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
    bool has_own_bounds = false;
    BodyBounds own_bounds;  ///< among its own parts, where they look around less than among others

    const BodyBounds& bounds_within() const { return has_own_bounds ? own_bounds : bounds; }
  };
  /// What is reused from call to call, for the sake of its memory.
  struct Slot {
    PrimitivePairs pairs;
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

  CandidatePair candidate(BodyPair of, PrimitivePair pair) const;
  template <class Item, class Take>
  void collect(std::vector<Item> Slot::*items, std::vector<Item>& all, const Take& take);
};

/// Bounds for the bodies of this call; those of sleepers are taken over where they are known.
void Detector::State::fit(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm,
                          std::span<const ContactBody> current) {
  for (const ContactBody& body : current) {
    ANTHESIS_ASSERT(body.sheet < sheets.size() && body.reach_mm >= 0.0);
    const Sheet& sheet = sheets[body.sheet];
    ANTHESIS_ASSERT(body.vertex_reach_mm.empty() || (body.awake && body.vertex_reach_mm.size() == sheet.vertex_count));
    ANTHESIS_ASSERT(body.vertex_way_mm.empty() || (body.awake && body.vertex_way_mm.size() == sheet.vertex_count));
    ANTHESIS_ASSERT(body.within_less_mm >= 0.0 && (body.awake || body.ride_mm == Vec3{}));
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
      BodyBounds::Reaches reaches;
      reaches.from_mm = from_mm.subspan(now.first_vertex, count);
      reaches.to_mm = to_mm.subspan(now.first_vertex, count);
      reaches.reach_mm = now.reach_mm;
      reaches.vertex_reach_mm = now.vertex_reach_mm;
      reaches.ride_mm = now.ride_mm;
      reaches.vertex_way_mm = now.vertex_way_mm;
      body.bounds.fit(hierarchy, reaches);
      body.has_own_bounds = now.awake && now.within && (now.within_less_mm > 0.0 || now.ride_mm != Vec3{});
      if (body.has_own_bounds) {
        reaches.less_mm = now.within_less_mm;
        reaches.ride_mm = {};
        body.own_bounds.fit(hierarchy, reaches);
      }
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

CandidatePair Detector::State::candidate(BodyPair of, PrimitivePair pair) const {
  const Body& first = bodies[of.first];
  const Body& second = bodies[of.second];
  CandidatePair candidate;
  candidate.first_body = of.first;
  candidate.second_body = of.second;
  candidate.edges = pair.kind() == PrimitivePair::kEdges;
  if (candidate.edges) {
    const auto& one = hierarchies[first.sheet]->edges[pair.first()];
    const auto& other = hierarchies[second.sheet]->edges[pair.second()];
    candidate.vertices = {first.first_vertex + one[0], first.first_vertex + one[1], second.first_vertex + other[0],
                          second.first_vertex + other[1]};
    return candidate;
  }
  const bool of_first = pair.kind() == PrimitivePair::kVertexOfFirst;
  const Body& target = of_first ? second : first;
  const Triangle& triangle = sheets[target.sheet].triangles[of_first ? pair.second() : pair.first()];
  candidate.vertices = {(of_first ? first : second).first_vertex + (of_first ? pair.first() : pair.second()),
                        target.first_vertex + triangle[0], target.first_vertex + triangle[1],
                        target.first_vertex + triangle[2]};
  if (!of_first) {
    std::swap(candidate.first_body, candidate.second_body);
  }
  return candidate;
}

/// All pairs of primitives whose bounds overlap, in order: `take` turns those of two bodies into items.
template <class Item, class Take>
void Detector::State::collect(std::vector<Item> Slot::*items, std::vector<Item>& all, const Take& take) {
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
      const BodyPair pair = body_pairs[k];
      const Body& first = bodies[pair.first];
      const Body& second = bodies[pair.second];
      const bool within = pair.first == pair.second;
      const View first_view{hierarchies[first.sheet].get(), within ? &first.bounds_within() : &first.bounds};
      const View second_view{hierarchies[second.sheet].get(), within ? &second.bounds_within() : &second.bounds};
      slot.pairs.clear();
      if (within) {
        find_pairs_within(first_view, slot.pairs);
      } else {
        find_pairs_between(first_view, second_view, slot.pairs);
      }
      // Trees made from a sheet's own shape are the same whatever happened before: so is the order they are walked in.
      if (sheets[first.sheet].shape_mm.empty() || sheets[second.sheet].shape_mm.empty()) {
        slot.pairs.sort();
      }
      take(pair, slot.pairs, out);
    }
  });
  std::vector<std::size_t> begin(slot_count + 1, 0);
  for (std::size_t s = 0; s < slot_count; ++s) {
    begin[s + 1] = begin[s] + (slots[s].*items).size();
  }
  all.resize(begin[slot_count]);
  parallel_for(slot_count, [&](std::size_t s) {
    const std::vector<Item>& out = slots[s].*items;
    std::copy(out.begin(), out.end(), all.begin() + static_cast<std::ptrdiff_t>(begin[s]));
  });
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
  state_->collect(&State::Slot::contacts, contacts,
                  [&](BodyPair of, const PrimitivePairs& pairs, std::vector<Contact>& out) {
                    NearPairs near(positions_mm, bodies, out);
                    // Those of one kind and order of bodies side by side.
                    for (const auto kind : {PrimitivePair::kVertexOfFirst, PrimitivePair::kVertexOfSecond}) {
                      for (const PrimitivePair& pair : pairs.vertices) {
                        if (pair.kind() == kind) {
                          near.add(state_->candidate(of, pair));
                        }
                      }
                      near.flush();
                    }
                    for (const PrimitivePair& pair : pairs.edges) {
                      near.add(state_->candidate(of, pair));
                    }
                    near.flush();
                  });
}

void Detector::find_on_course(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm,
                              std::span<const ContactBody> bodies, std::vector<CandidatePair>& pairs) {
  state_->fit(from_mm, to_mm, bodies);
  state_->pair_bodies(bodies);
  state_->collect(&State::Slot::candidates, pairs,
                  [&](BodyPair of, const PrimitivePairs& found, std::vector<CandidatePair>& out) {
                    for (const std::vector<PrimitivePair>* list : {&found.vertices, &found.edges}) {
                      for (const PrimitivePair& pair : *list) {
                        out.push_back(state_->candidate(of, pair));
                      }
                    }
                  });
}

}  // namespace anthesis
