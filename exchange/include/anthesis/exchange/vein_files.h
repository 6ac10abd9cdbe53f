#pragma once
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/vasculature/vasculature.h"
#include "anthesis/vasculature/vein_measures.h"
#include "anthesis/vasculature/vein_tubes.h"

namespace anthesis {

// Files of a head's veins. docs/vasculature.md says what each column means. Lengths are in the unit of the head.
// Numbers in text read back as the same doubles, with a point whatever the locale; equal veins give equal bytes.

/// What a file was made from, as (key, value) in the order it is written at its head.
using MadeFrom = std::vector<std::pair<std::string, std::string>>;

/// "abaxial", "trans_floret"
std::string_view vein_kind_name(VeinKind kind);
std::string_view primordium_kind_name(PrimordiumKind kind);

/// One row for each vertex: vertex, parent, second_parents, kind, primordium, age_frames, diameter, resistance, x, y,
/// z. Empty: no parent (of the ring, or not connected), no second one (several are separated by blanks), no primordium,
/// no way to the ring.
std::string veins_csv(const Vasculature& veins, const MadeFrom& made_from = {});

/// One row for each of `primordia`, with which the veins were grown: primordium, kind, birth_frame, s, azimuth_deg (at
/// birth), and vertex, x, y, z (at the end; empty: not yet born).
std::string vein_primordia_csv(const Vasculature& veins, std::span<const VeinPrimordium> primordia,
                               const MadeFrom& made_from = {});

/// One row for each of `primordia`, measures of its way to the ring; those of the whole head in the comments.
std::string vein_measures_csv(const VasculatureMeasures& measures, std::span<const VeinPrimordium> primordia,
                              const MadeFrom& made_from = {});

/// The first connections as SWC (Cannon et al. 1998), the format of neurons: id type x y z radius parent, a forest,
/// each parent before its children. Types: 1 ring, 2 abaxial, 3 floret, 4 adaxial. The id is not that of the CSV, for
/// strands stand one after the other. Second connections, which SWC cannot state, are listed in comments.
std::string veins_swc(const Vasculature& veins, const MadeFrom& made_from = {});

/// Strands as closed tubes of triangles in one binary little-endian PLY mesh: x y z, nx ny nz, red green blue (abaxial
/// pale yellow, floret purple, adaxial red, as in O24), `vein` (the vertex that a ring of the tube stands at), `kind`.
/// Errors: those of vein_tubes().
Expected<std::string> veins_ply(const Vasculature& veins, const VeinTubeParams& params = {},
                                const MadeFrom& made_from = {});

}  // namespace anthesis
