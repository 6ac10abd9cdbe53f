#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/exchange/vlab_contour.h"
#include "anthesis/exchange/vlab_function.h"
#include "anthesis/exchange/vlab_head.h"
#include "anthesis/geometry/function_graph.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "anthesis/inflorescence/species.h"
#include "anthesis/vasculature/vein_params.h"

namespace anthesis {

/// A file of a VLab object: its name without folders, and its bytes.
struct VlabFile {
  std::string name;
  std::string bytes;
};

/// Whether `read_vlab_object` looks at a file of this name: .con .cset .func .fset knotPositions.dat.
bool is_vlab_head_file(std::string_view file_name);

/// What a VLab object says about a flower head. Parts that it lacks are empty.
struct VlabObject {
  std::vector<VlabContour> contours;
  std::vector<double> knots;
  std::vector<VlabFunction> functions;

  const VlabFunction* find_function(std::string_view name) const;
};

/// Reads the files that is_vlab_head_file knows, in the order of their names; others are passed over. Of two galleries
/// of contours the one with markers counts. Errors: those of the readers.
Expected<VlabObject> read_vlab_object(std::span<const VlabFile> files);

/// How VLab's numbers become millimetres. Its files state no unit.
struct VlabScale {
  double width_mm = 20.0;      ///< greatest width of the mature receptacle, [0.01, 10,000]
  double radius_factor = 0.2;  ///< by which the model's program multiplies the function `rho`, (0, 1000]. VLab's Ridley
                               ///< model takes 0.2; it stands in the program, not in the files.

  /// A growing head is one of O24's, whose programs state what their files do not: unit (whatever `width_mm`),
  /// thresholds, landmarks, veins.
  std::optional<HeadModel> like = std::nullopt;
  VeinSource source = VeinSource::kAsPublished;  ///< of the parameters of veins
};

/// VLab's Ridley model (Prusinkiewicz et al. 2001, algorithm 5): spherical organs on a surface of revolution, their
/// radius drawn as a function of the position along the profile.
struct VlabRidley {
  SurfaceOfRevolution surface;  ///< apex at t = 0, in millimetres
  FunctionGraph radius_mm;      ///< of an organ against s from the apex, whichever way the profile was drawn
  FunctionGraph area_mm2;       ///< of an organ's band, pi radius^2: for place_organs
};

/// The model of a profile and its radii. Functions are refitted by 33 control points each: 1e-4 of their height.
/// Errors: those of vlab_profile and vlab_graph, radii not > 0, a scale out of range.
Expected<VlabRidley> vlab_ridley(const VlabContour& profile, const VlabFunction& rho, const VlabScale& scale);

/// A species whose head is that of the object, with plain beads for organs. Two kinds of object are known:
/// - one contour and a function named `rho`: the Ridley model above, rule kRidley, once and for all;
/// - stages of contours with markers and the function thresholdDistanceFunc: rule kActiveRing, with the published clock
///   for veins if there is a function output_dalpha.
/// check(Species) finds nothing in it. Errors: kInvalidParameter saying which files are missing, or what is wrong.
Expected<Species> species_from_vlab(std::string_view name, const VlabObject& object, const VlabScale& scale = {});

}  // namespace anthesis
