#pragma once
#include "anthesis/inflorescence/development.h"
#include "anthesis/render/scene.h"

namespace anthesis {

struct SceneOptions {
  Backdrop backdrop = Backdrop::light();
  bool ground = false;  ///< stand the plant on a level ground at its lowest point
};

/// The plant at one time as a scene. Organs of one template whose stages agree to 1/64 share a mesh. Pigments are those
/// of the species, in its order; each organ has its own variation of them. The peduncle is not framed.
/// The light is that of an even white sky: set `lighting`, for instance to studio_lighting(camera), afterwards.
Scene make_scene(const Development& development, const Canopy& canopy, const SceneOptions& options = {});

/// One organ alone, as the species states it: the shape of species.organs[kind] at `stage`, without individual
/// variation, its axis along +z. `detail` as for GrowthOptions. Error: that of OrganTemplate::build.
Expected<Scene> make_organ_scene(const Species& species, std::size_t kind, double stage, double detail,
                                 const SceneOptions& options = {});

}  // namespace anthesis
