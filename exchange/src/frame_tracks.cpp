#include "frame_tracks.h"

#include <algorithm>

#include "anthesis/base/parallel.h"
#include "flat_plant.h"

namespace anthesis::detail {
namespace {

bool same_placement(const Placement& a, const Placement& b) {
  return a.position_mm == b.position_mm && a.rotation == b.rotation && a.scale == b.scale;
}

bool same_shape(const OrganState& a, const OrganState& b) {
  if (a.deformed_mm.empty() && b.deformed_mm.empty()) {
    return a.stage == b.stage && same_placement(a.world_from_organ, b.world_from_organ);
  }
  return a.deformed_mm == b.deformed_mm;
}

/// `in_frame(frame)` is a pointer to the thing there, or null; `same` says whether two of them look alike.
template <class InFrame, class Same>
FrameTrack track_of(std::size_t frames, const InFrame& in_frame, const Same& same) {
  FrameTrack track;
  track.first_frame = frames - 1;
  while (track.first_frame > 0 && in_frame(track.first_frame - 1) != nullptr) {
    --track.first_frame;
  }
  for (std::size_t frame = track.first_frame; frame < frames; ++frame) {
    if (frame == track.first_frame || !same(*in_frame(frame - 1), *in_frame(frame))) {
      track.frame_of_shape.push_back(frame);
    }
    track.shapes.push_back(static_cast<std::uint16_t>(track.frame_of_shape.size() - 1));
  }
  return track;
}

Vec3 centre_of(const std::vector<Vec3>& points) {
  Vec3 low = points.front();
  Vec3 high = low;
  for (const Vec3 p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return 0.5 * (low + high);
}

}  // namespace

const OrganState* organ_in(const Canopy& canopy, OrganId id) {
  const auto found = std::lower_bound(canopy.organs.begin(), canopy.organs.end(), id,
                                      [](const OrganState& state, OrganId sought) { return state.id < sought; });
  return found != canopy.organs.end() && found->id == id ? &*found : nullptr;
}

const Body* body_named(const Canopy& canopy, std::string_view name) {
  for (const Body& body : canopy.bodies) {
    if (body.name == name) {
      return &body;
    }
  }
  return nullptr;
}

Expected<FrameTracks> track_frames(const Development& development, std::span<const Canopy> frames,
                                   const Progress& progress) {
  if (frames.empty()) {
    return unexpected(invalid_parameter("frames", "must be at least one", 0.0));
  }
  if (frames.size() > kMaxFrames) {
    return unexpected(
        Error{ErrorCode::kTooLarge, "frames",
              "must be at most " + std::to_string(kMaxFrames) + ", got " + std::to_string(frames.size())});
  }
  FrameTracks tracks;
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    if (std::optional<Error> error = check_canopy(development, frames[frame])) {
      return unexpected(*error);
    }
    if (frame > 0 && !(frames[frame - 1].time < frames[frame].time)) {
      return unexpected(invalid_parameter("frames", "must ascend in time", frames[frame].time));
    }
    tracks.resolved = tracks.resolved || is_resolved(frames[frame]);
  }
  const Canopy& last = frames.back();
  for (const OrganState& state : last.organs) {
    tracks.ids.push_back(state.id);
  }
  tracks.organs.resize(tracks.ids.size());
  const bool done = parallel_for(
      tracks.organs.size(),
      [&](std::size_t i) {
        tracks.organs[i] = track_of(
            frames.size(), [&](std::size_t frame) { return organ_in(frames[frame], tracks.ids[i]); }, same_shape);
        const OrganState& first = *organ_in(frames[tracks.organs[i].first_frame], tracks.ids[i]);
        tracks.organs[i].birth_place_mm = first.world_from_organ.position_mm;
        tracks.organs[i].vertex_count = template_of(development, first).vertex_count();
      },
      progress, "frames");
  if (!done) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  for (std::size_t j = 0; j < last.bodies.size(); ++j) {
    const Body& body = last.bodies[j];
    if (body.mesh.positions_mm.empty() || body.mesh.triangles.empty()) {
      continue;
    }
    const auto in_frame = [&](std::size_t frame) -> const Body* {
      const Body* found = body_named(frames[frame], body.name);
      const bool fits = found != nullptr && found->mesh.positions_mm.size() == body.mesh.positions_mm.size() &&
                        found->mesh.normals.size() == body.mesh.normals.size();
      return fits ? found : nullptr;
    };
    FrameTrack track = track_of(frames.size(), in_frame, [](const Body& a, const Body& b) {
      return a.mesh.positions_mm == b.mesh.positions_mm && a.mesh.normals == b.mesh.normals;
    });
    track.birth_place_mm = centre_of(in_frame(track.first_frame)->mesh.positions_mm);
    track.vertex_count = body.mesh.positions_mm.size();
    tracks.body_of_track.push_back(j);
    tracks.bodies.push_back(std::move(track));
  }
  return tracks;
}

}  // namespace anthesis::detail
