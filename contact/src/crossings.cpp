#include "anthesis/contact/crossings.h"

#include <xmmintrin.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "anthesis/base/parallel.h"
#include "anthesis/geometry/predicates.h"
#include "triangle_pair.h"

namespace anthesis {
namespace {

using detail::PlacedTriangle;

constexpr const char* kStage = "crossings";

// How many pieces the loops over vertices, triangles and boxes are cut into. A constant: the pieces decide nothing, but
// who reads this need not wonder.
constexpr std::size_t kPiece = 4096;

// The search is cut into pairs of nodes of this level's size, of 4^4 triangles, or larger ones where they are many.
constexpr std::size_t kTaskLevel = 3;
constexpr std::size_t kMostTaskNodes = 2048;

Error cancelled() {
  return {ErrorCode::kCancelled, "", "cancelled"};
}

/// body(first, last) for consecutive ranges of [0, count).
template <class Body>
bool for_pieces(std::size_t count, const Body& body, const Progress& progress) {
  return parallel_for((count + kPiece - 1) / kPiece,
                      [&](std::size_t piece) { body(piece * kPiece, std::min(count, (piece + 1) * kPiece)); }, progress,
                      kStage);
}

std::optional<Error> check_input(std::span<const Vec3> positions_mm, std::span<const Triangle> triangles) {
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max();
  if (positions_mm.size() > kMost || triangles.size() > kMost) {
    return Error{ErrorCode::kTooLarge, positions_mm.size() > kMost ? "positions_mm" : "triangles",
                 "must be fewer than 2^32"};
  }
  for (std::size_t i = 0; i < positions_mm.size(); ++i) {
    for (const double value : {positions_mm[i].x, positions_mm[i].y, positions_mm[i].z}) {
      if (!(std::fabs(value) <= kPredicateLimit)) {
        return invalid_parameter("positions_mm[" + std::to_string(i) + "]", "must be within -1e100 to 1e100", value);
      }
    }
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t vertex : triangles[i]) {
      if (vertex >= positions_mm.size()) {
        return invalid_parameter("triangles[" + std::to_string(i) + "]",
                                 "must be below the number of vertices, " + std::to_string(positions_mm.size()),
                                 std::to_string(vertex));
      }
    }
  }
  return std::nullopt;
}

/// For each vertex the first one at its place. A table of open addresses: which slot a place falls into does not show
/// in the result.
std::vector<std::uint32_t> weld(std::span<const Vec3> positions) {
  constexpr std::uint32_t kEmpty = std::numeric_limits<std::uint32_t>::max();
  const auto bits = static_cast<int>(std::bit_width(2 * positions.size()));
  const std::size_t mask = (std::size_t{1} << bits) - 1;
  std::vector<std::uint32_t> slots(mask + 1, kEmpty);
  std::vector<std::uint32_t> first(positions.size());
  // Coordinates may differ in their highest bits only, or in their lowest: a product's highest bits hear of all.
  constexpr std::uint64_t kFactor = 0x9e3779b97f4a7c15u;
  const auto mixed = [](std::uint64_t state, double value) {
    state = (state ^ std::bit_cast<std::uint64_t>(value + 0.0)) * kFactor;  // -0 is 0
    return state ^ (state >> 32);
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 p = positions[i];
    std::size_t slot = (mixed(mixed(mixed(0, p.x), p.y), p.z) * kFactor) >> (64 - bits);
    while (slots[slot] != kEmpty && !(positions[slots[slot]] == p)) {
      slot = (slot + 1) & mask;
    }
    if (slots[slot] == kEmpty) {
      slots[slot] = static_cast<std::uint32_t>(i);
    }
    first[i] = slots[slot];
  }
  return first;
}

/// The boxes of a node's four children, each bound of the four side by side. A missing child's box meets nothing.
struct alignas(16) Boxes {
  float low[3][4];
  float high[3][4];
};

/// Boxes over triangles, four to a node, level by level: children of node i of a level are nodes 4 i to 4 i + 3 of the
/// level below, and of level 0 the triangles. All leaves are equally deep, so that a search compares like with like.
struct Tree {
  std::vector<PlacedTriangle> triangles;  ///< along a curve that keeps neighbours together
  std::vector<std::vector<Boxes>> levels;
};

/// Coordinates as floats in an order that rounding keeps: boxes of those that meet, meet. Nothing else is needed.
///
/// They are counted from where most vertices are, in the size of that place: a float is as fine there as it is coarse
/// for a stray vertex far out, which spoils nothing.
class Quantizer {
 public:
  explicit Quantizer(std::span<const Vec3> positions) {
    constexpr std::size_t kSamples = 255;
    const std::size_t step = positions.size() / kSamples + 1;
    const auto median = [&](auto coordinate) {
      std::vector<double> sample;
      for (std::size_t i = 0; i < positions.size(); i += step) {
        sample.push_back(coordinate(positions[i]));
      }
      const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
      std::nth_element(sample.begin(), middle, sample.end());
      return *middle;
    };
    centre_ = {median([](Vec3 p) { return p.x; }), median([](Vec3 p) { return p.y; }),
               median([](Vec3 p) { return p.z; })};
    const double size = median([this](Vec3 p) {
      return std::max({std::fabs(p.x - centre_.x), std::fabs(p.y - centre_.y), std::fabs(p.z - centre_.z)});
    });
    scale_ = size > 1e-300 ? 1.0 / size : 1.0;
    for (const Vec3 p : positions) {
      const std::array<float, 3> q = (*this)(p);
      reach_ = std::max({reach_, std::fabs(q[0]), std::fabs(q[1]), std::fabs(q[2])});
    }
    reach_ = std::clamp(reach_, 1e-30f, 64.0f);
  }

  std::array<float, 3> operator()(Vec3 p) const {
    return {rounded((p.x - centre_.x) * scale_), rounded((p.y - centre_.y) * scale_),
            rounded((p.z - centre_.z) * scale_)};
  }

  /// Which of 1024 cells such a coordinate falls into. For order only.
  std::uint64_t cell(float value) const {
    const float place = value / (2.0f * reach_) + 0.5f;
    return static_cast<std::uint64_t>(std::clamp(place, 0.0f, 1.0f) * 1023.0f);
  }

 private:
  static float rounded(double value) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -kMost, kMost));
  }

  Vec3 centre_;
  double scale_ = 1.0;
  float reach_ = 0.0f;
};

/// The lowest 10 bits of `value`, two zeros between each two.
std::uint64_t spread(std::uint64_t value) {
  value = (value | value << 16) & 0x030000ffu;
  value = (value | value << 8) & 0x0300f00fu;
  value = (value | value << 4) & 0x030c30c3u;
  value = (value | value << 2) & 0x09249249u;
  return value;
}

void put_box(Boxes& to, std::size_t child, const std::array<float, 3>& low, const std::array<float, 3>& high) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    to.low[axis][child] = low[axis];
    to.high[axis][child] = high[axis];
  }
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// False if `progress` asked to stop.
bool build_tree(std::span<const Vec3> positions, std::span<const Triangle> triangles, const Progress& progress,
                Tree& tree) {
  const std::vector<std::uint32_t> first = weld(positions);
  const Quantizer quantized(positions);

  // Of each triangle the cell its middle is in, along a Z-shaped curve, and behind it its number.
  std::vector<std::uint64_t> keys(triangles.size());
  bool go_on = for_pieces(
      triangles.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const std::array<float, 3> a = quantized(positions[triangles[i][0]]);
          const std::array<float, 3> b = quantized(positions[triangles[i][1]]);
          const std::array<float, 3> c = quantized(positions[triangles[i][2]]);
          std::uint64_t code = 0;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            // Divided first: three of the largest floats have no sum.
            code |= spread(quantized.cell(a[axis] / 3.0f + b[axis] / 3.0f + c[axis] / 3.0f)) << axis;
          }
          keys[i] = code << 32 | i;
        }
      },
      progress);
  if (!go_on) {
    return false;
  }
  std::sort(keys.begin(), keys.end());

  tree.triangles.resize(triangles.size());
  std::size_t nodes = (triangles.size() + 3) / 4;
  tree.levels.emplace_back(nodes);
  go_on = for_pieces(
      nodes,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t node = begin; node < end; ++node) {
          for (std::size_t child = 0; child < 4; ++child) {
            std::array<float, 3> low = {kInfinity, kInfinity, kInfinity};
            std::array<float, 3> high = {-kInfinity, -kInfinity, -kInfinity};
            if (4 * node + child < triangles.size()) {
              PlacedTriangle& placed = tree.triangles[4 * node + child];
              placed.index = static_cast<std::uint32_t>(keys[4 * node + child]);
              const auto [a, b, c] = triangles[placed.index];
              placed.vertex = {first[a], first[b], first[c]};
              placed.plane = PlaneSide(positions[a], positions[b], positions[c]);
              placed.degenerate = detail::collinear(positions[a], positions[b], positions[c]);
              for (const std::uint32_t vertex : {a, b, c}) {
                const std::array<float, 3> p = quantized(positions[vertex]);
                for (std::size_t axis = 0; axis < 3; ++axis) {
                  low[axis] = std::min(low[axis], p[axis]);
                  high[axis] = std::max(high[axis], p[axis]);
                }
              }
            }
            put_box(tree.levels[0][node], child, low, high);
          }
        }
      },
      progress);
  while (go_on && nodes > 1) {
    const std::size_t below = nodes;
    nodes = (nodes + 3) / 4;
    tree.levels.emplace_back(nodes);
    const std::vector<Boxes>& lower = tree.levels[tree.levels.size() - 2];
    std::vector<Boxes>& upper = tree.levels.back();
    go_on = for_pieces(
        nodes,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t node = begin; node < end; ++node) {
            for (std::size_t child = 0; child < 4; ++child) {
              std::array<float, 3> low = {kInfinity, kInfinity, kInfinity};
              std::array<float, 3> high = {-kInfinity, -kInfinity, -kInfinity};
              if (4 * node + child < below) {
                const Boxes& boxes = lower[4 * node + child];
                for (std::size_t axis = 0; axis < 3; ++axis) {
                  low[axis] = *std::min_element(boxes.low[axis], boxes.low[axis] + 4);
                  high[axis] = *std::max_element(boxes.high[axis], boxes.high[axis] + 4);
                }
              }
              put_box(upper[node], child, low, high);
            }
          }
        },
        progress);
  }
  return go_on;
}

bool listed_before(const Crossing& a, const Crossing& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

/// What one piece of the search finds: all counted, and the first `most` listed, in no order yet.
class Findings {
 public:
  explicit Findings(std::size_t most) : most_(most) {}

  void add(const Crossing& crossing) {
    ++count_;
    listed_.push_back(crossing);
    if (listed_.size() >= 2 * most_ + 64) {
      shorten();
    }
  }

  void add(const Findings& other) {
    count_ += other.count_;
    listed_.insert(listed_.end(), other.listed_.begin(), other.listed_.end());
    if (listed_.size() >= 2 * most_ + 64) {
      shorten();
    }
  }

  std::uint64_t count() const { return count_; }

  std::vector<Crossing> sorted() {
    shorten();
    std::sort(listed_.begin(), listed_.end(), listed_before);
    return std::move(listed_);
  }

 private:
  void shorten() {
    if (listed_.size() > most_) {
      std::nth_element(listed_.begin(), listed_.begin() + static_cast<std::ptrdiff_t>(most_), listed_.end(),
                       listed_before);
      listed_.resize(most_);
    }
  }

  std::size_t most_;
  std::uint64_t count_ = 0;
  std::vector<Crossing> listed_;
};

/// Which children of `other` child `child` of `one` meets by its box: bit k for child k.
unsigned meeting_children(const Boxes& one, std::size_t child, const Boxes& other) {
  __m128 meets = _mm_castsi128_ps(_mm_set1_epi32(-1));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const __m128 low = _mm_set1_ps(one.low[axis][child]);
    const __m128 high = _mm_set1_ps(one.high[axis][child]);
    meets = _mm_and_ps(meets, _mm_cmple_ps(low, _mm_load_ps(other.high[axis])));
    meets = _mm_and_ps(meets, _mm_cmple_ps(_mm_load_ps(other.low[axis]), high));
  }
  return static_cast<unsigned>(_mm_movemask_ps(meets));
}

/// Two nodes of one level whose triangles are to be tested against each other; of a node and itself, each pair once.
struct NodePair {
  std::size_t one = 0;
  std::size_t other = 0;
};

/// Calls `visit` for the pairs of children of `pair` whose boxes meet.
template <class Visit>
void for_meeting_children(const std::vector<Boxes>& level, NodePair pair, const Visit& visit) {
  const Boxes& one = level[pair.one];
  const Boxes& other = level[pair.other];
  unsigned meeting = 0;  // bit 4 i + k: child i of the one and child k of the other
  for (unsigned child = 0; child < 4; ++child) {
    meeting |= meeting_children(one, child, other) << (4 * child);
  }
  if (pair.one == pair.other) {
    meeting &= 0x8cef;  // each child with itself and those after it
  }
  for (; meeting != 0; meeting &= meeting - 1) {
    const auto bit = static_cast<std::size_t>(std::countr_zero(meeting));
    visit(NodePair{4 * pair.one + bit / 4, 4 * pair.other + bit % 4});
  }
}

void search(const Tree& tree, std::size_t level, NodePair pair, Findings& findings) {
  if (level > 0) {
    for_meeting_children(tree.levels[level], pair,
                         [&](NodePair children) { search(tree, level - 1, children, findings); });
    return;
  }
  for_meeting_children(tree.levels[0], pair, [&](NodePair leaves) {
    if (leaves.one == leaves.other) {
      return;
    }
    const PlacedTriangle& a = tree.triangles[leaves.one];
    const PlacedTriangle& b = tree.triangles[leaves.other];
    // In the order of their indices, so that the place is the same however they are met.
    const bool swap = a.index > b.index;
    Crossing crossing{swap ? b.index : a.index, swap ? a.index : b.index, {}};
    if (detail::triangles_cross(swap ? b : a, swap ? a : b, crossing.place_mm)) {
      findings.add(crossing);
    }
  });
}

}  // namespace

Expected<CrossingReport> find_crossings(std::span<const Vec3> positions_mm, std::span<const Triangle> triangles,
                                        std::size_t max_listed, const Progress& progress) {
  if (std::optional<Error> error = check_input(positions_mm, triangles)) {
    return unexpected(*error);
  }
  CrossingReport report;
  if (triangles.empty()) {
    return report;
  }
  Tree tree;
  if (!build_tree(positions_mm, triangles, progress, tree)) {
    return unexpected(cancelled());
  }
  for (const PlacedTriangle& triangle : tree.triangles) {
    report.degenerate += triangle.degenerate ? 1 : 0;
  }

  // Down from the root, all pairs of one level after those of another, until they are small or many: one task each.
  std::size_t level = tree.levels.size() - 1;
  std::vector<NodePair> pairs = {{0, 0}};
  while (level > kTaskLevel && tree.levels[level - 1].size() <= kMostTaskNodes) {
    std::vector<NodePair> children;
    for (const NodePair pair : pairs) {
      for_meeting_children(tree.levels[level], pair, [&](NodePair next) { children.push_back(next); });
    }
    pairs = std::move(children);
    --level;
  }
  std::vector<Findings> found(pairs.size(), Findings(max_listed));
  const bool done = parallel_for(
      pairs.size(), [&](std::size_t i) { search(tree, level, pairs[i], found[i]); }, progress, kStage);
  if (!done) {
    return unexpected(cancelled());
  }
  Findings all(max_listed);
  for (const Findings& findings : found) {
    all.add(findings);
  }
  report.count = all.count();
  report.crossings = all.sorted();
  return report;
}

}  // namespace anthesis
