#include "anthesis/vasculature/vein_measures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"

namespace anthesis {
namespace {

/// Disjoint sets, with halved paths.
class Sets {
 public:
  explicit Sets(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), 0u); }
  std::uint32_t find(std::uint32_t v) {
    while (root_[v] != v) {
      root_[v] = root_[root_[v]];
      v = root_[v];
    }
    return v;
  }
  bool join(std::uint32_t a, std::uint32_t b) {  // false: they were one already
    a = find(a);
    b = find(b);
    root_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<std::uint32_t> root_;
};

std::vector<std::uint32_t> parents_first(const Vasculature& veins) {
  const std::size_t count = veins.vertices.size();
  std::vector<char> done(count, 0);
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> way;
  order.reserve(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    for (std::uint32_t u = v; u != kNoVertex && !done[u]; u = veins.vertices[u].parent) {
      done[u] = 1;
      way.push_back(u);
    }
    order.insert(order.end(), way.rbegin(), way.rend());
    way.clear();
  }
  return order;
}

}  // namespace

VasculatureMeasures measure(const Vasculature& veins, int sectors) {
  ANTHESIS_ASSERT(sectors >= 1);
  const auto count = static_cast<std::uint32_t>(veins.vertices.size());
  VasculatureMeasures result;
  const std::vector<std::uint32_t> order = parents_first(veins);
  const auto edge = [&](std::uint32_t v) {
    return length(veins.vertices[v].position - veins.vertices[veins.vertices[v].parent].position);
  };
  const auto is_connected = [&](std::uint32_t v) { return std::isfinite(veins.vertices[v].resistance); };

  // Tips, joints, bundles; Strahler's numbers from the tips down.
  std::vector<std::uint32_t> children(count, 0);
  std::vector<int> highest(count, 0);
  std::vector<std::uint32_t> with_highest(count, 0);
  result.strahler.assign(count, 0);
  for (auto v = order.rbegin(); v != order.rend(); ++v) {
    const std::uint32_t below = veins.vertices[*v].parent;
    result.strahler[*v] = children[*v] == 0 ? 1 : with_highest[*v] >= 2 ? highest[*v] + 1 : highest[*v];
    if (*v < veins.ring_vertices) {
      result.bundles += children[*v] > 0;
      result.strahler[*v] = children[*v] > 0 ? result.strahler[*v] : 0;
    } else if (is_connected(*v)) {
      result.tips += children[*v] == 0;
      result.joints += children[*v] >= 2;
    }
    if (below == kNoVertex) {
      continue;
    }
    result.total_length += edge(*v);
    ++children[below];
    if (result.strahler[*v] > highest[below]) {
      highest[below] = result.strahler[*v];
      with_highest[below] = 1;
    } else if (result.strahler[*v] == highest[below]) {
      ++with_highest[below];
    }
  }

  // Loops: edges that join what is joined already. A second connection is such an edge if its trees are joined.
  for (const bool through_ring : {false, true}) {
    Sets sets(count);
    for (std::uint32_t v = 0; v < count; ++v) {
      if (veins.vertices[v].parent != kNoVertex) {
        sets.join(v, veins.vertices[v].parent);
      } else if (through_ring && v > 0 && v < veins.ring_vertices) {
        sets.join(v, 0);
      }
    }
    std::size_t loops = 0;
    for (const SecondConnection& second : veins.second_connections) {
      loops += !sets.join(second.from, second.to);
    }
    (through_ring ? result.loops_through_ring : result.loops) = loops;
  }
  for (const SecondConnection& second : veins.second_connections) {
    result.total_length += length(veins.vertices[second.from].position - veins.vertices[second.to].position);
  }

  // Order of a strand: one more than that of the strand it joins. Parents first, so that this one is known.
  std::vector<int> strand_order(count, 0);
  for (const std::uint32_t v : order) {
    const std::uint32_t below = veins.vertices[v].parent;
    if (v < veins.ring_vertices || below == kNoVertex) {
      continue;
    }
    const bool goes_on =
        below >= veins.ring_vertices && veins.vertices[below].primordium == veins.vertices[v].primordium;
    strand_order[v] = goes_on ? strand_order[below] : strand_order[below] + 1;
  }

  const double per_sector = static_cast<double>(sectors) / math::kTurnRad;
  for (const std::uint32_t surface : veins.primordia) {
    StrandMeasures& strand = result.strands.emplace_back();
    if (surface == kNoVertex) {
      continue;
    }
    strand.vertex = surface;
    strand.connected = is_connected(surface);
    if (!strand.connected) {
      continue;
    }
    strand.order = strand_order[surface];
    result.highest_order = std::max(result.highest_order, strand.order);
    const std::uint32_t own = veins.vertices[surface].primordium;
    bool on_own = true;
    double azimuth = 0.0;
    bool known = false;  // a vertex on the axis has no azimuth
    double at = 0.0;     // azimuth followed along the way
    for (std::uint32_t v = surface; v != kNoVertex; v = veins.vertices[v].parent) {
      const Vec3 p = veins.vertices[v].position;
      if (p.x != 0.0 || p.y != 0.0) {
        const double next = math::atan2(p.y, p.x);
        if (!known) {
          at = next;
        } else {
          double turn = next - azimuth;
          turn -= math::kTurnRad * std::round(turn / math::kTurnRad);
          strand.turned_rad += turn;
          strand.sectors_crossed +=
              static_cast<int>(std::abs(std::floor((at + turn) * per_sector) - std::floor(at * per_sector)));
          at += turn;
        }
        azimuth = next;
        known = true;
      }
      if (veins.vertices[v].parent == kNoVertex) {
        strand.bundle = v;
        break;
      }
      strand.length_to_ring += edge(v);
      on_own = on_own && veins.vertices[v].primordium == own;
      if (on_own) {
        strand.own_length += edge(v);
      }
    }
  }
  return result;
}

}  // namespace anthesis
