#include "anthesis/exchange/glb.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "check_time.h"
#include "flat_plant.h"
#include "gltf_buffer.h"
#include "provenance.h"
#include "text.h"
#include "texture.h"
#include "timeline.h"

namespace anthesis {
namespace {

using tinygltf::Value;

constexpr double kMetresPerMillimetre = 0.001;
constexpr int kMaxFrames = 2000;
constexpr int kMaxTargets = 64;
constexpr double kMaxDuration_s = 86400.0;
constexpr std::uint64_t kMaxBytes = 0x7fffffff;

// A key that lies on the line between its neighbours, to this share of the channel's largest value, is not written.
constexpr float kRedundant = 1e-6f;

/// The double whose shortest decimal text is that of the float: 0.1 and not 0.10000000149011612, which reads back as
/// the same float. Halves the text of the nodes.
double tidy(float value) {
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof(digits), value);
  double result = 0.0;
  std::from_chars(digits, end.ptr, result);
  return result;
}

template <class Floats>
std::vector<double> tidy_all(const Floats& values) {
  std::vector<double> result;
  for (const float value : values) {
    result.push_back(tidy(value));
  }
  return result;
}

void append(std::vector<float>& to, Vec3 v) {
  to.push_back(static_cast<float>(v.x));
  to.push_back(static_cast<float>(v.y));
  to.push_back(static_cast<float>(v.z));
}

/// A unit vector in single precision; a vector without direction becomes +z.
Vec3 unit(Vec3 v) {
  const double size = length(v);
  return std::isfinite(size) && size > 0.0 ? v / size : Vec3{0.0, 0.0, 1.0};
}

/// The pigments of a template, each once, in the order of its groups.
using Pigments = std::vector<std::string>;

Pigments pigments_of(const OrganTemplate& shape) {
  Pigments pigments;
  for (const TemplateGroup& group : shape.groups()) {
    if (std::find(pigments.begin(), pigments.end(), group.pigment) == pigments.end()) {
      pigments.push_back(group.pigment);
    }
  }
  if (pigments.empty()) {
    pigments.emplace_back();  // no such pigment: plain grey
  }
  return pigments;
}

/// A material, and where each of its pigments lies in its texture.
struct WornMaterial {
  int index = -1;
  std::vector<detail::AtlasTile> tiles;
};

/// Texture coordinates of a template in the texture of its material.
std::vector<Vec2> atlas_uvs(const OrganTemplate& shape, const Pigments& pigments, const WornMaterial& worn) {
  std::vector<Vec2> uvs(shape.uvs().begin(), shape.uvs().end());
  for (const TemplateGroup& group : shape.groups()) {
    const auto pigment = std::find(pigments.begin(), pigments.end(), group.pigment);
    const detail::AtlasTile& tile = worn.tiles[static_cast<std::size_t>(pigment - pigments.begin())];
    for (Vec2& uv : std::span(uvs).subspan(group.first_vertex, group.vertex_count)) {
      uv.x = tile.offset + tile.scale * uv.x;
    }
  }
  return uvs;
}

/// Positions and normals of a moving shape at its keys, in single precision: key 0 as it is, the others as differences.
struct KeyShapes {
  std::vector<std::vector<float>> positions;
  std::vector<std::vector<float>> normals;
};

void append_key(KeyShapes& shapes, std::span<const Vec3> positions_mm, std::span<const Vec3> normals) {
  std::vector<float> p;
  std::vector<float> n;
  p.reserve(3 * positions_mm.size());
  n.reserve(3 * normals.size());
  for (const Vec3 v : positions_mm) {
    append(p, v);
  }
  for (const Vec3 v : normals) {
    append(n, unit(v));
  }
  if (!shapes.positions.empty()) {
    // The difference of the rounded values, so that base + difference rounds to the key.
    for (std::size_t i = 0; i < p.size(); ++i) {
      p[i] -= shapes.positions.front()[i];
    }
    for (std::size_t i = 0; i < n.size(); ++i) {
      n[i] -= shapes.normals.front()[i];
    }
  }
  shapes.positions.push_back(std::move(p));
  shapes.normals.push_back(std::move(n));
}

KeyShapes pose_keys(const OrganTemplate& shape, const detail::MorphChain& chain) {
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
  KeyShapes shapes;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    append_key(shapes, keys[k], normals[k]);
  }
  return shapes;
}

KeyShapes body_keys(const detail::BodyTrack& body, const detail::MorphChain& chain) {
  detail::KeyFit fit(chain, body.shapes_mm.front().size());
  for (std::size_t frame = 0; frame < body.shapes_mm.size(); ++frame) {
    fit.add(frame, body.shapes_mm[frame]);
  }
  const std::vector<std::vector<Vec3>> keys = fit.solve();
  KeyShapes shapes;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    append_key(shapes, keys[k], body.normals[chain.keys[k]]);
  }
  return shapes;
}

/// Writes one file: holds the model while its meshes, nodes and animation come in.
class GlbWriter {
 public:
  GlbWriter(const Development& development, const GlbOptions& options, const detail::Timeline& timeline)
      : development_(development), options_(options), timeline_(timeline), buffer_(model_) {
    const double last = timeline.times.size() > 1 ? static_cast<double>(timeline.times.size() - 1) : 1.0;
    for (std::size_t frame = 0; frame < timeline.times.size(); ++frame) {
      seconds_.push_back(static_cast<float>(options.duration_s * static_cast<double>(frame) / last));
    }
  }

  void write_asset();
  void add_root();
  std::optional<Error> add_materials(const std::vector<Pigments>& sets, const Progress& progress);
  const WornMaterial& material_of(const Pigments& pigments) const { return materials_.at(pigments); }
  int add_mesh(const std::string& name, int material, std::span<const Triangle> triangles, std::span<const Vec2> uvs,
               const KeyShapes& shapes, const detail::MorphChain& chain, bool chain_of_times);
  void add_organ(std::size_t row, int mesh, const detail::MorphChain& chain);
  void add_body(const detail::BodyTrack& body, int mesh, const detail::MorphChain& chain);
  Expected<std::string> finish();

 private:
  int add_texture(std::string_view png, const std::string& name);
  int add_node(tinygltf::Node node);
  void add_channel(int node, const char* path, std::size_t width, const std::vector<float>& values);
  int times_accessor(const std::vector<std::uint16_t>& frames);

  const Development& development_;
  const GlbOptions& options_;
  const detail::Timeline& timeline_;
  tinygltf::Model model_;
  detail::GltfBuffer buffer_;
  tinygltf::Animation animation_;
  std::vector<float> seconds_;
  std::map<Pigments, WornMaterial> materials_;
  std::map<std::vector<std::uint16_t>, int> times_;  ///< accessor of each set of frames that some channel keeps
};

void GlbWriter::write_asset() {
  model_.asset.version = "2.0";
  model_.asset.generator = detail::generator();
  Value::Object extras;
  for (const auto& [key, value] : detail::provenance(development_)) {
    extras[key] = Value(detail::valid_utf8(value));
  }
  if (timeline_.times.size() == 1) {
    extras["time"] = Value(timeline_.times.front());
  }
  model_.asset.extras = Value(extras);
}

void GlbWriter::add_root() {
  tinygltf::Node root;
  root.name = detail::valid_utf8(development_.species().name);
  // +z to +y: a quarter turn about x, clockwise seen from +x.
  const double half = tidy(static_cast<float>(std::sqrt(0.5)));
  root.rotation = {-half, 0.0, 0.0, half};
  root.scale = {kMetresPerMillimetre, kMetresPerMillimetre, kMetresPerMillimetre};
  model_.nodes.push_back(root);
  tinygltf::Scene scene;
  scene.name = root.name;
  scene.nodes = {0};
  model_.scenes.push_back(scene);
  model_.defaultScene = 0;
}

int GlbWriter::add_texture(std::string_view png, const std::string& name) {
  if (model_.samplers.empty()) {
    tinygltf::Sampler sampler;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    sampler.wrapS = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    model_.samplers.push_back(sampler);
  }
  tinygltf::Texture texture;
  texture.sampler = 0;
  texture.source = buffer_.add_png(png, name);
  model_.textures.push_back(texture);
  return static_cast<int>(model_.textures.size()) - 1;
}

// One material for each set of pigments that some shape wears together, and so one mesh of one primitive for each
// shape: three.js (r187) animates the weights of shared meshes wrongly if they have more (it gives the primitives of
// all copies the same names), and nodes for each part make Blender's import several times as long.
std::optional<Error> GlbWriter::add_materials(const std::vector<Pigments>& sets, const Progress& progress) {
  struct Baked {
    std::vector<const Pigment*> pigments;
    std::optional<Colour> plain;
    Expected<detail::Atlas> atlas;
  };
  std::vector<Baked> baked(sets.size());
  const bool done = parallel_for(
      sets.size(),
      [&](std::size_t i) {
        for (const std::string& name : sets[i]) {
          baked[i].pigments.push_back(&detail::pigment_named(development_.species(), name));
        }
        if (sets[i].size() == 1) {
          baked[i].plain = detail::plain_colour(*baked[i].pigments.front());
        }
        if (!baked[i].plain) {
          baked[i].atlas = detail::bake_atlas(baked[i].pigments);
        }
      },
      progress, "textures");
  if (!done) {
    return Error{ErrorCode::kCancelled, "", "cancelled"};
  }

  bool sheen = false;
  bool diffuse_transmission = false;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    // What has no texture here is the first pigment's: the corolla's, or what else the species file names first.
    const Pigment& pigment = *baked[i].pigments.front();
    WornMaterial& worn = materials_[sets[i]];
    worn.index = static_cast<int>(model_.materials.size());
    tinygltf::Material material;
    for (const Pigment* each : baked[i].pigments) {
      material.name += (material.name.empty() ? "" : " + ") + detail::valid_utf8(each->name);
    }
    material.doubleSided = true;
    tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
    pbr.metallicFactor = 0.0;
    pbr.roughnessFactor = pigment.roughness;
    if (baked[i].plain) {
      pbr.baseColorFactor = {baked[i].plain->r, baked[i].plain->g, baked[i].plain->b, 1.0};
      worn.tiles = {{0.0, 1.0}};
    } else {
      if (!baked[i].atlas) {
        return baked[i].atlas.error();
      }
      worn.tiles = baked[i].atlas->tiles;
      pbr.baseColorTexture.index = add_texture(baked[i].atlas->colour_png, material.name);
      if (!baked[i].atlas->roughness_png.empty()) {
        pbr.roughnessFactor = 1.0;
        pbr.metallicRoughnessTexture.index = add_texture(baked[i].atlas->roughness_png, material.name + ", roughness");
      }
    }
    // The strength of the clear reflection, as the refractive index that has it. KHR_materials_specular says the same
    // more directly, but Blender 3.4 bakes it into a texture of tints, and divides by zero where the colour is white.
    const double reflection = std::sqrt(0.04 * std::clamp(pigment.specular, 0.0, 1.0));
    material.extensions["KHR_materials_ior"] =
        Value(Value::Object{{"ior", Value(tidy(static_cast<float>((1.0 + reflection) / (1.0 - reflection))))}});
    if (pigment.sheen > 0.0) {
      sheen = true;
      const Value strength(std::clamp(pigment.sheen, 0.0, 1.0));
      material.extensions["KHR_materials_sheen"] =
          Value(Value::Object{{"sheenColorFactor", Value(Value::Array{strength, strength, strength})},
                              {"sheenRoughnessFactor", Value(0.5)}});
    }
    if (options_.diffuse_transmission && pigment.translucency > 0.0) {
      diffuse_transmission = true;
      material.extensions["KHR_materials_diffuse_transmission"] =
          Value(Value::Object{{"diffuseTransmissionFactor", Value(std::clamp(pigment.translucency, 0.0, 1.0))}});
    }
    model_.materials.push_back(std::move(material));
  }
  if (!sets.empty()) {
    model_.extensionsUsed.push_back("KHR_materials_ior");
  }
  if (sheen) {
    model_.extensionsUsed.push_back("KHR_materials_sheen");
  }
  if (diffuse_transmission) {
    model_.extensionsUsed.push_back("KHR_materials_diffuse_transmission");
  }
  return std::nullopt;
}

int GlbWriter::add_mesh(const std::string& name, int material, std::span<const Triangle> triangles,
                        std::span<const Vec2> uvs, const KeyShapes& shapes, const detail::MorphChain& chain,
                        bool chain_of_times) {
  if (triangles.empty()) {
    return -1;
  }
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = material;
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) {
    indices.insert(indices.end(), triangle.begin(), triangle.end());
  }
  primitive.indices = buffer_.add_indices(indices, static_cast<std::uint32_t>(shapes.positions.front().size() / 3));
  primitive.attributes["POSITION"] = buffer_.add_vectors3(shapes.positions.front(), true);
  const bool has_normals = !shapes.normals.front().empty();
  if (has_normals) {
    primitive.attributes["NORMAL"] = buffer_.add_vectors3(shapes.normals.front(), false);
  }
  if (!uvs.empty()) {
    std::vector<float> coordinates;
    coordinates.reserve(2 * uvs.size());
    for (const Vec2 uv : uvs) {
      coordinates.push_back(static_cast<float>(uv.x));
      coordinates.push_back(static_cast<float>(uv.y));
    }
    primitive.attributes["TEXCOORD_0"] = buffer_.add_vectors2(coordinates);
  }
  for (std::size_t key = 1; key < shapes.positions.size(); ++key) {
    std::map<std::string, int>& target = primitive.targets.emplace_back();
    target["POSITION"] = buffer_.add_vectors3(shapes.positions[key], true);
    if (has_normals) {
      target["NORMAL"] = buffer_.add_vectors3(shapes.normals[key], false);
    }
  }
  tinygltf::Mesh mesh;
  mesh.name = detail::valid_utf8(name);
  mesh.primitives.push_back(std::move(primitive));
  if (chain.target_count() > 0) {
    Value::Array names;
    for (std::size_t k = 1; k < chain.keys.size(); ++k) {
      // Blender and three.js show these as the names of the shapes.
      char digits[32];
      const std::to_chars_result end =
          std::to_chars(digits, digits + sizeof(digits), chain.places[chain.keys[k]], std::chars_format::fixed, 3);
      names.push_back(Value((chain_of_times ? "time " : "stage ") + std::string(digits, end.ptr)));
    }
    mesh.extras = Value(Value::Object{{"targetNames", Value(names)},
                                      {"morph_deviation_mm", Value(tidy(static_cast<float>(chain.deviation_mm)))}});
  }
  model_.meshes.push_back(std::move(mesh));
  return static_cast<int>(model_.meshes.size()) - 1;
}

int GlbWriter::add_node(tinygltf::Node node) {
  const int index = static_cast<int>(model_.nodes.size());
  model_.nodes.push_back(std::move(node));
  model_.nodes.front().children.push_back(index);
  return index;
}

int GlbWriter::times_accessor(const std::vector<std::uint16_t>& frames) {
  const auto [place, is_new] = times_.try_emplace(frames, -1);
  if (is_new) {
    std::vector<float> values;
    for (const std::uint16_t frame : frames) {
      values.push_back(seconds_[frame]);
    }
    place->second = buffer_.add_times(values);
  }
  return place->second;
}

void GlbWriter::add_channel(int node, const char* path, std::size_t width, const std::vector<float>& values) {
  const std::size_t frames = seconds_.size();
  if (frames < 2 || width == 0) {
    return;
  }
  float largest = 0.0f;
  for (const float value : values) {
    largest = std::max(largest, std::abs(value));
  }
  const float tolerance = kRedundant * largest;
  const auto at = [&](std::size_t frame, std::size_t c) { return values[frame * width + c]; };
  bool constant = true;
  for (std::size_t frame = 0; constant && frame + 1 < frames; ++frame) {
    for (std::size_t c = 0; c < width; ++c) {
      constant = constant && std::abs(at(frame, c) - at(frames - 1, c)) <= tolerance;
    }
  }
  if (constant) {
    return;  // the node itself has the value
  }

  // From each kept key on, the longest stretch whose inner keys all lie on the line between its ends.
  const auto straight = [&](std::size_t a, std::size_t b) {
    for (std::size_t frame = a + 1; frame < b; ++frame) {
      const float f = static_cast<float>(frame - a) / static_cast<float>(b - a);
      for (std::size_t c = 0; c < width; ++c) {
        if (std::abs(at(frame, c) - ((1.0f - f) * at(a, c) + f * at(b, c))) > tolerance) {
          return false;
        }
      }
    }
    return true;
  };
  std::vector<std::uint16_t> kept = {0};
  for (std::size_t a = 0; a + 1 < frames;) {
    std::size_t b = a + 1;
    while (b + 1 < frames && straight(a, b + 1)) {
      ++b;
    }
    kept.push_back(static_cast<std::uint16_t>(b));
    a = b;
  }

  std::vector<float> output;
  output.reserve(kept.size() * width);
  for (const std::uint16_t frame : kept) {
    for (std::size_t c = 0; c < width; ++c) {
      output.push_back(at(frame, c));
    }
  }
  const std::string_view name = path;
  const int type = name == "rotation"  ? TINYGLTF_TYPE_VEC4
                   : name == "weights" ? TINYGLTF_TYPE_SCALAR
                                       : TINYGLTF_TYPE_VEC3;
  tinygltf::AnimationSampler sampler;
  sampler.input = times_accessor(kept);
  sampler.output = buffer_.add_keys(output, type);
  sampler.interpolation = "LINEAR";
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation_.samplers.size());
  channel.target_node = node;
  channel.target_path = path;
  animation_.channels.push_back(std::move(channel));
  animation_.samplers.push_back(std::move(sampler));
}

void GlbWriter::add_organ(std::size_t row, int mesh, const detail::MorphChain& chain) {
  const std::size_t frames = timeline_.times.size();
  const OrganId id = timeline_.organs[row];
  const Organ& organ = development_.organs()[id.value - 1];
  const detail::OrganKey& last = timeline_.key(frames - 1, row);

  std::vector<float> weights(frames * chain.target_count());
  for (std::size_t frame = 0; frame < frames && !weights.empty(); ++frame) {
    chain.weights_at(chain.coordinate_at(timeline_.key(frame, row).stage),
                     std::span(weights).subspan(frame * chain.target_count(), chain.target_count()));
  }

  tinygltf::Node node;
  node.name = detail::valid_utf8(detail::organ_name(development_, id));
  node.mesh = mesh;
  node.translation = tidy_all(last.translation_mm);
  node.rotation = tidy_all(last.rotation);
  node.scale = std::vector<double>(3, tidy(last.scale));
  node.weights = tidy_all(std::span(weights).last(chain.target_count()));
  node.extras =
      Value(Value::Object{{"organ", Value(static_cast<int>(id.value))},
                          {"kind", Value(detail::valid_utf8(development_.species().organs[organ.kind].name))},
                          {"parent", Value(static_cast<int>(organ.parent.value))},
                          {"birth", Value(tidy(static_cast<float>(organ.birth)))},
                          {"age", Value(tidy(static_cast<float>(timeline_.times.back() - organ.birth)))},
                          {"divergence_deg", Value(tidy(static_cast<float>(math::degrees(organ.divergence_rad))))}});
  const int index = add_node(std::move(node));

  if (frames > 1) {
    std::vector<float> translation;
    std::vector<float> rotation;
    std::vector<float> scale;
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const detail::OrganKey& key = timeline_.key(frame, row);
      translation.insert(translation.end(), key.translation_mm.begin(), key.translation_mm.end());
      rotation.insert(rotation.end(), key.rotation.begin(), key.rotation.end());
      scale.insert(scale.end(), 3, key.scale);
    }
    add_channel(index, "translation", 3, translation);
    add_channel(index, "rotation", 4, rotation);
    add_channel(index, "scale", 3, scale);
    add_channel(index, "weights", chain.target_count(), weights);
  }
}

void GlbWriter::add_body(const detail::BodyTrack& body, int mesh, const detail::MorphChain& chain) {
  const std::size_t frames = timeline_.times.size();
  const std::size_t targets = chain.target_count();
  std::vector<float> translation;
  std::vector<float> scale;
  std::vector<float> weights(frames * targets);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    append(translation, body.centre_mm[frame]);
    scale.insert(scale.end(), 3, static_cast<float>(body.scale[frame]));
    if (targets > 0) {
      chain.weights_at(chain.coordinates[frame], std::span(weights).subspan(frame * targets, targets));
    }
  }
  tinygltf::Node node;
  node.name = detail::valid_utf8(body.name);
  node.mesh = mesh;
  node.translation = tidy_all(std::span(translation).last(3));
  node.scale = tidy_all(std::span(scale).last(3));
  node.weights = tidy_all(std::span(weights).last(targets));
  const int index = add_node(std::move(node));
  add_channel(index, "translation", 3, translation);
  add_channel(index, "scale", 3, scale);
  add_channel(index, "weights", targets, weights);
}

Expected<std::string> GlbWriter::finish() {
  if (!animation_.channels.empty()) {
    animation_.name = "development";
    model_.animations.push_back(std::move(animation_));
  }
  const Error too_large{ErrorCode::kTooLarge, "glb", "must be at most 2 GiB: ask for fewer frames or less detail"};
  if (!buffer_.finish()) {
    return unexpected(too_large);
  }
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model_, stream, false, true)) {
    return unexpected(Error{ErrorCode::kIo, "glb", "could not be put together"});
  }
  std::string bytes = std::move(stream).str();
  if (bytes.size() > kMaxBytes) {
    return unexpected(too_large);
  }
  return bytes;
}

/// Bytes of the meshes and keys, at least; refuses before memory is taken for what cannot be written.
std::optional<Error> check_size(const Development& development, const detail::Timeline& timeline,
                                const std::vector<detail::MorphChain>& chains) {
  std::uint64_t total = 0;
  bool fits = true;
  const auto add = [&](std::uint64_t count, std::uint64_t each) {
    std::uint64_t product = 0;
    fits = fits && !__builtin_mul_overflow(count, each, &product) && !__builtin_add_overflow(total, product, &total) &&
           total <= kMaxBytes;
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
  std::vector<Pigments> pigment_sets;
  const auto use = [&](const Pigments& pigments) {
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
      use(pigments_of(templates[t]));
    }
  }

  GlbWriter writer(development, options, *timeline);
  writer.write_asset();
  writer.add_root();
  if (std::optional<Error> error = writer.add_materials(pigment_sets, progress)) {
    return unexpected(*error);
  }

  for (const detail::BodyTrack& body : timeline->bodies) {
    const detail::MorphChain chain = detail::body_chain(body, *timeline, options);
    const int mesh = writer.add_mesh(body.name, writer.material_of({body.pigment}).index, body.rest.triangles,
                                     body.rest.uvs, body_keys(body, chain), chain, true);
    writer.add_body(body, mesh, chain);
  }

  std::vector<KeyShapes> shapes(templates.size());
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
    const Pigments pigments = pigments_of(templates[t]);
    const WornMaterial& worn = writer.material_of(pigments);
    const std::string name =
        development.species().organs[organ.kind].name + " shape " + std::to_string(++variants[organ.kind]);
    mesh_of[t] = writer.add_mesh(name, worn.index, templates[t].triangles(), atlas_uvs(templates[t], pigments, worn),
                                 shapes[t], (*chains)[t], false);
    shapes[t] = {};
  }
  for (std::size_t row = 0; row < timeline->organs.size(); ++row) {
    const std::uint32_t t = development.organs()[timeline->organs[row].value - 1].template_index;
    // An organ without surface stays as an empty node, so that the tree of organs is whole; weights need a mesh.
    writer.add_organ(row, mesh_of[t], mesh_of[t] < 0 ? detail::MorphChain{} : (*chains)[t]);
  }
  if (!report(progress, "glb", 0.5)) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  return writer.finish();
}

}  // namespace anthesis
