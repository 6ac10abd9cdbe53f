#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "anthesis/base/progress.h"
#include "anthesis/exchange/glb.h"
#include "anthesis/inflorescence/development.h"
#include "morph.h"

namespace anthesis::detail {

/// Where an organ stands in one frame, as the file stores it. Before its birth: as at its first frame.
struct OrganKey {
  std::array<float, 3> translation_mm = {};
  std::array<float, 4> rotation = {0.0f, 0.0f, 0.0f, 1.0f};  ///< x y z w, unit
  float scale = 0.0f;
  float stage = 0.0f;
  bool born = false;
};

/// A body's way through the frames: its shape, brought to one size, and where that stands.
struct BodyTrack {
  std::string name;
  std::string pigment;
  Mesh rest;                                 ///< uvs and triangles
  std::vector<std::vector<Vec3>> shapes_mm;  ///< [frame], centred on the origin, with the last frame's diagonal
  std::vector<std::vector<Vec3>> normals;    ///< [frame]
  std::vector<Vec3> centre_mm;               ///< [frame]
  std::vector<double> scale;                 ///< [frame]
};

/// A development sampled for a file.
struct Timeline {
  std::vector<double> times;      ///< developmental
  std::vector<OrganId> organs;    ///< those born by the last frame, by id
  std::vector<OrganKey> keys;     ///< [frame * organs.size() + organ]
  std::vector<BodyTrack> bodies;  ///< those of the last frame

  const OrganKey& key(std::size_t frame, std::size_t organ) const { return keys[frame * organs.size() + organ]; }
};

/// The developmental times of the frames.
std::vector<double> frame_times(const GlbOptions& options);

/// Errors: kTooLarge, kCancelled, kInvalidParameter for a placement that is not finite.
Expected<Timeline> sample_timeline(const Development& development, const GlbOptions& options, const Progress& progress);

/// For each template the chain of its shapes over the stages its organs pass through; empty keys: no organ uses it.
/// Errors: kCancelled.
Expected<std::vector<MorphChain>> template_chains(const Development& development, const Timeline& timeline,
                                                  const GlbOptions& options, const Progress& progress);

/// The chain of a body's shapes over the frames.
MorphChain body_chain(const BodyTrack& body, const Timeline& timeline, const GlbOptions& options);

}  // namespace anthesis::detail
