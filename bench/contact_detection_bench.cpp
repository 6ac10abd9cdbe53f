// Broad and narrow phase of the peers' scenes, on one thread, beside the ways it was turned down for: the voxel grid
// and the cubic of the paper (Owens et al. 2016, section 3; Provot 1997), and a hierarchy of boxes made anew each time.
//
// Published by ipc-toolkit 1.6.0 (LBVH and additive or Tight-Inclusion continuous detection) on the same files, one
// thread of a server processor, stands in the counters as peer_ms.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "anthesis/base/parallel.h"
#include "anthesis/contact/continuous.h"
#include "anthesis/contact/detector.h"
#include "contact_scene.h"

namespace anthesis {
namespace {

constexpr std::uint32_t kVerticesOfBody = ContactScene::kVerticesOfBody;

struct PeerScene {
  const char* file;
  double broad_ms;             ///< LBVH
  double narrow_ms;            ///< additive continuous detection, earliest time only
  double inclusion_narrow_ms;  ///< Tight-Inclusion, earliest time only
};
constexpr PeerScene kPeerScenes[] = {
    {"art_16x19_a05", 10.3, 1.4, 14.2}, {"art_154x19_a05", 170.0, 139.0, 1044.0}, {"art_154x19", 182.0, 190.0, 1247.0}};

struct Scene {
  std::vector<Sheet> sheets;
  std::vector<Vec3> from_mm;
  std::vector<Vec3> to_mm;
  std::vector<ContactBody> bodies;
};

Scene load(const char* file) {
  ContactScene read = read_contact_scene(file);
  Scene scene;
  scene.from_mm = std::move(read.from_mm);
  scene.to_mm = std::move(read.to_mm);
  for (std::uint32_t b = 0; b < read.body_count; ++b) {
    scene.bodies.push_back({0, read.first_vertex(b)});
  }
  scene.sheets.push_back(std::move(read.sheet));
  return scene;
}

bool loaded(benchmark::State& state, const Scene& scene) {
  if (scene.bodies.empty()) {
    state.SkipWithError(kNoContactScene);
  }
  return !scene.bodies.empty();
}

std::array<Vec3, 4> points_of(const std::vector<Vec3>& positions_mm, const CandidatePair& pair) {
  return {positions_mm[pair.vertices[0]], positions_mm[pair.vertices[1]], positions_mm[pair.vertices[2]],
          positions_mm[pair.vertices[3]]};
}

struct Outcome {
  std::size_t touches = 0;
  std::size_t undecided = 0;
  double earliest = 1.0;
};

Outcome touches_by_planes(const Scene& scene, const std::vector<CandidatePair>& pairs) {
  Outcome outcome;
  for (const CandidatePair& pair : pairs) {
    const std::array<Vec3, 4> from = points_of(scene.from_mm, pair);
    const std::array<Vec3, 4> to = points_of(scene.to_mm, pair);
    const Touch touch = pair.edges ? first_touch_edge_edge(from, to) : first_touch_vertex_triangle(from, to);
    outcome.touches += touch.touches;
    outcome.undecided += touch.undecided;
    outcome.earliest = std::min(outcome.earliest, touch.time);
  }
  return outcome;
}

void report(benchmark::State& state, std::size_t candidates, const Outcome& outcome) {
  state.counters["candidates"] = static_cast<double>(candidates);
  state.counters["touches"] = static_cast<double>(outcome.touches);
  state.counters["undecided"] = static_cast<double>(outcome.undecided);
  state.counters["earliest"] = outcome.earliest;
}

void BM_BroadPhase(benchmark::State& state) {
  const ThreadLimit one(1);
  const PeerScene& peer = kPeerScenes[state.range(0)];
  const Scene scene = load(peer.file);
  if (!loaded(state, scene)) {
    return;
  }
  Detector detector(scene.sheets);
  std::vector<CandidatePair> pairs;
  detector.find_on_course(scene.from_mm, scene.to_mm, scene.bodies, pairs);
  for (auto _ : state) {
    detector.find_on_course(scene.from_mm, scene.to_mm, scene.bodies, pairs);
  }
  state.SetLabel(peer.file);
  state.counters["candidates"] = static_cast<double>(pairs.size());
  state.counters["peer_ms"] = peer.broad_ms;
}
BENCHMARK(BM_BroadPhase)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

void BM_NarrowPhase(benchmark::State& state) {
  const PeerScene& peer = kPeerScenes[state.range(0)];
  const Scene scene = load(peer.file);
  if (!loaded(state, scene)) {
    return;
  }
  Detector detector(scene.sheets);
  std::vector<CandidatePair> pairs;
  detector.find_on_course(scene.from_mm, scene.to_mm, scene.bodies, pairs);
  Outcome outcome;
  for (auto _ : state) {
    outcome = touches_by_planes(scene, pairs);
  }
  state.SetLabel(peer.file);
  report(state, pairs.size(), outcome);
  state.counters["peer_ms"] = peer.narrow_ms;
  state.counters["inclusion_peer_ms"] = peer.inclusion_narrow_ms;
}
BENCHMARK(BM_NarrowPhase)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

void BM_BroadAndNarrowPhase(benchmark::State& state) {
  const ThreadLimit one(1);
  const PeerScene& peer = kPeerScenes[state.range(0)];
  const Scene scene = load(peer.file);
  if (!loaded(state, scene)) {
    return;
  }
  Detector detector(scene.sheets);
  std::vector<CandidatePair> pairs;
  Outcome outcome;
  detector.find_on_course(scene.from_mm, scene.to_mm, scene.bodies, pairs);
  for (auto _ : state) {
    detector.find_on_course(scene.from_mm, scene.to_mm, scene.bodies, pairs);
    outcome = touches_by_planes(scene, pairs);
  }
  state.SetLabel(peer.file);
  report(state, pairs.size(), outcome);
  state.counters["peer_ms"] = peer.broad_ms + peer.narrow_ms;
  state.counters["inclusion_peer_ms"] = peer.broad_ms + peer.inclusion_narrow_ms;
}
BENCHMARK(BM_BroadAndNarrowPhase)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

/// Near pairs at rest, for a reach of a percentage of the edge length.
void BM_FindNear(benchmark::State& state) {
  const ThreadLimit one(1);
  Scene scene = load("art_154x19_a05");
  if (!loaded(state, scene)) {
    return;
  }
  const Triangle& triangle = scene.sheets[0].triangles[0];
  const double edge_mm = length(scene.from_mm[triangle[0]] - scene.from_mm[triangle[1]]);
  for (ContactBody& body : scene.bodies) {
    body.reach_mm = 0.5 * static_cast<double>(state.range(0)) / 100.0 * edge_mm;  // of both bodies together
  }
  Detector detector(scene.sheets);
  std::vector<Contact> contacts;
  for (auto _ : state) {
    detector.find_near(scene.from_mm, scene.bodies, contacts);
  }
  state.counters["contacts"] = static_cast<double>(contacts.size());
}
BENCHMARK(BM_FindNear)->Arg(2)->Arg(10)->Arg(25)->Unit(benchmark::kMillisecond);

// ---------------------------------------------------------------------------------------------------------------------
// Baselines

/// Around the motion of a primitive.
struct Box {
  Vec3 low;
  Vec3 high;
};

/// Vertices, triangles and edges of the whole scene with the boxes around their motion.
struct Primitives {
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<Triangle> triangles;
  std::vector<Box> vertex_boxes;
  std::vector<Box> edge_boxes;
  std::vector<Box> triangle_boxes;
};

Box joined(const Box& a, const Box& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

bool overlap(const Box& a, const Box& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

void fit(const Scene& scene, Primitives& primitives) {
  constexpr double kEnlargedBy = 1e-9;  // "a small amount"
  const Vec3 more{kEnlargedBy, kEnlargedBy, kEnlargedBy};
  primitives.vertex_boxes.resize(scene.from_mm.size());
  for (std::size_t i = 0; i < scene.from_mm.size(); ++i) {
    const Box box = joined({scene.from_mm[i], scene.from_mm[i]}, {scene.to_mm[i], scene.to_mm[i]});
    primitives.vertex_boxes[i] = {box.low - more, box.high + more};
  }
  primitives.edge_boxes.resize(primitives.edges.size());
  for (std::size_t i = 0; i < primitives.edges.size(); ++i) {
    const auto& e = primitives.edges[i];
    primitives.edge_boxes[i] = joined(primitives.vertex_boxes[e[0]], primitives.vertex_boxes[e[1]]);
  }
  primitives.triangle_boxes.resize(primitives.triangles.size());
  for (std::size_t i = 0; i < primitives.triangles.size(); ++i) {
    const auto& t = primitives.triangles[i];
    primitives.triangle_boxes[i] =
        joined(joined(primitives.vertex_boxes[t[0]], primitives.vertex_boxes[t[1]]), primitives.vertex_boxes[t[2]]);
  }
}

Primitives primitives_of(const Scene& scene) {
  Primitives primitives;
  for (const ContactBody& body : scene.bodies) {
    for (const Triangle& t : scene.sheets[0].triangles) {
      primitives.triangles.push_back({body.first_vertex + t[0], body.first_vertex + t[1], body.first_vertex + t[2]});
    }
    for (const auto& e : scene.sheets[0].edges) {
      primitives.edges.push_back({body.first_vertex + e[0], body.first_vertex + e[1]});
    }
  }
  return primitives;
}

void add_vertex_triangle(const Primitives& primitives, std::size_t vertex, std::size_t triangle,
                         std::vector<CandidatePair>& pairs) {
  const Triangle& t = primitives.triangles[triangle];
  const auto v = static_cast<std::uint32_t>(vertex);
  if (v != t[0] && v != t[1] && v != t[2]) {
    pairs.push_back({{v, t[0], t[1], t[2]}, v / kVerticesOfBody, t[0] / kVerticesOfBody, false});
  }
}

void add_edges(const Primitives& primitives, std::size_t first, std::size_t second, std::vector<CandidatePair>& pairs) {
  const auto& a = primitives.edges[first];
  const auto& b = primitives.edges[second];
  if (a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1]) {
    pairs.push_back({{a[0], a[1], b[0], b[1]}, a[0] / kVerticesOfBody, b[0] / kVerticesOfBody, true});
  }
}

/// A regular grid whose cells are as long as the mean box, in a hash table.
class VoxelGrid {
 public:
  explicit VoxelGrid(const std::vector<Box>& boxes) : boxes_(boxes) {
    double sum = 0.0;
    for (const Box& box : boxes) {
      const Vec3 size = box.high - box.low;
      sum += std::max({size.x, size.y, size.z});
    }
    per_mm_ = static_cast<double>(boxes.size()) / sum;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for_cells(boxes[i], [&](const std::array<std::int64_t, 3>& cell) {
        entries_.push_back({code(cell), static_cast<std::uint32_t>(i)});
      });
    }
    starts_.assign((std::size_t{1} << kBits) + 1, 0);
    for (const Entry& entry : entries_) {
      ++starts_[(entry.cell & kMask) + 1];
    }
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    std::vector<Entry> sorted(entries_.size());
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (const Entry& entry : entries_) {
      sorted[next[entry.cell & kMask]++] = entry;
    }
    entries_.swap(sorted);
  }

  /// Calls visit(i) once for each of the grid's boxes that overlap `box`.
  template <class Visit>
  void at(const Box& box, const Visit& visit) const {
    for_cells(box, [&](const std::array<std::int64_t, 3>& cell) {
      const std::uint64_t wanted = code(cell);
      for (std::size_t k = starts_[wanted & kMask]; k < starts_[(wanted & kMask) + 1]; ++k) {
        if (entries_[k].cell != wanted) {
          continue;
        }
        const Box& other = boxes_[entries_[k].primitive];
        // Only in the first of the cells that both lie in.
        if (overlap(box, other) && cell == cell_of({std::max(box.low.x, other.low.x), std::max(box.low.y, other.low.y),
                                                    std::max(box.low.z, other.low.z)})) {
          visit(entries_[k].primitive);
        }
      }
    });
  }

 private:
  struct Entry {
    std::uint64_t cell;
    std::uint32_t primitive;
  };
  static constexpr int kBits = 18;
  static constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;

  std::array<std::int64_t, 3> cell_of(Vec3 p) const {
    return {static_cast<std::int64_t>(std::floor(p.x * per_mm_)), static_cast<std::int64_t>(std::floor(p.y * per_mm_)),
            static_cast<std::int64_t>(std::floor(p.z * per_mm_))};
  }
  /// A hash without collisions: 21 bits for each coordinate, mixed by an odd factor.
  static std::uint64_t code(const std::array<std::int64_t, 3>& cell) {
    std::uint64_t key = 0;
    for (const std::int64_t c : cell) {
      key = key << 21 | (static_cast<std::uint64_t>(c) & 0x1fffff);
    }
    key *= 0x9e3779b97f4a7c15ull;
    return key ^ key >> 32;
  }
  template <class Visit>
  void for_cells(const Box& box, const Visit& visit) const {
    const std::array<std::int64_t, 3> low = cell_of(box.low);
    const std::array<std::int64_t, 3> high = cell_of(box.high);
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          visit({x, y, z});
        }
      }
    }
  }

  const std::vector<Box>& boxes_;
  double per_mm_ = 1.0;
  std::vector<Entry> entries_;
  std::vector<std::size_t> starts_;
};

/// One binary tree of axis-aligned boxes over all primitives of a kind, by halves along the longest side.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Box>& boxes) : boxes_(boxes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    nodes_.reserve(2 * boxes.size());
    split(0, static_cast<std::uint32_t>(boxes.size()));
  }

  template <class Visit>
  void at(const Box& box, const Visit& visit) const {
    std::array<std::uint32_t, 64> stack;
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t i = stack[--depth];
      const Node& node = nodes_[i];
      if (!overlap(box, node.box)) {
        continue;
      }
      if (node.right != 0) {
        stack[depth++] = node.right;
        stack[depth++] = i + 1;
        continue;
      }
      for (std::uint32_t k = node.begin; k < node.end; ++k) {
        if (overlap(box, boxes_[order_[k]])) {
          visit(order_[k]);
        }
      }
    }
  }

 private:
  struct Node {
    Box box;
    std::uint32_t begin;
    std::uint32_t end;
    std::uint32_t right;
  };

  void split(std::uint32_t begin, std::uint32_t end) {
    const std::size_t index = nodes_.size();
    Box box = boxes_[order_[begin]];
    for (std::uint32_t k = begin; k < end; ++k) {
      box = joined(box, boxes_[order_[k]]);
    }
    nodes_.push_back({box, begin, end, 0});
    if (end - begin <= 4) {
      return;
    }
    const Vec3 size = box.high - box.low;
    double Vec3::*const axis = size.x >= size.y && size.x >= size.z ? &Vec3::x : size.y >= size.z ? &Vec3::y : &Vec3::z;
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return boxes_[a].low.*axis + boxes_[a].high.*axis < boxes_[b].low.*axis + boxes_[b].high.*axis;
                     });
    split(begin, middle);
    nodes_[index].right = static_cast<std::uint32_t>(nodes_.size());
    split(middle, end);
  }

  const std::vector<Box>& boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

template <class Index>
void find_by_boxes(const Scene& scene, Primitives& primitives, std::vector<CandidatePair>& pairs) {
  pairs.clear();
  fit(scene, primitives);
  const Index triangles(primitives.triangle_boxes);
  for (std::size_t v = 0; v < primitives.vertex_boxes.size(); ++v) {
    triangles.at(primitives.vertex_boxes[v], [&](std::uint32_t t) { add_vertex_triangle(primitives, v, t, pairs); });
  }
  const Index edges(primitives.edge_boxes);
  for (std::size_t e = 0; e < primitives.edge_boxes.size(); ++e) {
    edges.at(primitives.edge_boxes[e], [&](std::uint32_t f) {
      if (e < f) {
        add_edges(primitives, e, f, pairs);
      }
    });
  }
}

template <class Index>
void BM_BaselineBroadPhase(benchmark::State& state) {
  const PeerScene& peer = kPeerScenes[state.range(0)];
  const Scene scene = load(peer.file);
  if (!loaded(state, scene)) {
    return;
  }
  Primitives primitives = primitives_of(scene);
  std::vector<CandidatePair> pairs;
  for (auto _ : state) {
    find_by_boxes<Index>(scene, primitives, pairs);
  }
  state.SetLabel(peer.file);
  report(state, pairs.size(), touches_by_planes(scene, pairs));
}
BENCHMARK(BM_BaselineBroadPhase<VoxelGrid>)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_BaselineBroadPhase<BoxTree>)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

/// Provot 1997 as it is usually programmed: where the cubic of coplanarity has a root, ask whether the points are
/// inside there. It misses touches for rounding, whatever the tolerances.
bool touches_by_cubic(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to, bool edges) {
  constexpr double kTolerance = 1e-6;
  const Vec3 a = from[1] - from[0];
  const Vec3 b = from[2] - from[0];
  const Vec3 c = from[3] - from[0];
  const Vec3 da = to[1] - to[0] - a;
  const Vec3 db = to[2] - to[0] - b;
  const Vec3 dc = to[3] - to[0] - c;
  const std::array<double, 4> k = {dot(a, cross(b, c)), dot(da, cross(b, c)) + dot(a, cross(db, c) + cross(b, dc)),
                                   dot(a, cross(db, dc)) + dot(da, cross(db, c) + cross(b, dc)),
                                   dot(da, cross(db, dc))};
  const auto value = [&](double t) { return k[0] + t * (k[1] + t * (k[2] + t * k[3])); };
  // Between the extrema the cubic is monotonic.
  std::array<double, 4> borders = {0.0, 1.0, 1.0, 1.0};
  int border_count = 1;
  const double root = k[2] * k[2] - 3.0 * k[3] * k[1];
  if (root > 0.0) {
    const double q = -(k[2] + std::copysign(std::sqrt(root), k[2]));
    std::array<double, 2> extrema = {q / (3.0 * k[3]), k[1] / q};
    std::sort(extrema.begin(), extrema.end());
    for (const double t : extrema) {
      if (t > borders[border_count - 1] && t < 1.0) {
        borders[border_count++] = t;
      }
    }
  }
  borders[border_count++] = 1.0;
  for (int i = 0; i + 1 < border_count; ++i) {
    double low = borders[i];
    double high = borders[i + 1];
    double at_low = value(low);
    if (at_low * value(high) > 0.0) {
      continue;
    }
    for (int step = 0; step < 60 && high - low > 1e-12; ++step) {
      const double middle = 0.5 * (low + high);
      const double at_middle = value(middle);
      if (at_low * at_middle <= 0.0) {
        high = middle;
      } else {
        low = middle;
        at_low = at_middle;
      }
    }
    std::array<Vec3, 4> points;
    for (int p = 0; p < 4; ++p) {
      points[p] = lerp(from[p], to[p], high);
    }
    if ((edges ? nearest_edge_edge(points) : nearest_vertex_triangle(points)).distance < kTolerance) {
      return true;
    }
  }
  return false;
}

void BM_BaselineNarrowPhaseByCubic(benchmark::State& state) {
  const ThreadLimit one(1);
  const PeerScene& peer = kPeerScenes[state.range(0)];
  const Scene scene = load(peer.file);
  if (!loaded(state, scene)) {
    return;
  }
  Detector detector(scene.sheets);
  std::vector<CandidatePair> pairs;
  detector.find_on_course(scene.from_mm, scene.to_mm, scene.bodies, pairs);
  std::size_t touches = 0;
  for (auto _ : state) {
    touches = 0;
    for (const CandidatePair& pair : pairs) {
      touches += touches_by_cubic(points_of(scene.from_mm, pair), points_of(scene.to_mm, pair), pair.edges);
    }
    benchmark::DoNotOptimize(touches);
  }
  state.SetLabel(peer.file);
  state.counters["candidates"] = static_cast<double>(pairs.size());
  state.counters["touches"] = static_cast<double>(touches);
}
BENCHMARK(BM_BaselineNarrowPhaseByCubic)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace anthesis
