#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/exchange/vlab_head.h"
#include "anthesis/phyllotaxis/active_ring.h"
#include "anthesis/receptacle/contour_sequence.h"
#include "anthesis/receptacle/interior_growth.h"

namespace anthesis {

// What the programs published with O24 exchange about a growing head, from our models: `.raw`, `.cntrs`, `.prims`.
// See docs/harmonic-interior.md and docs/vlab.md.

/// Edges as long as this share of the section give meshes about as coarse as the published ones: on average 159 points
/// for Bellis and 238 for the sunflower, where the sizes of the published files speak of 145 and 180, and no fewer are
/// possible with every control point in the mesh and angles of 25 degrees.
inline constexpr SectionMeshParams kVlabSectionMesh{.max_edge = 0.25};

/// Takes the next bytes of a file; an error stops the writer.
using ByteSink = std::function<std::optional<Error>(std::string_view bytes)>;

/// All harmonic coordinates of all frames as a `.raw` file: a frame's mesh, its control points and one field for each
/// of them, in single precision. read_vlab_cages reads it back.
///
/// Frame by frame: memory for some 16 MB of fields, however long the file. Parallel; the same bytes for any number of
/// threads. 219,186 fields of the sunflower on the default mesh: 224 MB in about 0.4 s on two processors.
///
/// Errors: those of InteriorGrowth; kTooLarge beyond kVlabRawLimit bytes; what `sink` answers; kCancelled when
/// `progress` asks to stop. What went into the sink before is then half a file.
std::optional<Error> write_harmonic_fields(const InteriorGrowth& growth, const ByteSink& sink,
                                           const Progress& progress = {});

/// The same into a file, which appears whole or not at all.
std::optional<Error> write_harmonic_fields(const InteriorGrowth& growth, const std::string& path,
                                           const Progress& progress = {});

/// The same for sections alone, on a mesh of their own: growth wants a finer one than the file.
std::optional<Error> write_harmonic_fields(const SectionSequence& sections, const std::string& path,
                                           const SectionMeshParams& mesh = kVlabSectionMesh,
                                           const Progress& progress = {});

/// A sequence of contours as a `.cntrs` file has it; write_vlab_contour_sequence makes the text. The contours of O24
/// are in the unit of the drawing times 3.
VlabContourSequence vlab_contour_sequence(const ContourSequence& contours);

/// Which of the three `.prims` files of a run.
enum class VlabPrimordiaMoment {
  kInitial,  ///< at insertion, by number
  kStable,   ///< when each stopped moving sideways, by step
  kFinal,    ///< at the last step, by number
};

/// How a species' files number the kinds of organs.
enum class VlabOrganCodes {
  kBractOrFloret,  ///< Bellis and sunflower: 1 bract, 0 floret
  kGerbera,        ///< 0 bract, 1 trans floret, 2 disc floret
};

/// Primordia as a `.prims` file has them; write_vlab_primordia makes the text. Their steps are those of the published
/// clock; for primordia of the continuous model, which has none, `time_step` turns times into steps from 1.
VlabPrimordia vlab_primordia(std::span<const RingPrimordium> primordia, VlabPrimordiaMoment moment,
                             VlabOrganCodes codes = VlabOrganCodes::kBractOrFloret, double time_step = 0.0005);

}  // namespace anthesis
