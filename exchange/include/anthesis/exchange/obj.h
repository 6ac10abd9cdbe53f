#pragma once
#include <string>
#include <string_view>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {

/// A Wavefront OBJ text and the material library it names.
struct ObjText {
  std::string obj;
  std::string mtl;
};

/// The plant at `time`, every organ written out: millimetres, +z up along the axis of the plant.
///
/// One object `o ray_floret.12` for each organ (its id after the point) and for each body, with positions, texture
/// coordinates, smooth normals and one `usemtl` for each pigment. `mtl_name` is the file name that `mtllib` states.
/// Errors: kInvalidParameter for a time outside [0, 1], kTooLarge above 50 million vertices, kCancelled.
Expected<ObjText> to_obj(const Development& development, double time, std::string_view mtl_name,
                         const Progress& progress = {});

/// The same for a canopy of the development that was computed beforehand. Vertices of organs bent by touching are
/// stated by the shortest text that reads back as the same single-precision number, and so are all others; a comment
/// then says "collisions: resolved". Errors: also kInvalidParameter for a canopy that is not one of this development.
Expected<ObjText> to_obj(const Development& development, const Canopy& canopy, std::string_view mtl_name,
                         const Progress& progress = {});

}  // namespace anthesis
