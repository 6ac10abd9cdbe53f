#include "anthesis/exchange/pc2.h"

#include <algorithm>
#include <cstring>

#include "anthesis/base/parallel.h"
#include "flat_plant.h"
#include "frame_tracks.h"

namespace anthesis {
namespace {

constexpr std::uint64_t kMaxBytes = 0x7fffffff;
constexpr std::size_t kHeaderBytes = 32;
constexpr std::size_t kPointBytes = 12;

/// Little-endian, as the program's only processors are.
template <class Value>
void put(char*& to, Value value) {
  std::memcpy(to, &value, sizeof(value));
  to += sizeof(value);
}

void put_points(char* to, std::span<const Vec3> points_mm) {
  for (const Vec3 p : points_mm) {
    put(to, static_cast<float>(p.x));
    put(to, static_cast<float>(p.y));
    put(to, static_cast<float>(p.z));
  }
}

}  // namespace

Expected<std::string> to_pc2(const Development& development, std::span<const Canopy> frames, const Progress& progress) {
  const Expected<detail::FrameTracks> tracks = detail::track_frames(development, frames, progress);
  if (!tracks) {
    return unexpected(tracks.error());
  }
  const Canopy& last = frames.back();
  const Expected<detail::FlatPlant> plant = detail::flat_plant(development, last);
  if (!plant) {
    return unexpected(plant.error());
  }
  const std::uint64_t sample_bytes = std::uint64_t{plant->vertex_count} * kPointBytes;
  if (sample_bytes > (kMaxBytes - kHeaderBytes) / frames.size()) {
    return unexpected(Error{ErrorCode::kTooLarge, "frames",
                            "make a point cache of more than 2 GiB: ask for fewer frames or less detail"});
  }
  std::string bytes(kHeaderBytes + sample_bytes * frames.size(), '\0');
  char* to = bytes.data();
  std::memcpy(to, "POINTCACHE2", 12);
  to += 12;
  put(to, std::int32_t{1});
  put(to, static_cast<std::int32_t>(plant->vertex_count));
  put(to, 0.0f);  // first frame
  put(to, 1.0f);  // frames from one sample to the next
  put(to, static_cast<std::int32_t>(frames.size()));

  // Bodies without triangles have no track; they rest where they are at last.
  std::vector<const detail::FrameTrack*> track_of(last.bodies.size(), nullptr);
  for (std::size_t j = 0; j < tracks->bodies.size(); ++j) {
    track_of[tracks->body_of_track[j]] = &tracks->bodies[j];
  }
  const bool done = parallel_for(
      frames.size(),
      [&](std::size_t frame) {
        char* const sample = bytes.data() + kHeaderBytes + frame * sample_bytes;
        std::vector<Vec3> positions_mm;
        std::vector<Vec3> normals;
        for (std::size_t i = 0; i < tracks->organs.size(); ++i) {
          const detail::FrameTrack& track = tracks->organs[i];
          if (frame < track.first_frame) {
            positions_mm.assign(track.vertex_count, track.birth_place_mm);
          } else {
            const OrganState& state = *detail::organ_in(frames[frame], tracks->ids[i]);
            detail::pose_in_world(detail::template_of(development, state), state, positions_mm, normals);
          }
          put_points(sample + std::size_t{plant->first_vertex[i]} * kPointBytes, positions_mm);
        }
        for (std::size_t j = 0; j < last.bodies.size(); ++j) {
          const Body& body = last.bodies[j];
          const detail::FrameTrack* const track = track_of[j];
          char* const first = sample + std::size_t{plant->first_vertex[last.organs.size() + j]} * kPointBytes;
          if (track == nullptr) {
            put_points(first, body.mesh.positions_mm);
          } else if (frame < track->first_frame) {
            positions_mm.assign(track->vertex_count, track->birth_place_mm);
            put_points(first, positions_mm);
          } else {
            put_points(first, detail::body_named(frames[frame], body.name)->mesh.positions_mm);
          }
        }
      },
      progress, "pc2");
  if (!done) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  return bytes;
}

}  // namespace anthesis
