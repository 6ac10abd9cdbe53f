#include "anthesis/exchange/judge_sample.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "flat_plant.h"
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
                      {"name", detail::valid_utf8(detail::organ_name(development, id))},
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

}  // namespace anthesis
