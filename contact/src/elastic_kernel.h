#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// What the projections of a block of organs read and write. One lane is one organ, so that the vertices of a
/// constraint are the same in all lanes: no gathers, no colouring, and each organ keeps its sequential order.
namespace anthesis::elastic {

inline constexpr std::size_t kLanes = 8;

/// One number of each organ of a block.
struct alignas(64) Lanes {
  double value[kLanes];
};

struct Edge {
  std::array<std::uint32_t, 2> vertices;
  double half_share;  ///< of the error, for each of the two ends
};

struct Hinge {
  std::array<std::uint32_t, 4> vertices;  ///< edge, apex, other apex: as in Sheet
  double share;
};

struct Attachment {
  std::uint32_t vertex;
  double share;
};

/// In the order of projection.
struct Constraints {
  std::vector<Edge> edges;
  std::vector<Hinge> hinges;
  std::vector<Attachment> attachments;
};

struct Block {
  std::size_t vertex_count;
  Lanes* positions;  ///< x, y, z of each vertex
  Lanes* lengths;    ///< of each edge at rest
  Lanes* bends;      ///< two for each hinge at rest: a positive multiple of the angle's cosine and minus its sine
  Lanes* anchors;    ///< x, y, z of each attachment
  // Of settling alone:
  Lanes* before;         ///< x, y, z of each vertex after the last sweep
  Lanes* ahead;          ///< and where the present sweep started
  Lanes* momentum_ages;  ///< sweeps since each organ stood still
};

}  // namespace anthesis::elastic
