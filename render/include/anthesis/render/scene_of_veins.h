#pragma once
#include <optional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/render/camera.h"
#include "anthesis/render/scene.h"
#include "anthesis/vasculature/vasculature.h"
#include "anthesis/vasculature/vein_tubes.h"

namespace anthesis {

/// How a head is opened. Cuts are made along the vertical plane through the axis that faces the viewer.
enum class HeadCut {
  kWhole,
  kHalf,   ///< without the half before the plane
  kSlice,  ///< what is near the plane alone
};

/// Circles about the axis whose convex hull holds one or several heads.
struct HeadExtent {
  std::vector<Vec2> circles_mm;  ///< (radius, height), radii >= 0; none: nothing

  double radius_mm() const;  ///< of the widest; 0 without any
};

struct VeinSceneOptions {
  View view = View::front();  ///< from where the picture will be taken: which way a cut faces, where the scale bar lies
  HeadCut cut = HeadCut::kWhole;
  double slice = 0.1;                   ///< kSlice: greatest distance from the plane, in framed radii, (0, 1]
  bool receptacle = true;               ///< draw it as a film; of an opened head, its section too
  bool primordia = false;               ///< a bead where each stands
  double haze = 0.55;                   ///< share that the farthest strands fade by, [0, 1]
  bool scale_bar = false;               ///< below the head, scale_bar_mm long, with its length beside it
  VeinTubeParams tubes = {.sides = 9};  ///< of strands
  HeadExtent extent = {};               ///< what the camera frames; nothing: the present receptacle
  Backdrop backdrop = Backdrop::dark();
};

/// What is wrong with `options`, if anything.
std::optional<Error> check(const VeinSceneOptions& options);

/// studio_lighting with more light from below and in front: strands are seen from all sides.
Lighting vein_lighting(const Camera& camera);

/// The fewest circles that hold a head of this outline, from the lowest up. O(points log points).
HeadExtent extent_of(std::span<const Vec2> outline_mm);

/// What holds both.
HeadExtent together(const HeadExtent& one, const HeadExtent& other);

/// Length of the scale bar of a head that is framed with this radius: 1, 2 or 5 times a power of ten, at most half the
/// radius. Precondition: the radius is > 0.
double scale_bar_mm(double framed_radius_mm);

/// The strands of a head in its receptacle. See docs/rendering.md.
///
/// `outline_mm`: half section (distance from the axis, height), apex first, rim of the base last, at least two points,
/// radii >= 0 and not all 0, some length. `primordia`: those that the veins were grown with; beads take their kinds
/// from them. The camera frames the receptacle, or `options.extent`, whatever is cut away. The light is that of an even
/// white sky: set `lighting`, for instance to vein_lighting(camera), afterwards.
///
/// O(vertices * sides of tubes); 0.1 s for 40,000 vertices. The same for any number of threads.
/// Errors: check(options), those of vein_tubes, an outline or primordia that do not fit (kInvalidParameter).
Expected<Scene> make_scene(const Vasculature& veins, std::span<const Vec2> outline_mm,
                           std::span<const VeinPrimordium> primordia, const VeinSceneOptions& options = {});

}  // namespace anthesis
