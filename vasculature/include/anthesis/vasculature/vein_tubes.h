#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/mesh.h"
#include "anthesis/vasculature/vasculature.h"

namespace anthesis {

struct VeinTubeParams {
  int sides = 7;               ///< of a tube, 3 to 64
  double radius_factor = 1.0;  ///< > 0, of half the diameter
};

/// What is wrong with `params`, if anything.
std::optional<Error> check(const VeinTubeParams& params);

/// Strands as closed tubes of triangles.
struct VeinTubes {
  Mesh mesh;                        ///< with normals, without uvs; one tube after the other
  std::vector<std::uint32_t> vein;  ///< of each vertex of the mesh: the vein's vertex that its ring stands at
  std::vector<VeinKind> kind;       ///< of each vertex of the mesh; a triangle's is that of its first corner
};

/// A tube follows the thickest way from a tip until it joins a thicker one or the ring; each second connection has one
/// of its own. Strands with an edge of no width have none. See docs/vasculature.md.
///
/// Each tube is closed, a manifold, and looks outwards. Its tip is half a sphere about the outermost vertex, its inner
/// end flat. Ends at a joint stand in the middle of the thicker tube, narrow enough to be hidden there, and so do both
/// ends of second connections. Kinks are rounded off, tips and the ring's vertices stay: the middle of a tube is nearer
/// to the strand than its radius, up to where it has come into a thicker one, whose joint it then takes straight.
/// Every ring is a circle of the tube's full radius; from one to the next they turn by at most 60 degrees, mostly by
/// far less. Where a strand still bends within its own width, the inner side folds up inside the tube. Radii pass
/// smoothly along a tube. On straight stretches only vertices about four radii apart have rings; rings that were put
/// into bends name the vertex outwards of them. Different tubes may cross.
///
/// O(vertices * sides); the same bits everywhere.
/// Errors: check(params); kTooLarge above 50 million vertices of the mesh.
Expected<VeinTubes> vein_tubes(const Vasculature& veins, const VeinTubeParams& params = {});

/// sRGB in 8 bits, about as O24 colours them: abaxial pale yellow, floret purple, adaxial red.
std::array<std::uint8_t, 3> vein_colour(VeinKind kind);

}  // namespace anthesis
