#include "timeline.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/parallel.h"

namespace anthesis::detail {
namespace {

constexpr std::uint64_t kMaxKeys = 16'000'000;  // organs x frames: about 1 GB of file

bool finite(const OrganState& state) {
  const Placement& p = state.world_from_organ;
  const double sum = p.position_mm.x + p.position_mm.y + p.position_mm.z + p.rotation.w + p.rotation.x + p.rotation.y +
                     p.rotation.z + p.scale + state.stage;
  return std::isfinite(sum);
}

OrganKey key_of(const OrganState& state) {
  const Placement& p = state.world_from_organ;
  const Quaternion q = normalized(p.rotation);
  OrganKey key;
  key.translation_mm = {static_cast<float>(p.position_mm.x), static_cast<float>(p.position_mm.y),
                        static_cast<float>(p.position_mm.z)};
  key.rotation = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)};
  key.scale = static_cast<float>(p.scale);
  key.stage = static_cast<float>(state.stage);
  key.born = true;
  return key;
}

/// Before birth an organ waits where it will arise, with scale 0; and q and -q, which are one rotation, must not
/// alternate, or a reader that interpolates turns the organ once around.
void join_frames(Timeline& timeline) {
  const std::size_t frames = timeline.times.size();
  for (std::size_t i = 0; i < timeline.organs.size(); ++i) {
    const auto key = [&](std::size_t frame) -> OrganKey& { return timeline.keys[frame * timeline.organs.size() + i]; };
    std::size_t first = 0;
    while (first + 1 < frames && !key(first).born) {
      ++first;
    }
    for (std::size_t frame = 0; frame < first; ++frame) {
      key(frame) = key(first);
      key(frame).scale = 0.0f;
      key(frame).born = false;
    }
    for (std::size_t frame = 1; frame < frames; ++frame) {
      const std::array<float, 4>& before = key(frame - 1).rotation;
      std::array<float, 4>& now = key(frame).rotation;
      float cosine = 0.0f;
      for (std::size_t c = 0; c < 4; ++c) {
        cosine += before[c] * now[c];
      }
      if (cosine < 0.0f) {
        for (float& c : now) {
          c = -c;
        }
      }
    }
  }
}

void box(const std::vector<Vec3>& points, Vec3& low, Vec3& high) {
  low = high = points.front();
  for (const Vec3 p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
}

/// Splits the bodies' meshes over the frames into where they stand, how large they are, and what is left: the shape.
/// Growth then costs no morph targets, which are few.
std::vector<BodyTrack> split_bodies(std::vector<std::vector<Body>>& frames) {
  std::vector<BodyTrack> tracks;
  const std::vector<Body>& last = frames.back();
  for (const Body& body : last) {
    if (body.mesh.positions_mm.empty() || body.mesh.triangles.empty()) {
      continue;
    }
    BodyTrack track{.name = body.name,
                    .pigment = body.pigment,
                    .rest = {{}, {}, body.mesh.uvs, body.mesh.triangles},
                    .shapes_mm = {},
                    .normals = {},
                    .centre_mm = {},
                    .scale = {}};
    Vec3 low;
    Vec3 high;
    box(body.mesh.positions_mm, low, high);
    const double last_diagonal = length(high - low);
    for (std::vector<Body>& frame : frames) {
      const auto same = std::find_if(frame.begin(), frame.end(), [&](const Body& b) {
        return b.name == body.name && b.mesh.positions_mm.size() == body.mesh.positions_mm.size();
      });
      double diagonal = 0.0;
      Vec3 centre;
      if (same != frame.end()) {
        box(same->mesh.positions_mm, low, high);
        diagonal = length(high - low);
        centre = 0.5 * (low + high);
      }
      track.centre_mm.push_back(centre);
      // Too small to have a shape: it takes the last one's, at scale 0.
      const bool visible = diagonal > 1e-6 * last_diagonal && last_diagonal > 0.0;
      track.scale.push_back(visible ? diagonal / last_diagonal : 0.0);
      const Mesh& from = visible ? same->mesh : body.mesh;
      if (!visible) {
        box(from.positions_mm, low, high);
        centre = 0.5 * (low + high);
      }
      std::vector<Vec3> shape = from.positions_mm;
      for (Vec3& p : shape) {
        p = (p - centre) / (visible ? track.scale.back() : 1.0);
      }
      track.shapes_mm.push_back(std::move(shape));
      track.normals.push_back(from.normals);
    }
    tracks.push_back(std::move(track));
  }
  return tracks;
}

}  // namespace

std::vector<double> frame_times(const GlbOptions& options) {
  if (options.time) {
    return {*options.time};
  }
  std::vector<double> times;
  for (int frame = 0; frame < options.frames; ++frame) {
    times.push_back(static_cast<double>(frame) / (options.frames - 1));
  }
  return times;
}

Expected<Timeline> sample_timeline(const Development& development, const GlbOptions& options,
                                   const Progress& progress) {
  Timeline timeline;
  timeline.times = frame_times(options);
  const std::size_t frames = timeline.times.size();
  for (const Organ& organ : development.organs()) {
    if (organ.birth <= timeline.times.back()) {
      timeline.organs.push_back(organ.id);
    }
  }
  std::uint64_t keys = 0;
  if (__builtin_mul_overflow(std::uint64_t{timeline.organs.size()}, std::uint64_t{frames}, &keys) || keys > kMaxKeys) {
    return unexpected(Error{ErrorCode::kTooLarge, "frames",
                            "times the number of organs must be at most " + std::to_string(kMaxKeys) + ", got " +
                                std::to_string(frames) + " x " + std::to_string(timeline.organs.size())});
  }

  constexpr std::uint32_t kNoRow = ~0u;
  std::vector<std::uint32_t> row_of(development.organs().size() + 1, kNoRow);
  for (std::size_t i = 0; i < timeline.organs.size(); ++i) {
    row_of[timeline.organs[i].value] = static_cast<std::uint32_t>(i);
  }
  timeline.keys.resize(keys);
  std::vector<std::vector<Body>> bodies(frames);
  std::vector<OrganId> bad(frames);
  const bool done = parallel_for(
      frames,
      [&](std::size_t frame) {
        Canopy canopy = development.at(timeline.times[frame]);
        for (const OrganState& state : canopy.organs) {
          const std::uint32_t row = row_of[state.id.value];
          if (!finite(state)) {
            bad[frame] = state.id;
          } else if (row != kNoRow) {
            timeline.keys[frame * timeline.organs.size() + row] = key_of(state);
          }
        }
        bodies[frame] = std::move(canopy.bodies);
      },
      progress, "frames");
  if (!done) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  for (std::size_t frame = 0; frame < frames; ++frame) {
    if (bad[frame].value != 0) {
      return unexpected(Error{ErrorCode::kInvalidParameter, "organ " + std::to_string(bad[frame].value),
                              "has a placement that is not finite at time " + to_text(timeline.times[frame])});
    }
  }
  join_frames(timeline);
  timeline.bodies = split_bodies(bodies);
  return timeline;
}

Expected<std::vector<MorphChain>> template_chains(const Development& development, const Timeline& timeline,
                                                  const GlbOptions& options, const Progress& progress) {
  const std::size_t count = development.templates().size();
  std::vector<double> low(count, 2.0);
  std::vector<double> high(count, -1.0);
  std::vector<std::uint32_t> kind(count, 0);
  for (std::size_t i = 0; i < timeline.organs.size(); ++i) {
    const Organ& organ = development.organs()[timeline.organs[i].value - 1];
    kind[organ.template_index] = organ.kind;
    for (std::size_t frame = 0; frame < timeline.times.size(); ++frame) {
      const OrganKey& key = timeline.key(frame, i);
      if (key.born) {
        low[organ.template_index] = std::min<double>(low[organ.template_index], key.stage);
        high[organ.template_index] = std::max<double>(high[organ.template_index], key.stage);
      }
    }
  }
  std::vector<MorphChain> chains(count);
  const bool done = parallel_for(
      count,
      [&](std::size_t t) {
        if (high[t] >= low[t]) {
          chains[t] = choose_morph_keys(development.templates()[t], low[t], high[t],
                                        kink_stages(development.species().organs[kind[t]].shape),
                                        options.morph_tolerance, options.morph_targets);
        }
      },
      progress, "shapes");
  if (!done) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  return chains;
}

MorphChain body_chain(const BodyTrack& body, const Timeline& timeline, const GlbOptions& options) {
  // A stem is long against what sits at its end; there are few bodies, and their targets cost little.
  constexpr double kStricter = 0.2;
  return choose_morph_keys(body.shapes_mm, timeline.times, kStricter * options.morph_tolerance, options.morph_targets);
}

}  // namespace anthesis::detail
