#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// A bicubic Bezier patch: control point 4 * row + column. Neighbouring patches repeat the points of the edge between.
struct VlabPatch {
  std::string name;
  std::array<Vec3, 16> controls;  ///< as they stand in the file
};

/// A surface of patches: `.s`. What the file says besides (box, end point, colours, neighbours) is for the editor.
struct VlabSurface {
  Vec3 contact;                 ///< the origin of the surface as models place it
  Vec3 heading{0.0, 1.0, 0.0};  ///< unit vector; becomes +y
  Vec3 up{0.0, 0.0, 1.0};       ///< unit vector; becomes +z
  double size = 1.0;            ///< by which it is divided, > 0
  std::vector<VlabPatch> patches;
};

/// Limits and errors as in vlab_contour.h.
Expected<VlabSurface> read_vlab_surface(std::string_view text, std::string_view file_name);

/// The control points of a patch where VLab's models see them: origin, axes and size of the surface taken into account.
std::array<Vec3, 16> vlab_placed_controls(const VlabSurface& surface, const VlabPatch& patch);

/// Point of a patch with these control points: u runs along the rows' order, v along a row, both in [0, 1].
Vec3 vlab_patch_point(const std::array<Vec3, 16>& controls, double u, double v);

}  // namespace anthesis
