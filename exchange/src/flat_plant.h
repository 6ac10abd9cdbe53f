#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "anthesis/base/progress.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis::detail {

/// Above this many vertices a plant is not written out flat: a PLY would pass 2 GB.
inline constexpr std::uint64_t kMaxFlatVertices = 50'000'000;

/// Where the vertices of a canopy's organs and bodies begin in a file that holds them one after the other: organs by
/// id, then bodies.
struct FlatPlant {
  std::vector<std::uint32_t> first_vertex;  ///< of organ i, then of body j
  std::uint32_t vertex_count = 0;
  std::uint64_t triangle_count = 0;
};

/// Errors: those of check_canopy, kTooLarge.
Expected<FlatPlant> flat_plant(const Development& development, const Canopy& canopy);

/// What makes `canopy` none of this development, if anything: organs it does not have or out of order, deformed organs
/// with another number of vertices than their template, places that are not finite.
std::optional<Error> check_canopy(const Development& development, const Canopy& canopy);

/// Whether collisions were resolved: some organ has vertices of its own.
bool is_resolved(const Canopy& canopy);

const OrganTemplate& template_of(const Development& development, const OrganState& state);

/// The pigment of that name; a plain grey one for a name that the species does not have (a body without pigment).
const Pigment& pigment_named(const Species& species, std::string_view name);

/// Positions and unit normals of an organ in the world; resizes both. Deformed vertices come out as they are.
void pose_in_world(const OrganTemplate& shape, const OrganState& state, std::vector<Vec3>& positions_mm,
                   std::vector<Vec3>& normals);

}  // namespace anthesis::detail
