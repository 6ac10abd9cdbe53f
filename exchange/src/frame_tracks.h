#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/base/progress.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis::detail {

/// How an organ or a body goes through a sequence of canopies: in which frames it is there, and which of them show it
/// in one and the same shape.
struct FrameTrack {
  std::size_t vertex_count = 0;
  std::size_t first_frame = 0;              ///< it is there from this frame to the last
  Vec3 birth_place_mm;                      ///< where it is at its first frame
  std::vector<std::uint16_t> shapes;        ///< index of its shape, by frame from first_frame on; rising by 0 or 1
  std::vector<std::size_t> frame_of_shape;  ///< the first frame that has the shape
};

struct FrameTracks {
  bool resolved = false;                   ///< some organ was bent by touching
  std::vector<OrganId> ids;                ///< those of the last frame
  std::vector<FrameTrack> organs;          ///< of ids[i]
  std::vector<std::size_t> body_of_track;  ///< index in the last frame; bodies without triangles are left out
  std::vector<FrameTrack> bodies;
};

inline constexpr std::size_t kMaxFrames = 2000;

/// The organ or body in a canopy, or null.
const OrganState* organ_in(const Canopy& canopy, OrganId id);
const Body* body_named(const Canopy& canopy, std::string_view name);

/// Errors: kInvalidParameter for no frames, for times that do not ascend, for canopies of another development;
/// kTooLarge above kMaxFrames; kCancelled.
Expected<FrameTracks> track_frames(const Development& development, std::span<const Canopy> frames,
                                   const Progress& progress);

}  // namespace anthesis::detail
