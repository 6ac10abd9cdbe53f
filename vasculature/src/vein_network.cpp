#include "vein_network.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"

namespace anthesis::veins {

std::uint32_t VeinNetwork::add(const NewVertex& vertex) {
  position.push_back(vertex.position);
  momentum.push_back(vertex.momentum);
  parent.push_back(vertex.parent);
  kind.push_back(vertex.kind);
  age.push_back(vertex.age);
  factor.push_back(vertex.factor);
  resistivity.push_back(vertex.resistivity);
  resistance.push_back(vertex.resistance);
  primordium.push_back(vertex.primordium);
  second.push_back(kNoVertex);
  return size() - 1;
}

void VeinNetwork::add_second_way(SecondWay way) {
  way.next = second[way.from];
  second[way.from] = static_cast<std::uint32_t>(second_ways.size());
  second_ways.push_back(way);
}

bool VeinNetwork::leads(std::uint32_t from, std::uint32_t to) const {
  std::vector<char> seen(second_ways.size(), 0);
  std::vector<std::uint32_t> starts = {from};
  while (!starts.empty()) {
    std::uint32_t v = starts.back();
    starts.pop_back();
    for (; v != kNoVertex; v = parent[v]) {
      if (v == to) {
        return true;
      }
      for (std::uint32_t w = second[v]; w != kNoVertex && !seen[w]; w = second_ways[w].next) {
        seen[w] = 1;
        starts.push_back(second_ways[w].to);
      }
    }
  }
  return false;
}

int VeinNetwork::edges_between(std::uint32_t a, std::uint32_t b) const {
  std::vector<std::uint32_t> way;
  for (std::uint32_t v = a; v != kNoVertex; v = parent[v]) {
    way.push_back(v);
  }
  int edges = 0;
  for (std::uint32_t v = b; v != kNoVertex; v = parent[v], ++edges) {
    const auto meeting = std::find(way.begin(), way.end(), v);
    if (meeting != way.end()) {
      return edges + static_cast<int>(meeting - way.begin());
    }
  }
  return -1;
}

void VeinNetwork::split(double length) {
  const std::uint32_t count = size();
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::uint32_t below = parent[v];
    if (below == kNoVertex) {
      continue;
    }
    const Vec3 edge = position[v] - position[below];
    if (dot(edge, edge) >= length * length) {
      parent[v] = add({lerp(position[below], position[v], 0.5),
                       {},
                       below,
                       kind[v],
                       age[below],
                       factor[below],
                       resistivity[below],
                       kInfinite,
                       primordium[v]});
    }
  }
}

void VeinNetwork::sort() {
  order = parents_first(size(), [&](std::uint32_t v) { return parent[v]; });
}

void VeinNetwork::update_resistance(std::uint32_t ring, double ground, int maturation, double mature) {
  ANTHESIS_ASSERT(order.size() == size());
  for (const std::uint32_t v : order) {
    const double z = maturation > 0 ? std::clamp(static_cast<double>(age[v]) / maturation, 0.0, 1.0) : 1.0;
    const double share = z * z * (3.0 - 2.0 * z);
    resistivity[v] = factor[v] * (ground * (1.0 - share) + mature * share);
    if (v < ring) {
      resistance[v] = 0.0;
    } else if (parent[v] == kNoVertex) {
      resistance[v] = kInfinite;
    } else {
      resistance[v] = resistance[parent[v]] + resistivity[v] * length(position[v] - position[parent[v]]);
    }
  }
}

void VeinNetwork::relabel() {
  for (auto v = order.rbegin(); v != order.rend(); ++v) {
    const std::uint32_t below = parent[*v];
    if (kind[*v] == VeinKind::kAdaxial && below != kNoVertex && kind[below] == VeinKind::kFloret) {
      kind[below] = VeinKind::kAdaxial;
    }
  }
}

bool VeinNetwork::forward_of(Vec3 tip, std::uint32_t vertex, Vec3 direction) const {
  constexpr double kLeastCosine = 0.2;
  const Vec3 way = position[vertex] - tip;
  const double sizes = length(way) * length(direction);
  return sizes > 0.0 && dot(way, direction) > kLeastCosine * sizes;
}

namespace {

/// What flows through each edge if every tip sends `tip_flow` of its kind, and what is left where a way divides.
struct Flow {
  std::vector<double> vertices;
  std::vector<double> second_ways;
};

Flow divided_flow(const VeinNetwork& network, const std::vector<double>& tip_flow, double second_share) {
  const std::uint32_t count = network.size();
  Flow flow{std::vector<double>(count, 0.0), std::vector<double>(network.second_ways.size(), 0.0)};
  std::vector<std::uint32_t> waiting(count, 0);  // edges that come in and have no flow yet
  for (std::uint32_t v = 0; v < count; ++v) {
    if (network.parent[v] != kNoVertex) {
      ++waiting[network.parent[v]];
    }
  }
  for (const SecondWay& way : network.second_ways) {
    ++waiting[way.to];
  }
  std::vector<std::uint32_t> ready;
  for (std::uint32_t v = count; v-- > 0;) {
    if (waiting[v] == 0) {
      flow.vertices[v] = tip_flow[v];
      ready.push_back(v);
    }
  }
  const auto deliver = [&](std::uint32_t to, double amount) {
    flow.vertices[to] += amount;
    if (--waiting[to] == 0) {
      ready.push_back(to);
    }
  };
  while (!ready.empty()) {
    const std::uint32_t v = ready.back();
    ready.pop_back();
    int ways = 0;
    for (std::uint32_t w = network.second[v]; w != kNoVertex; w = network.second_ways[w].next) {
      ++ways;
    }
    if (ways > 0) {
      const double all = second_share * flow.vertices[v];
      flow.vertices[v] -= all;
      for (std::uint32_t w = network.second[v]; w != kNoVertex; w = network.second_ways[w].next) {
        flow.second_ways[w] = all / ways;
        deliver(network.second_ways[w].to, all / ways);
      }
    }
    if (network.parent[v] != kNoVertex) {
      deliver(network.parent[v], flow.vertices[v]);
    }
  }
  return flow;
}

}  // namespace

Diameters diameters(const VeinNetwork& network, const VeinParams& params, std::uint32_t ring) {
  const std::uint32_t count = network.size();
  const double exponent = params.murray_exponent;
  Diameters result{std::vector<double>(count, 0.0), std::vector<double>(network.second_ways.size(), 0.0)};
  if (params.diameter_rule == DiameterRule::kMurray) {
    double by_kind[3];
    for (int k = 0; k < 3; ++k) {
      by_kind[k] = math::pow(params.tip_diameter_mm[k], exponent);
    }
    std::vector<double> tips(count, 0.0);
    for (std::uint32_t v = ring; v < count; ++v) {
      tips[v] = by_kind[static_cast<int>(network.kind[v])];
    }
    const Flow flow = divided_flow(network, tips, params.second_share);
    for (std::uint32_t v = 0; v < count; ++v) {
      result.vertices[v] = flow.vertices[v] > 0.0 ? math::pow(flow.vertices[v], 1.0 / exponent) : 0.0;
    }
    for (std::size_t w = 0; w < result.second_ways.size(); ++w) {
      result.second_ways[w] = math::pow(flow.second_ways[w], 1.0 / exponent);
    }
    return result;
  }
  // The number of tips above each vertex, and half of what a second connection serves once more below its outer end.
  std::vector<double> above(count, 0.0);
  std::vector<char> has_child(count, 0);
  for (const std::uint32_t p : network.parent) {
    if (p != kNoVertex) {
      has_child[p] = 1;
    }
  }
  for (auto v = network.order.rbegin(); v != network.order.rend(); ++v) {
    if (*v >= ring && !has_child[*v]) {
      above[*v] += 1.0;
    }
    if (network.parent[*v] != kNoVertex) {
      above[network.parent[*v]] += above[*v];
    }
  }
  std::vector<double> more(count, 0.0);
  for (const SecondWay& way : network.second_ways) {
    more[way.to] += 0.5 * above[way.aimed_from];
  }
  for (auto v = network.order.rbegin(); v != network.order.rend(); ++v) {
    if (network.parent[*v] != kNoVertex) {
      more[network.parent[*v]] += more[*v];
    }
    const double sum = above[*v] + more[*v];
    result.vertices[*v] =
        sum > 0.0 ? params.tip_diameter_mm[static_cast<int>(network.kind[*v])] * math::pow(sum, 1.0 / exponent) : 0.0;
  }
  for (std::size_t w = 0; w < result.second_ways.size(); ++w) {
    result.second_ways[w] = result.vertices[network.second_ways[w].to];
  }
  return result;
}

}  // namespace anthesis::veins
