#include "anthesis/exchange/glb.h"

#include <algorithm>
#include <map>

#include "anthesis/base/parallel.h"
#include "check_time.h"
#include "glb_writer.h"
#include "text.h"
#include "timeline.h"

namespace anthesis {
namespace {

using tinygltf::Value;

constexpr int kMaxFrames = 2000;
constexpr int kMaxTargets = 64;
constexpr double kMaxDuration_s = 86400.0;

detail::KeyShapes pose_keys(const OrganTemplate& shape, const detail::MorphChain& chain) {
  std::vector<Vec3> positions_mm(shape.vertex_count());
  std::vector<std::vector<Vec3>> normals(chain.keys.size(), std::vector<Vec3>(shape.vertex_count()));
  detail::KeyFit fit(chain, shape.vertex_count());
  std::size_t key = 0;
  for (std::size_t sample = 0; sample < chain.places.size(); ++sample) {
    shape.pose(chain.places[sample], positions_mm, normals[key]);
    fit.add(sample, positions_mm);
    // The normals of a key are those of its sample; those of the samples before it are written over.
    if (sample == chain.keys[key] && key + 1 < chain.keys.size()) {
      ++key;
    }
  }
  const std::vector<std::vector<Vec3>> keys = fit.solve();
  detail::KeyShapes shapes;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    detail::append_key(shapes, keys[k], normals[k]);
  }
  return shapes;
}

detail::KeyShapes body_keys(const detail::BodyTrack& body, const detail::MorphChain& chain) {
  detail::KeyFit fit(chain, body.shapes_mm.front().size());
  for (std::size_t frame = 0; frame < body.shapes_mm.size(); ++frame) {
    fit.add(frame, body.shapes_mm[frame]);
  }
  const std::vector<std::vector<Vec3>> keys = fit.solve();
  detail::KeyShapes shapes;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    detail::append_key(shapes, keys[k], body.normals[chain.keys[k]]);
  }
  return shapes;
}

/// What the meshes of a chain say of it: the names of its shapes and how near they come.
Value chain_extras(const detail::MorphChain& chain, const char* unit) {
  if (chain.target_count() == 0) {
    return {};
  }
  Value::Array names;
  for (std::size_t k = 1; k < chain.keys.size(); ++k) {
    names.push_back(Value(detail::shape_name(unit, chain.places[chain.keys[k]])));
  }
  return Value(Value::Object{{"targetNames", Value(names)},
                             {"morph_deviation_mm", Value(detail::tidy(static_cast<float>(chain.deviation_mm)))}});
}

void add_organ(detail::GlbWriter& writer, const detail::Timeline& timeline, std::size_t row, int mesh,
               const detail::MorphChain& chain) {
  const std::size_t frames = timeline.times.size();
  const detail::OrganKey& last = timeline.key(frames - 1, row);

  std::vector<float> weights(frames * chain.target_count());
  for (std::size_t frame = 0; frame < frames && !weights.empty(); ++frame) {
    chain.weights_at(chain.coordinate_at(timeline.key(frame, row).stage),
                     std::span(weights).subspan(frame * chain.target_count(), chain.target_count()));
  }

  tinygltf::Node node = writer.organ_node(timeline.organs[row], timeline.times.back());
  node.mesh = mesh;
  node.translation = detail::tidy_all(last.translation_mm);
  node.rotation = detail::tidy_all(last.rotation);
  node.scale = std::vector<double>(3, detail::tidy(last.scale));
  node.weights = detail::tidy_all(std::span(weights).last(chain.target_count()));
  const int index = writer.add_node(std::move(node));

  if (frames > 1) {
    std::vector<float> translation;
    std::vector<float> rotation;
    std::vector<float> scale;
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const detail::OrganKey& key = timeline.key(frame, row);
      translation.insert(translation.end(), key.translation_mm.begin(), key.translation_mm.end());
      rotation.insert(rotation.end(), key.rotation.begin(), key.rotation.end());
      scale.insert(scale.end(), 3, key.scale);
    }
    writer.add_channel(index, "translation", 3, translation);
    writer.add_channel(index, "rotation", 4, rotation);
    writer.add_channel(index, "scale", 3, scale);
    writer.add_channel(index, "weights", chain.target_count(), weights);
  }
}

void add_body(detail::GlbWriter& writer, const detail::BodyTrack& body, int mesh, const detail::MorphChain& chain) {
  const std::size_t frames = body.scale.size();
  const std::size_t targets = chain.target_count();
  std::vector<float> translation;
  std::vector<float> scale;
  std::vector<float> weights(frames * targets);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    detail::append(translation, body.centre_mm[frame]);
    scale.insert(scale.end(), 3, static_cast<float>(body.scale[frame]));
    if (targets > 0) {
      chain.weights_at(chain.coordinates[frame], std::span(weights).subspan(frame * targets, targets));
    }
  }
  tinygltf::Node node;
  node.name = detail::valid_utf8(body.name);
  node.mesh = mesh;
  node.translation = detail::tidy_all(std::span(translation).last(3));
  node.scale = detail::tidy_all(std::span(scale).last(3));
  node.weights = detail::tidy_all(std::span(weights).last(targets));
  const int index = writer.add_node(std::move(node));
  writer.add_channel(index, "translation", 3, translation);
  writer.add_channel(index, "scale", 3, scale);
  writer.add_channel(index, "weights", targets, weights);
}

/// Bytes of the meshes and keys, at least; refuses before memory is taken for what cannot be written.
std::optional<Error> check_size(const Development& development, const detail::Timeline& timeline,
                                const std::vector<detail::MorphChain>& chains) {
  std::uint64_t total = 0;
  bool fits = true;
  const auto add = [&](std::uint64_t count, std::uint64_t each) {
    std::uint64_t product = 0;
    fits = fits && !__builtin_mul_overflow(count, each, &product) && !__builtin_add_overflow(total, product, &total) &&
           total <= detail::kMaxGlbBytes;
  };
  for (std::size_t t = 0; t < chains.size(); ++t) {
    if (!chains[t].keys.empty()) {
      add(development.templates()[t].vertex_count(), 8 + 24 * chains[t].keys.size());
      add(development.templates()[t].triangles().size(), 6);
    }
  }
  for (const detail::BodyTrack& body : timeline.bodies) {
    add(body.rest.uvs.size(), 8 + 24);
    add(body.rest.triangles.size(), 6);
  }
  if (!fits) {
    return Error{ErrorCode::kTooLarge, "detail", "makes a file of more than 2 GiB, the most a GLB may have"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> check(const GlbOptions& options) {
  if (options.time) {
    if (std::optional<Error> error = detail::check_time(*options.time)) {
      return error;
    }
  } else if (options.frames < 2 || options.frames > kMaxFrames) {
    return invalid_parameter("frames", "must be 2 to " + std::to_string(kMaxFrames), options.frames);
  }
  if (!(options.duration_s > 0.0 && options.duration_s <= kMaxDuration_s)) {
    return invalid_parameter("duration_s", "must be > 0 and at most 86400", options.duration_s);
  }
  if (!(options.morph_tolerance > 0.0 && options.morph_tolerance <= 1.0)) {
    return invalid_parameter("morph_tolerance", "must be > 0 and at most 1", options.morph_tolerance);
  }
  if (options.morph_targets < 1 || options.morph_targets > kMaxTargets) {
    return invalid_parameter("morph_targets", "must be 1 to " + std::to_string(kMaxTargets), options.morph_targets);
  }
  return std::nullopt;
}

Expected<std::string> to_glb(const Development& development, const GlbOptions& options, const Progress& progress) {
  if (std::optional<Error> error = check(options)) {
    return unexpected(*error);
  }
  const Expected<detail::Timeline> timeline = detail::sample_timeline(development, options, progress);
  if (!timeline) {
    return unexpected(timeline.error());
  }
  const Expected<std::vector<detail::MorphChain>> chains =
      detail::template_chains(development, *timeline, options, progress);
  if (!chains) {
    return unexpected(chains.error());
  }
  if (std::optional<Error> error = check_size(development, *timeline, *chains)) {
    return unexpected(*error);
  }

  // In the order in which the meshes first use them.
  std::vector<detail::Pigments> pigment_sets;
  const auto use = [&](const detail::Pigments& pigments) {
    if (std::find(pigment_sets.begin(), pigment_sets.end(), pigments) == pigment_sets.end()) {
      pigment_sets.push_back(pigments);
    }
  };
  const std::span<const OrganTemplate> templates = development.templates();
  for (const detail::BodyTrack& body : timeline->bodies) {
    use({body.pigment});
  }
  for (std::size_t t = 0; t < templates.size(); ++t) {
    if (!(*chains)[t].keys.empty() && !templates[t].triangles().empty()) {
      use(detail::pigments_of(templates[t]));
    }
  }

  detail::GlbWriter writer(development, detail::key_seconds(timeline->times, options.duration_s));
  writer.write_asset(timeline->times.size() == 1 ? options.time : std::nullopt, false);
  writer.add_root();
  if (std::optional<Error> error = writer.add_materials(pigment_sets, options.diffuse_transmission, progress)) {
    return unexpected(*error);
  }

  for (const detail::BodyTrack& body : timeline->bodies) {
    const detail::MorphChain chain = detail::body_chain(body, *timeline, options);
    detail::MeshSurface surface{writer.material_of({body.pigment}).index, body.rest.triangles, body.rest.uvs};
    const int mesh = writer.add_mesh(body.name, surface, body_keys(body, chain), chain_extras(chain, "time"));
    add_body(writer, body, mesh, chain);
  }

  std::vector<detail::KeyShapes> shapes(templates.size());
  const bool done = parallel_for(
      templates.size(),
      [&](std::size_t t) {
        if (!(*chains)[t].keys.empty()) {
          shapes[t] = pose_keys(templates[t], (*chains)[t]);
        }
      },
      progress, "shapes");
  if (!done) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  constexpr int kNotYet = -2;
  std::vector<int> mesh_of(templates.size(), kNotYet);
  std::map<std::uint32_t, std::uint32_t> variants;  // of each kind so far
  for (const OrganId id : timeline->organs) {
    const Organ& organ = development.organs()[id.value - 1];
    const std::uint32_t t = organ.template_index;
    if (mesh_of[t] != kNotYet) {
      continue;
    }
    if (templates[t].triangles().empty()) {
      mesh_of[t] = -1;
      continue;
    }
    const detail::Pigments pigments = detail::pigments_of(templates[t]);
    const detail::WornMaterial& worn = writer.material_of(pigments);
    const std::string name =
        development.species().organs[organ.kind].name + " shape " + std::to_string(++variants[organ.kind]);
    detail::MeshSurface surface{worn.index, templates[t].triangles(), detail::atlas_uvs(templates[t], pigments, worn)};
    mesh_of[t] = writer.add_mesh(name, surface, shapes[t], chain_extras((*chains)[t], "stage"));
    shapes[t] = {};
  }
  for (std::size_t row = 0; row < timeline->organs.size(); ++row) {
    const std::uint32_t t = development.organs()[timeline->organs[row].value - 1].template_index;
    // An organ without surface stays as an empty node, so that the tree of organs is whole; weights need a mesh.
    add_organ(writer, *timeline, row, mesh_of[t], mesh_of[t] < 0 ? detail::MorphChain{} : (*chains)[t]);
  }
  if (!report(progress, "glb", 0.5)) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  return writer.finish();
}

}  // namespace anthesis
