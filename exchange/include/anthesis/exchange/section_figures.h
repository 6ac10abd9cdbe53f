#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/receptacle/interior_growth.h"

namespace anthesis {

// Drawings of half sections of heads and of what happens inside them, as SVG. See docs/harmonic-interior.md.
//
// Radii go to the right from the axis, heights up. The same text for any number of threads.

struct SectionFigureParams {
  std::string title = {};    ///< over the figure
  std::string caption = {};  ///< small print below it: how it was made
  double unit_mm = 0.0;      ///< the sections' unit in millimetres, for scale bars; finite, >= 0, 0: not known
  double width_px = 960.0;   ///< of the whole figure; in [300, 10000]
  InteriorGrowthParams interior = {};  ///< mesh and condition on the axis
  bool with_mesh = true;               ///< whether the triangulation is drawn
  Progress progress = {};              ///< of growth; asked to stop, figures of growth end with kCancelled
};

std::optional<Error> check(const SectionFigureParams& params);

/// Harmonic coordinates of one section: a panel with the triangulation and the control points' numbers (as many as have
/// room), then one panel for each control point of `shown` with its field in bands at 0.001, 0.003 ... 0.6.
///
/// Errors: check(params); triangulate_section; at most 60 points, each one of the section's, may be shown.
Expected<std::string> section_weights_svg(std::span<const Vec2> controls, std::span<const std::uint32_t> shown,
                                          const SectionFigureParams& params = {});

/// Where the tissue of one frame moves until another: bands of how far, and arrows from the place before to the place
/// after. Errors: check(params); InteriorGrowth; frames that are not from < to < sections.frames().
Expected<std::string> section_displacement_svg(const SectionSequence& sections, std::size_t from, std::size_t to,
                                               const SectionFigureParams& params = {});

/// A square grid laid into the section of the first of `frames`, `across` meshes wide, carried by growth and drawn in
/// all of them, each panel with its own scale. The grid begins half a mesh beside the axis: on the axis itself the
/// natural condition tears it (docs/harmonic-interior.md), and the gap shows how far.
///
/// Errors: check(params); InteriorGrowth; frames that do not ascend; more than 60 frames; `across` not in [4, 200].
Expected<std::string> section_growth_svg(const SectionSequence& sections, std::span<const std::size_t> frames,
                                         std::size_t across = 16, const SectionFigureParams& params = {});

}  // namespace anthesis
