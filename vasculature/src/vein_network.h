#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "anthesis/vasculature/vasculature.h"

namespace anthesis::veins {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// The vertices of a forest, parents before children; `parent_of(v)` is kNoVertex at roots. O(vertices).
template <class ParentOf>
std::vector<std::uint32_t> parents_first(std::uint32_t vertices, const ParentOf& parent_of) {
  std::vector<char> done(vertices, 0);
  std::vector<std::uint32_t> order;
  order.reserve(vertices);
  std::vector<std::uint32_t> way;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    for (std::uint32_t u = v; u != kNoVertex && !done[u]; u = parent_of(u)) {
      done[u] = 1;
      way.push_back(u);
    }
    order.insert(order.end(), way.rbegin(), way.rend());
    way.clear();
  }
  return order;
}

struct NewVertex {
  Vec3 position;
  Vec3 momentum;
  std::uint32_t parent = kNoVertex;
  VeinKind kind = VeinKind::kAbaxial;
  int age = 0;
  double factor = 1.0;
  double resistivity = 0.0;
  double resistance = kInfinite;
  std::uint32_t primordium = kNoPrimordium;
};

struct SecondWay {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::uint32_t aimed_from = 0;  ///< the vertex that the second strand was to reach
  std::uint32_t primordium = 0;
  std::uint32_t next = kNoVertex;  ///< another second way from the same vertex
};

/// The growing forest, as columns. Vertices are appended and never removed.
struct VeinNetwork {
  std::vector<Vec3> position;
  std::vector<Vec3> momentum;  ///< depth vector of a primordium, direction and momentum of a tip
  std::vector<std::uint32_t> parent;
  std::vector<VeinKind> kind;
  std::vector<int> age;
  std::vector<double> factor;  ///< of the resistivity
  std::vector<double> resistivity;
  std::vector<double> resistance;  ///< to the ring; infinite until the end of the frame in which a vertex is made
  std::vector<std::uint32_t> primordium;
  std::vector<std::uint32_t> second;  ///< the latest second way from a vertex; kNoVertex: none
  std::vector<SecondWay> second_ways;
  std::vector<std::uint32_t> order;  ///< parents before children, once sorted

  std::uint32_t size() const { return static_cast<std::uint32_t>(position.size()); }
  std::uint32_t add(const NewVertex& vertex);
  void add_second_way(SecondWay way);

  /// Whether a way towards the ring, first or second connections, leads from one vertex to the other (or is the other).
  bool leads(std::uint32_t from, std::uint32_t to) const;

  /// Edges between two vertices along first connections; -1: they are not of one tree.
  int edges_between(std::uint32_t a, std::uint32_t b) const;

  /// Halves every edge of at least that length, once. The new vertex is as the lower end, but of the upper's kind.
  void split(double length);

  void sort();  ///< fills `order`; O(vertices)

  /// Resistivity by age and resistance to the ring, from `order`; infinite where there is no ring below.
  void update_resistance(std::uint32_t ring, double ground, int maturation, double mature);

  /// A floret's vertex below one of an adaxial strand is adaxial.
  void relabel();

  bool forward_of(Vec3 tip, std::uint32_t vertex, Vec3 direction) const;
};

/// Diameters of the edges towards the base and of second connections.
struct Diameters {
  std::vector<double> vertices;
  std::vector<double> second_ways;
};
Diameters diameters(const VeinNetwork& network, const VeinParams& params, std::uint32_t ring);

}  // namespace anthesis::veins
