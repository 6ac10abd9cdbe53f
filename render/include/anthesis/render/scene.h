#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/corolla/pigment.h"
#include "anthesis/geometry/mesh.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// A run of a mesh's triangles that wear one pigment.
struct PigmentSpan {
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  std::uint32_t pigment = 0;  ///< index into Scene::pigments
};

/// A mesh that any number of instances share. Triangles outside every span wear pigment 0.
struct SceneMesh {
  Mesh mesh;  ///< normals empty: facets; uvs empty: (0.5, 0.5) everywhere
  std::vector<PigmentSpan> spans;
};

/// Makes a surface a film that can be seen through: light passes straight on, but for the share
/// facing + (edge - facing) (1 - |cos|)^(2^doublings), which meets the surface's pigment; cos is that of the angle
/// between its way and the surface's normal. So a thin body shows as its outline.
struct Veil {
  double facing = 0.03;  ///< share stopped of light that meets it head on, [0, 1]
  double edge = 0.6;     ///< and at grazing angles, [0, 1]
  int doublings = 2;     ///< how near grazing it becomes dense, 0 to 5
};

/// A mesh set down in the world.
struct Instance {
  std::uint32_t mesh = 0;
  Placement world_from_mesh;                 ///< scale > 0
  std::vector<PigmentVariation> variations;  ///< one for each span of the mesh; empty: none varies
  std::optional<Colour> colour;              ///< plain colour in place of the pigments' own
  bool framed = true;                        ///< counts when the camera frames the scene; a long stem may not
  std::optional<Veil> veil;                  ///< none: light meets the surface wherever it is
};

/// A distant lamp: a cone of even light. The camera does not see it.
struct Lamp {
  Vec3 towards = {0.0, 0.0, 1.0};  ///< unit, from the scene to the lamp
  double half_angle_rad = 0.1;     ///< (0, pi/2]: 0.0047 is the sun, 0.2 a softbox
  Colour irradiance = {1, 1, 1};   ///< on a surface that faces the lamp
};

/// A broad glow in the sky: colour * max(0, cos)^exponent about its direction, exponent 2^doublings.
struct Glow {
  Vec3 towards = {0.0, 0.0, 1.0};  ///< unit
  int doublings = 2;               ///< 0 to 5
  Colour radiance = {0, 0, 0};
};

/// Light from everywhere: a gradient from below over the horizon to the zenith, and glows. The camera does not see it.
struct Sky {
  Vec3 up = {0.0, 0.0, 1.0};  ///< unit
  Colour zenith = {1, 1, 1};  ///< radiance
  Colour horizon = {1, 1, 1};
  Colour nadir = {1, 1, 1};
  std::vector<Glow> glows;
};

struct Lighting {
  std::vector<Lamp> lamps;  ///< the first is the key, at most 8
  Sky sky;
};

/// An endless level plane under the plant. The camera sees the backdrop there, darkened where the plant takes light
/// away.
struct Ground {
  double height_mm = 0.0;  ///< world z
  Colour colour = {0.7, 0.7, 0.7};
};

/// Lets what the camera sees fade into the backdrop with its distance, so that near and far can be told apart: not at
/// all where dot(towards, place) >= clear_mm, by `share` where it is <= dense_mm, in proportion between.
struct Haze {
  Vec3 towards = {0.0, 0.0, 1.0};  ///< unit, to the camera
  double clear_mm = 0.0;
  double dense_mm = -1.0;  ///< < clear_mm
  double share = 0.5;      ///< [0, 1]
};

/// What stands behind the plant, in display light (what the eye is to see, whatever the exposure).
struct Backdrop {
  bool transparent = false;  ///< an alpha channel in place of the colours
  Colour centre = {0.86, 0.86, 0.84};
  Colour corner = {0.55, 0.56, 0.56};

  static Backdrop light();
  static Backdrop dark();
  static Backdrop none();  ///< transparent
};

/// All that a picture shows, as plain data. Millimetres.
struct Scene {
  std::vector<SceneMesh> meshes;
  std::vector<Pigment> pigments;
  std::vector<Instance> instances;
  Lighting lighting;
  std::optional<Ground> ground;
  std::optional<Haze> haze;
  Backdrop backdrop = Backdrop::light();
};

/// What is wrong with `scene`, if anything: an index out of range, a size that does not fit, a number that is not
/// finite or out of its range. O(vertices + triangles + instances).
std::optional<Error> check(const Scene& scene);

/// A sphere of radius 1 about the origin, 1280 triangles, smooth.
Mesh unit_sphere();

/// Light of colour `radiance` from the sky in the unit direction `towards`.
Colour sky_radiance(const Sky& sky, Vec3 towards);

/// Light that falls on a surface of unit normal `normal` with nothing in the way. 4096 looks at the sky.
Colour open_irradiance(const Lighting& lighting, Vec3 normal);

}  // namespace anthesis
