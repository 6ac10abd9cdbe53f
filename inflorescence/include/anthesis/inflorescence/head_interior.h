#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/inflorescence/species.h"
#include "anthesis/phyllotaxis/active_ring.h"
#include "anthesis/receptacle/contour_sequence.h"
#include "anthesis/receptacle/growing_receptacle.h"
#include "anthesis/receptacle/interior_growth.h"
#include "anthesis/vasculature/vasculature.h"

namespace anthesis {

// The inside of a species' own head, step by step: primordia on the active ring, outlines frame by frame, veins. Each
// step can be run alone, and given another's result. All need a species with head.active_ring that check(Species) finds
// nothing wrong with; all but the first three need its `vasculature` (asserted).

/// The sections of a head with an active ring, in millimetres, and the rules for primordia on it.
DigitisedHead digitised_head(const ActiveRing& ring);
ActiveRingParams active_ring_params(const ActiveRing& ring);

/// How sections and primordia are computed.
enum class HeadRules {
  kExact,        ///< continuous in space and time
  kAsPublished,  ///< by the tables and scans of the programs released with O24
};

/// The primordia on the active ring of the head, in order of birth. Errors: those of grow_active_ring.
Expected<std::vector<RingPrimordium>> head_ring(const Species& species, HeadRules rules = HeadRules::kExact,
                                                const Progress& progress = {});

/// The same as the vein model sees them: where they stand when they have stopped moving sideways, and the frame of that
/// moment, by which they are ordered.
std::vector<VeinPrimordium> head_primordia(const Species& species, std::span<const RingPrimordium> ring,
                                           HeadRules rules = HeadRules::kExact);

/// The outlines of all frames. Errors: those of contour_times; kInvalidParameter if an outline crosses itself.
Expected<ContourSequence> head_contours(const Species& species, HeadRules rules = HeadRules::kExact);

/// The half sections of all frames, as they are triangulated.
/// Errors: those of InteriorGrowth::make.
Expected<InteriorGrowth> head_inside(const Species& species, const ContourSequence& contours);

/// The same sections, without anything that moves in them.
SectionSequence head_sections(const ContourSequence& contours);

/// Grows the veins; with harmonic growth `brought_back` is counted. `options.stride` is chosen here. Errors: those of
/// grow_veins and of the growth of the inside.
Expected<Vasculature> head_veins(const Species& species, const ContourSequence& contours,
                                 std::span<const VeinPrimordium> primordia, VeinOptions options = {});

}  // namespace anthesis
