#include "anthesis/vasculature/vein_measures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"
#include "vein_network.h"

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

/// One measurement of one head.
class Measuring {
 public:
  Measuring(const Vasculature& veins, int sectors)
      : veins_(veins),
        count_(static_cast<std::uint32_t>(veins.vertices.size())),
        per_radian_(static_cast<double>(sectors) / math::kTurnRad),
        order_(veins::parents_first(count_, [&](std::uint32_t v) { return veins.vertices[v].parent; })) {}

  VasculatureMeasures run() {
    count_vertices();
    count_loops();
    for (const SecondConnection& second : veins_.second_connections) {
      result_.total_length += length(position(second.from) - position(second.to));
    }
    const std::vector<int> orders = strand_orders();
    for (const std::uint32_t surface : veins_.primordia) {
      StrandMeasures& strand = result_.strands.emplace_back();
      strand.vertex = surface;
      strand.connected = surface != kNoVertex && is_connected(surface);
      if (strand.connected) {
        strand.order = orders[surface];
        result_.highest_order = std::max(result_.highest_order, strand.order);
        follow(strand);
      }
    }
    return std::move(result_);
  }

 private:
  Vec3 position(std::uint32_t v) const { return veins_.vertices[v].position; }
  std::uint32_t parent(std::uint32_t v) const { return veins_.vertices[v].parent; }
  double edge(std::uint32_t v) const { return length(position(v) - position(parent(v))); }
  bool is_connected(std::uint32_t v) const { return std::isfinite(veins_.vertices[v].resistance); }

  /// Tips, joints, bundles, total length; Strahler's numbers from the tips down.
  void count_vertices() {
    std::vector<std::uint32_t> children(count_, 0);
    std::vector<int> highest(count_, 0);
    std::vector<std::uint32_t> with_highest(count_, 0);
    std::vector<int>& strahler = result_.strahler;
    strahler.assign(count_, 0);
    for (auto v = order_.rbegin(); v != order_.rend(); ++v) {
      const std::uint32_t below = parent(*v);
      strahler[*v] = children[*v] == 0 ? 1 : with_highest[*v] >= 2 ? highest[*v] + 1 : highest[*v];
      if (*v < veins_.ring_vertices) {
        result_.bundles += children[*v] > 0;
        strahler[*v] = children[*v] > 0 ? strahler[*v] : 0;
      } else if (is_connected(*v)) {
        result_.tips += children[*v] == 0;
        result_.joints += children[*v] >= 2;
      }
      if (below == kNoVertex) {
        continue;
      }
      result_.total_length += edge(*v);
      ++children[below];
      if (strahler[*v] > highest[below]) {
        highest[below] = strahler[*v];
        with_highest[below] = 1;
      } else if (strahler[*v] == highest[below]) {
        ++with_highest[below];
      }
    }
  }

  /// Loops: edges that join what is joined already. A second connection is such an edge if its trees are joined.
  void count_loops() {
    for (const bool through_ring : {false, true}) {
      Sets sets(count_);
      for (std::uint32_t v = 0; v < count_; ++v) {
        if (parent(v) != kNoVertex) {
          sets.join(v, parent(v));
        } else if (through_ring && v > 0 && v < veins_.ring_vertices) {
          sets.join(v, 0);
        }
      }
      std::size_t& loops = through_ring ? result_.loops_through_ring : result_.loops;
      for (const SecondConnection& second : veins_.second_connections) {
        loops += !sets.join(second.from, second.to);
      }
    }
  }

  /// Of each vertex the order of its strand: one more than that of the strand it joins.
  std::vector<int> strand_orders() const {
    std::vector<int> orders(count_, 0);
    for (const std::uint32_t v : order_) {
      const std::uint32_t below = parent(v);
      if (v < veins_.ring_vertices || below == kNoVertex) {
        continue;
      }
      const bool goes_on =
          below >= veins_.ring_vertices && veins_.vertices[below].primordium == veins_.vertices[v].primordium;
      orders[v] = goes_on ? orders[below] : orders[below] + 1;
    }
    return orders;
  }

  /// The way from a primordium to the ring.
  void follow(StrandMeasures& strand) const {
    const std::uint32_t own = veins_.vertices[strand.vertex].primordium;
    bool on_own = true;
    bool known = false;  // a vertex on the axis has no azimuth
    double azimuth = 0.0;
    double least = 0.0;  // turned so far, at most to either side
    double most = 0.0;
    for (std::uint32_t v = strand.vertex; v != kNoVertex; v = parent(v)) {
      const Vec3 p = position(v);
      if (p.x != 0.0 || p.y != 0.0) {
        const double next = math::atan2(p.y, p.x);
        if (known) {
          double turn = next - azimuth;
          turn -= math::kTurnRad * std::round(turn / math::kTurnRad);
          strand.turned_rad += turn;
          least = std::min(least, strand.turned_rad);
          most = std::max(most, strand.turned_rad);
        }
        azimuth = next;
        known = true;
      }
      if (parent(v) == kNoVertex) {
        strand.bundle = v;
        strand.sectors_crossed =
            static_cast<int>(std::floor(most * per_radian_ + 0.5) - std::floor(least * per_radian_ + 0.5));
        break;
      }
      strand.length_to_ring += edge(v);
      on_own = on_own && veins_.vertices[v].primordium == own;
      if (on_own) {
        strand.own_length += edge(v);
      }
    }
  }

  const Vasculature& veins_;
  std::uint32_t count_;
  double per_radian_;  ///< sectors
  std::vector<std::uint32_t> order_;
  VasculatureMeasures result_;
};

}  // namespace

VasculatureMeasures measure(const Vasculature& veins, int sectors) {
  ANTHESIS_ASSERT(sectors >= 1);
  return Measuring(veins, sectors).run();
}

}  // namespace anthesis
