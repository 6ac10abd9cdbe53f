#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/geometry/mesh.h"

namespace anthesis {

/// Two triangles that cross.
struct Crossing {
  std::uint32_t first = 0;  ///< index of the triangle, the smaller one
  std::uint32_t second = 0;
  Vec3 place_mm;  ///< a point at or very near the crossing
};

struct CrossingReport {
  std::uint64_t count = 0;          ///< pairs of triangles that cross
  std::vector<Crossing> crossings;  ///< the first of them, ascending by (first, second)
  std::uint64_t degenerate =
      0;  ///< triangles without area, exactly; they are tested as the segments or points they are
};

/// The certificate: every pair of triangles that cross, decided exactly for the very coordinates given (orientation
/// predicates without rounding error, no tolerance).
///
/// Vertices at equal positions are one vertex. Triangles without a common vertex cross if they have a point in common.
/// Triangles with one common vertex cross if they have another point in common; with a common edge, if they have a
/// point in common outside that edge: they overlap in their common plane; with three different common vertices, always.
/// At most `max_listed` pairs are listed; all are counted. O(n log n) for well spread triangles, O(n^2) if most of them
/// lie in one place; about 250 bytes of memory for each triangle; parallel; the result does not depend on threads.
/// Errors: kInvalidParameter for coordinates that are not finite or beyond 1e100 or indices out of range, kTooLarge for
/// 2^32 triangles or vertices and more, kCancelled.
Expected<CrossingReport> find_crossings(std::span<const Vec3> positions_mm, std::span<const Triangle> triangles,
                                        std::size_t max_listed = 1000, const Progress& progress = {});

}  // namespace anthesis
