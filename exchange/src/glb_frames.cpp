#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "anthesis/base/parallel.h"
#include "anthesis/exchange/glb.h"
#include "flat_plant.h"
#include "frame_tracks.h"
#include "glb_writer.h"
#include "text.h"

// A plant whose organs were bent by touching. Organs then share no shape, and the file must state the very coordinates
// that were found free of crossings: a mesh and a morph target for each key frame, and no transform below the root.

namespace anthesis {
namespace {

using tinygltf::Value;

// What a key shape, a node and a file take in the text beside their numbers, about.
constexpr std::uint64_t kTextOfShape = 420;
constexpr std::uint64_t kTextOfNode = 800;
constexpr std::uint64_t kBytesOfVertex = 24;  // position and normal

// Organs are posed and written in blocks of about this many vertices x key shapes.
constexpr std::size_t kBlock = 500'000;

/// The frames whose weights, among those of `track`, linear interpolation does not give anyway.
std::vector<std::uint16_t> kept_frames(const detail::FrameTrack& track, std::size_t frames) {
  const auto shape = [&](std::size_t frame) {
    return track.shapes[std::max(frame, track.first_frame) - track.first_frame];
  };
  std::vector<std::uint16_t> kept;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const bool rests =
        frame > 0 && frame + 1 < frames && shape(frame - 1) == shape(frame) && shape(frame + 1) == shape(frame);
    if (!rests) {
      kept.push_back(static_cast<std::uint16_t>(frame));
    }
  }
  return kept;
}

/// The weights at the frames `kept`: 1 for the target that is the shape there; none for the last shape, the base.
std::vector<float> key_weights(const detail::FrameTrack& track, const std::vector<std::uint16_t>& kept) {
  const std::size_t targets = track.frame_of_shape.size() - 1;
  std::vector<float> weights(kept.size() * targets, 0.0f);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const std::size_t frame = std::max<std::size_t>(kept[i], track.first_frame);
    const std::size_t shape = track.shapes[frame - track.first_frame];
    if (shape < targets) {
      weights[i * targets + shape] = 1.0f;
    }
  }
  return weights;
}

/// Whether adding the key's difference to the base in single precision gives `positions_mm` themselves.
bool is_exact(const detail::KeyShapes& shapes, std::size_t key, std::span<const Vec3> positions_mm) {
  const std::vector<float>& base = shapes.positions.front();
  for (std::size_t i = 0; i < positions_mm.size(); ++i) {
    const double wanted[3] = {positions_mm[i].x, positions_mm[i].y, positions_mm[i].z};
    for (std::size_t c = 0; c < 3; ++c) {
      const float found = key == 0 ? base[3 * i + c] : base[3 * i + c] + shapes.positions[key][3 * i + c];
      if (static_cast<double>(found) != wanted[c]) {
        return false;
      }
    }
  }
  return true;
}

/// The distinct shapes of a track as keys: the last one is the base, so that a program without morph targets shows the
/// plant at its last time.
struct TrackKeys {
  detail::KeyShapes shapes;
  bool exact = true;  ///< as far as the frames ask for it
};

/// `pose(frame, positions_mm, normals)` returns whether its positions must be stated exactly.
template <class Pose>
TrackKeys keys_of(const detail::FrameTrack& track, const Pose& pose) {
  TrackKeys keys;
  std::vector<Vec3> positions_mm;
  std::vector<Vec3> normals;
  const std::size_t count = track.frame_of_shape.size();
  for (std::size_t key = 0; key < count; ++key) {
    const bool must_be_exact = pose(track.frame_of_shape[key == 0 ? count - 1 : key - 1], positions_mm, normals);
    detail::append_key(keys.shapes, positions_mm, normals);
    keys.exact = keys.exact && (!must_be_exact || is_exact(keys.shapes, key, positions_mm));
  }
  return keys;
}

Value track_extras(const detail::FrameTrack& track, std::span<const Canopy> frames) {
  if (track.frame_of_shape.size() < 2) {
    return {};
  }
  Value::Array names;
  for (std::size_t shape = 0; shape + 1 < track.frame_of_shape.size(); ++shape) {
    names.push_back(Value(detail::shape_name("time", frames[track.frame_of_shape[shape]].time)));
  }
  return Value(Value::Object{{"targetNames", Value(names)}});
}

/// Keys of a node below the root. Before birth it is a point at its place of birth; from its first frame on its
/// transform is the identity. Between these two it grows from that point in straight lines.
void add_track_channels(detail::GlbWriter& writer, int node, const detail::FrameTrack& track, std::size_t frames) {
  if (track.first_frame > 0) {
    std::vector<std::uint16_t> kept;
    std::vector<float> translation;
    std::vector<float> scale;
    for (const std::size_t frame : {std::size_t{0}, track.first_frame - 1, track.first_frame, frames - 1}) {
      if (!kept.empty() && kept.back() == frame) {
        continue;
      }
      const bool born = frame >= track.first_frame;
      kept.push_back(static_cast<std::uint16_t>(frame));
      detail::append(translation, born ? Vec3{} : track.birth_place_mm);
      scale.insert(scale.end(), 3, born ? 1.0f : 0.0f);
    }
    writer.add_shared_channel(node, "translation", kept, translation);
    writer.add_shared_channel(node, "scale", kept, scale);
  }
  if (track.frame_of_shape.size() > 1) {
    const std::vector<std::uint16_t> kept = kept_frames(track, frames);
    writer.add_shared_channel(node, "weights", kept, key_weights(track, kept));
  }
}

/// Refuses before memory is taken for what cannot be written.
std::optional<Error> check_size(const Development& development, const detail::FrameTracks& tracks, std::size_t frames) {
  std::uint64_t total = 0;
  bool countable = true;
  const auto add = [&](std::uint64_t count, std::uint64_t each) {
    std::uint64_t product = 0;
    countable =
        countable && !__builtin_mul_overflow(count, each, &product) && !__builtin_add_overflow(total, product, &total);
  };
  // Tracks of equal keys share their weights.
  std::set<std::pair<std::size_t, std::vector<std::uint16_t>>> patterns;
  const auto add_track = [&](const detail::FrameTrack& track) {
    add(track.vertex_count * track.frame_of_shape.size(), kBytesOfVertex);
    add(track.frame_of_shape.size(), kTextOfShape);
    add(1, kTextOfNode);
    if (patterns.insert({track.first_frame, track.shapes}).second) {
      add(kept_frames(track, frames).size(), 4 * track.frame_of_shape.size());
    }
  };
  std::set<std::uint32_t> templates;
  for (std::size_t i = 0; i < tracks.organs.size(); ++i) {
    add_track(tracks.organs[i]);
    templates.insert(development.organs()[tracks.ids[i].value - 1].template_index);
  }
  for (const detail::FrameTrack& body : tracks.bodies) {
    add_track(body);
  }
  for (const std::uint32_t t : templates) {
    add(development.templates()[t].vertex_count(), 8);
    add(development.templates()[t].triangles().size(), 6);
  }
  if (!countable || total > detail::kMaxGlbBytes) {
    constexpr double kGib = 1024.0 * 1024.0 * 1024.0;
    const std::string size =
        countable ? to_text(0.1 * std::ceil(10.0 * static_cast<double>(total) / kGib)).substr(0, 5) : "many";
    return Error{ErrorCode::kTooLarge, "frames",
                 "make a file of " + size +
                     " GiB, more than the 2 GiB that a GLB may have: ask for fewer frames or less "
                     "detail"};
  }
  return std::nullopt;
}

Error not_exact(const std::string& name) {
  return {
      ErrorCode::kTooLarge, name,
      "cannot be stated exactly: the coordinates and their differences between key frames must fit single precision, "
      "as multiples of 2^-14 mm below 1024 mm do"};
}

}  // namespace

Expected<std::string> to_glb(const Development& development, std::span<const Canopy> frames, const GlbOptions& options,
                             const Progress& progress) {
  GlbOptions used = options;  // what the frames say themselves is not looked at
  used.time = frames.empty() ? 0.0 : frames.back().time;
  if (std::optional<Error> error = check(used)) {
    return unexpected(*error);
  }
  const Expected<detail::FrameTracks> tracks = detail::track_frames(development, frames, progress);
  if (!tracks) {
    return unexpected(tracks.error());
  }
  if (std::optional<Error> error = check_size(development, *tracks, frames.size())) {
    return unexpected(*error);
  }
  const std::span<const OrganTemplate> templates = development.templates();
  const Canopy& last = frames.back();

  // In the order in which the meshes first use them.
  std::vector<detail::Pigments> pigment_sets;
  const auto use = [&](const detail::Pigments& pigments) {
    if (std::find(pigment_sets.begin(), pigment_sets.end(), pigments) == pigment_sets.end()) {
      pigment_sets.push_back(pigments);
    }
  };
  for (const std::size_t body : tracks->body_of_track) {
    use({last.bodies[body].pigment});
  }
  for (const OrganId id : tracks->ids) {
    const OrganTemplate& shape = templates[development.organs()[id.value - 1].template_index];
    if (!shape.triangles().empty()) {
      use(detail::pigments_of(shape));
    }
  }

  std::vector<double> times;
  for (const Canopy& canopy : frames) {
    times.push_back(canopy.time);
  }
  const std::vector<double> seconds = detail::key_seconds(times, options.duration_s);
  for (std::size_t frame = 1; frame < seconds.size(); ++frame) {
    if (!(static_cast<float>(seconds[frame - 1]) < static_cast<float>(seconds[frame]))) {
      return unexpected(
          invalid_parameter("frames", "must lie farther apart than single precision tells times", frames[frame].time));
    }
  }
  detail::GlbWriter writer(development, seconds);
  writer.write_asset(frames.size() == 1 ? std::optional(last.time) : std::nullopt, tracks->resolved);
  writer.add_root();
  if (std::optional<Error> error = writer.add_materials(pigment_sets, options.diffuse_transmission, progress)) {
    return unexpected(*error);
  }
  std::size_t vectors = 0;
  for (const detail::FrameTrack& track : tracks->organs) {
    vectors += 2 * track.vertex_count * track.frame_of_shape.size();
  }
  for (const detail::FrameTrack& track : tracks->bodies) {
    vectors += 2 * track.vertex_count * track.frame_of_shape.size();
  }
  writer.reserve_vertices(vectors);

  for (std::size_t j = 0; j < tracks->bodies.size(); ++j) {
    const detail::FrameTrack& track = tracks->bodies[j];
    const Body& body = last.bodies[tracks->body_of_track[j]];
    const TrackKeys keys =
        keys_of(track, [&](std::size_t frame, std::vector<Vec3>& positions_mm, std::vector<Vec3>& normals) {
          const Mesh& mesh = detail::body_named(frames[frame], body.name)->mesh;
          positions_mm = mesh.positions_mm;
          normals = mesh.normals;
          return tracks->resolved;
        });
    if (!keys.exact) {
      return unexpected(not_exact(body.name));
    }
    detail::MeshSurface surface{writer.material_of({body.pigment}).index, body.mesh.triangles, body.mesh.uvs};
    tinygltf::Node node;
    node.name = detail::valid_utf8(body.name);
    node.mesh = writer.add_mesh(body.name + " shape", surface, keys.shapes, track_extras(track, frames));
    add_track_channels(writer, writer.add_node(std::move(node)), track, frames.size());
  }

  std::map<std::uint32_t, detail::MeshSurface> surfaces;  // by template
  for (std::size_t begin = 0; begin < tracks->organs.size();) {
    std::size_t end = begin;
    for (std::size_t size = 0; end < tracks->organs.size() && (end == begin || size < kBlock); ++end) {
      size += tracks->organs[end].vertex_count * tracks->organs[end].frame_of_shape.size();
    }
    std::vector<TrackKeys> block(end - begin);
    parallel_for(block.size(), [&](std::size_t i) {
      const OrganId id = tracks->ids[begin + i];
      const OrganTemplate& shape = templates[development.organs()[id.value - 1].template_index];
      block[i] = keys_of(tracks->organs[begin + i],
                         [&](std::size_t frame, std::vector<Vec3>& positions_mm, std::vector<Vec3>& normals) {
                           const OrganState& state = *detail::organ_in(frames[frame], id);
                           detail::pose_in_world(shape, state, positions_mm, normals);
                           return !state.deformed_mm.empty();
                         });
    });
    for (std::size_t i = begin; i < end; ++i) {
      const detail::FrameTrack& track = tracks->organs[i];
      const OrganId id = tracks->ids[i];
      const std::uint32_t t = development.organs()[id.value - 1].template_index;
      const std::string name = organ_name(development, id);
      tinygltf::Node node = writer.organ_node(id, last.time);
      if (templates[t].triangles().empty()) {
        // An organ without surface stays as an empty node at its place, so that the tree of organs is whole.
        std::vector<float> place;
        detail::append(place, detail::organ_in(last, id)->world_from_organ.position_mm);
        node.translation = detail::tidy_all(place);
        writer.add_node(std::move(node));
        continue;
      }
      if (!block[i - begin].exact) {
        return unexpected(not_exact(name));
      }
      const auto [surface, is_new] = surfaces.try_emplace(t);
      if (is_new) {
        const detail::Pigments pigments = detail::pigments_of(templates[t]);
        const detail::WornMaterial& worn = writer.material_of(pigments);
        surface->second = {worn.index, templates[t].triangles(), detail::atlas_uvs(templates[t], pigments, worn)};
      }
      node.mesh =
          writer.add_mesh(name + " shape", surface->second, block[i - begin].shapes, track_extras(track, frames));
      add_track_channels(writer, writer.add_node(std::move(node)), track, frames.size());
      block[i - begin] = {};
    }
    begin = end;
    if (!report(progress, "glb", static_cast<double>(end) / static_cast<double>(tracks->organs.size() + 1))) {
      return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
    }
  }
  return writer.finish();
}

}  // namespace anthesis
