#pragma once
#include "anthesis/inflorescence/development.h"
#include "anthesis/render/scene.h"

namespace anthesis {

struct SceneOptions {
  Backdrop backdrop = Backdrop::light();
  bool ground = false;  ///< stand the plant on a level ground at its lowest point

  /// The same plant (species and seed) at a higher level of detail, to be drawn in place of the one whose organs were
  /// bent: its surfaces follow theirs (corolla/surface_follower.h), and its bodies take the place of the canopy's. Such
  /// a picture is rounder than what was found free of crossings, and fine surfaces that nearly touch may cross in it.
  const Development* finer = nullptr;
};

/// The plant at one time as a scene. Organs of one template whose stages agree to 1/64 share a mesh. Pigments are those
/// of the species, in its order; each organ has its own variation of them. The peduncle is not framed.
/// An organ bent by touching has a mesh of its own, drawn where its vertices are or, with `options.finer`, near them.
/// The light is that of an even white sky: set `lighting`, for instance to studio_lighting(camera), afterwards.
Scene make_scene(const Development& development, const Canopy& canopy, const SceneOptions& options = {});

/// One organ alone, as the species states it: the shape of species.organs[kind] at `stage`, without individual
/// variation, its axis along +z. `detail` as for GrowthOptions. Error: that of OrganTemplate::build.
Expected<Scene> make_organ_scene(const Species& species, std::size_t kind, double stage, double detail,
                                 const SceneOptions& options = {});

}  // namespace anthesis
