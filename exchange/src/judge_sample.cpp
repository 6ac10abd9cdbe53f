#include "anthesis/exchange/judge_sample.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "flat_plant.h"
#include "frame_tracks.h"
#include "glb_writer.h"
#include "provenance.h"
#include "text.h"
#include "timeline.h"

namespace anthesis {
namespace {

using Json = nlohmann::ordered_json;

Json metres(Vec3 p_mm) {
  return {0.001 * p_mm.x, 0.001 * p_mm.z, -0.001 * p_mm.y};
}

std::vector<std::size_t> sample_vertices(std::size_t count) {
  std::vector<std::size_t> vertices;
  if (count > 0) {
    vertices = {0, count / 2, count - 1};
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }
  return vertices;
}

}  // namespace

Expected<std::string> expected_positions_json(const Development& development, const GlbOptions& options,
                                              std::span<const int> frames) {
  if (std::optional<Error> error = check(options)) {
    return unexpected(*error);
  }
  const Expected<detail::Timeline> timeline = detail::sample_timeline(development, options, {});
  if (!timeline) {
    return unexpected(timeline.error());
  }
  // Only the allowance for morphing comes from the writer's own choice of shapes; the positions do not.
  const Expected<std::vector<detail::MorphChain>> chains = detail::template_chains(development, *timeline, options, {});
  if (!chains) {
    return unexpected(chains.error());
  }
  const std::size_t frame_count = timeline->times.size();
  std::vector<Canopy> canopies;
  Json times_s = Json::array();
  for (const int frame : frames) {
    if (frame < 0 || static_cast<std::size_t>(frame) >= frame_count) {
      return unexpected(invalid_parameter("frames", "must name keys of the animation", frame));
    }
    const double time = timeline->times[static_cast<std::size_t>(frame)];
    canopies.push_back(development.at(time));
    times_s.push_back(frame_count > 1 ? options.duration_s * frame / (static_cast<double>(frame_count) - 1.0) : 0.0);
  }

  // How far single precision may move a vertex of a plant this large.
  double reach_mm = 1.0;
  for (const Canopy& canopy : canopies) {
    for (const OrganState& state : canopy.organs) {
      reach_mm = std::max(reach_mm, length(state.world_from_organ.position_mm));
    }
    for (const Body& body : canopy.bodies) {
      for (const Vec3 p : body.mesh.positions_mm) {
        reach_mm = std::max(reach_mm, length(p));
      }
    }
  }
  const double rounding_mm = 4e-6 * reach_mm;
  // The chain is sampled; between its samples it may stray a little farther than at them.
  constexpr double kBetweenSamples = 1.25;

  Json organs = Json::array();
  std::vector<Vec3> positions_mm;
  std::vector<Vec3> normals;
  for (const OrganId id : timeline->organs) {
    const Organ& organ = development.organs()[id.value - 1];
    const OrganTemplate& shape = development.templates()[organ.template_index];
    const std::vector<std::size_t> vertices = sample_vertices(shape.vertex_count());
    Json at_times = Json::array();
    double largest_scale = 0.0;
    for (const Canopy& canopy : canopies) {
      const auto state = std::lower_bound(canopy.organs.begin(), canopy.organs.end(), id,
                                          [](const OrganState& s, OrganId sought) { return s.id < sought; });
      if (state == canopy.organs.end() || state->id != id) {
        at_times.push_back(nullptr);
        continue;
      }
      largest_scale = std::max(largest_scale, state->world_from_organ.scale);
      detail::pose_in_world(shape, *state, positions_mm, normals);
      Json points = Json::array();
      for (const std::size_t vertex : vertices) {
        points.push_back(metres(positions_mm[vertex]));
      }
      at_times.push_back(std::move(points));
    }
    const double morph_mm = kBetweenSamples * (*chains)[organ.template_index].deviation_mm * largest_scale;
    organs.push_back({{"organ", id.value},
                      {"name", detail::valid_utf8(organ_name(development, id))},
                      {"vertex_count", shape.vertex_count()},
                      {"vertices", vertices},
                      {"tolerance_m", 0.001 * (morph_mm + rounding_mm)},
                      {"positions", std::move(at_times)}});
  }

  Json bodies = Json::array();
  for (const detail::BodyTrack& track : timeline->bodies) {
    const detail::MorphChain chain = detail::body_chain(track, *timeline, options);
    const std::vector<std::size_t> vertices = sample_vertices(track.shapes_mm.front().size());
    Json at_times = Json::array();
    double largest_scale = 0.0;
    for (std::size_t i = 0; i < canopies.size(); ++i) {
      const auto body = std::find_if(canopies[i].bodies.begin(), canopies[i].bodies.end(),
                                     [&](const Body& b) { return b.name == track.name; });
      if (body == canopies[i].bodies.end()) {
        at_times.push_back(nullptr);
        continue;
      }
      largest_scale = std::max(largest_scale, track.scale[static_cast<std::size_t>(frames[i])]);
      Json points = Json::array();
      for (const std::size_t vertex : vertices) {
        points.push_back(metres(body->mesh.positions_mm[vertex]));
      }
      at_times.push_back(std::move(points));
    }
    bodies.push_back({{"name", detail::valid_utf8(track.name)},
                      {"vertex_count", track.shapes_mm.front().size()},
                      {"vertices", vertices},
                      {"tolerance_m", 0.001 * (chain.deviation_mm * largest_scale + rounding_mm)},
                      {"positions", std::move(at_times)}});
  }

  const Json expected = {{"generator", detail::generator()},
                         {"frames", frame_count},
                         {"duration_s", frame_count > 1 ? options.duration_s : 0.0},
                         {"times_s", std::move(times_s)},
                         {"bodies", std::move(bodies)},
                         {"organs", std::move(organs)}};
  return expected.dump() + "\n";
}

Expected<std::string> expected_positions_json(const Development& development, std::span<const Canopy> frames,
                                              const GlbOptions& options, std::span<const int> sampled) {
  const Expected<detail::FrameTracks> tracks = detail::track_frames(development, frames, {});
  if (!tracks) {
    return unexpected(tracks.error());
  }
  std::vector<double> times;
  for (const Canopy& canopy : frames) {
    times.push_back(canopy.time);
  }
  const std::vector<double> seconds = detail::key_seconds(times, options.duration_s);
  Json times_s = Json::array();
  std::vector<const Canopy*> canopies;
  for (const int frame : sampled) {
    if (frame < 0 || static_cast<std::size_t>(frame) >= frames.size()) {
      return unexpected(invalid_parameter("frames", "must name keys of the animation", frame));
    }
    times_s.push_back(seconds[static_cast<std::size_t>(frame)]);
    canopies.push_back(&frames[static_cast<std::size_t>(frame)]);
  }

  // The file has the numbers themselves: all that is left is how a reader of single precision turns the root to +Y and
  // to metres, four roundings of a coordinate and as many of the matrix.
  constexpr double kReaderRounding = 5e-7;
  const auto item = [&](const detail::FrameTrack& track, const std::string& name, const auto& positions_in) {
    const std::vector<std::size_t> vertices = sample_vertices(track.vertex_count);
    double reach_mm = 0.0;
    Json at_times = Json::array();
    for (std::size_t i = 0; i < canopies.size(); ++i) {
      if (static_cast<std::size_t>(sampled[i]) < track.first_frame) {
        at_times.push_back(nullptr);
        continue;
      }
      const std::vector<Vec3> positions_mm = positions_in(*canopies[i]);
      Json points = Json::array();
      for (const std::size_t vertex : vertices) {
        reach_mm = std::max(reach_mm, length(positions_mm[vertex]));
        points.push_back(metres(positions_mm[vertex]));
      }
      at_times.push_back(std::move(points));
    }
    return Json{{"name", detail::valid_utf8(name)},
                {"vertex_count", track.vertex_count},
                {"vertices", vertices},
                {"tolerance_m", 0.001 * kReaderRounding * reach_mm},
                {"positions", std::move(at_times)}};
  };

  Json organs = Json::array();
  for (std::size_t i = 0; i < tracks->ids.size(); ++i) {
    const OrganId id = tracks->ids[i];
    Json organ = item(tracks->organs[i], organ_name(development, id), [&](const Canopy& canopy) {
      const OrganState& state = *detail::organ_in(canopy, id);
      std::vector<Vec3> positions_mm;
      std::vector<Vec3> normals;
      detail::pose_in_world(detail::template_of(development, state), state, positions_mm, normals);
      return positions_mm;
    });
    organ["organ"] = id.value;
    organs.push_back(std::move(organ));
  }
  Json bodies = Json::array();
  for (std::size_t j = 0; j < tracks->bodies.size(); ++j) {
    const std::string& name = frames.back().bodies[tracks->body_of_track[j]].name;
    bodies.push_back(item(tracks->bodies[j], name,
                          [&](const Canopy& canopy) { return detail::body_named(canopy, name)->mesh.positions_mm; }));
  }
  const Json expected = {{"generator", detail::generator()}, {"frames", frames.size()},
                         {"duration_s", seconds.back()},     {"times_s", std::move(times_s)},
                         {"bodies", std::move(bodies)},      {"organs", std::move(organs)}};
  return expected.dump() + "\n";
}

}  // namespace anthesis
