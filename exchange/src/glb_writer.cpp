#include "glb_writer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "flat_plant.h"
#include "provenance.h"
#include "text.h"

namespace anthesis::detail {
namespace {

using tinygltf::Value;

constexpr double kMetresPerMillimetre = 0.001;

// A key that lies on the line between its neighbours, to this share of the channel's largest value, is not written.
constexpr float kRedundant = 1e-6f;

}  // namespace

double tidy(float value) {
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof(digits), value);
  double result = 0.0;
  std::from_chars(digits, end.ptr, result);
  return result;
}

std::string shape_name(const char* unit, double value) {
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof(digits), value, std::chars_format::fixed, 3);
  return std::string(unit) + " " + std::string(digits, end.ptr);
}

std::vector<double> key_seconds(std::span<const double> times, double duration_s) {
  std::vector<double> seconds;
  const double whole = times.back() - times.front();
  for (const double time : times) {
    seconds.push_back(whole > 0.0 ? duration_s * ((time - times.front()) / whole) : 0.0);
  }
  return seconds;
}

void append(std::vector<float>& to, Vec3 v) {
  to.push_back(static_cast<float>(v.x));
  to.push_back(static_cast<float>(v.y));
  to.push_back(static_cast<float>(v.z));
}

Vec3 unit(Vec3 v) {
  const double size = length(v);
  return std::isfinite(size) && size > 0.0 ? v / size : Vec3{0.0, 0.0, 1.0};
}

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

std::vector<Vec2> atlas_uvs(const OrganTemplate& shape, const Pigments& pigments, const WornMaterial& worn) {
  std::vector<Vec2> uvs(shape.uvs().begin(), shape.uvs().end());
  for (const TemplateGroup& group : shape.groups()) {
    const auto pigment = std::find(pigments.begin(), pigments.end(), group.pigment);
    const AtlasTile& tile = worn.tiles[static_cast<std::size_t>(pigment - pigments.begin())];
    for (Vec2& uv : std::span(uvs).subspan(group.first_vertex, group.vertex_count)) {
      uv.x = tile.offset + tile.scale * uv.x;
    }
  }
  return uvs;
}

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

void GlbWriter::write_asset(std::optional<double> still_time, bool resolved) {
  model_.asset.version = "2.0";
  model_.asset.generator = generator();
  Value::Object extras;
  for (const auto& [key, value] : provenance(development_, resolved)) {
    extras[key] = Value(valid_utf8(value));
  }
  if (still_time) {
    extras["time"] = Value(*still_time);
  }
  model_.asset.extras = Value(extras);
}

void GlbWriter::add_root() {
  tinygltf::Node root;
  root.name = valid_utf8(development_.species().name);
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
std::optional<Error> GlbWriter::add_materials(const std::vector<Pigments>& sets, bool diffuse_transmission,
                                              const Progress& progress) {
  struct Baked {
    std::vector<const Pigment*> pigments;
    std::optional<Colour> plain;
    Expected<Atlas> atlas;
  };
  std::vector<Baked> baked(sets.size());
  const bool done = parallel_for(
      sets.size(),
      [&](std::size_t i) {
        for (const std::string& name : sets[i]) {
          baked[i].pigments.push_back(&pigment_named(development_.species(), name));
        }
        if (sets[i].size() == 1) {
          baked[i].plain = plain_colour(*baked[i].pigments.front());
        }
        if (!baked[i].plain) {
          baked[i].atlas = bake_atlas(baked[i].pigments);
        }
      },
      progress, "textures");
  if (!done) {
    return Error{ErrorCode::kCancelled, "", "cancelled"};
  }

  bool sheen = false;
  bool transmission = false;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    // What has no texture here is the first pigment's: the corolla's, or what else the species file names first.
    const Pigment& pigment = *baked[i].pigments.front();
    WornMaterial& worn = materials_[sets[i]];
    worn.index = static_cast<int>(model_.materials.size());
    tinygltf::Material material;
    for (const Pigment* each : baked[i].pigments) {
      material.name += (material.name.empty() ? "" : " + ") + valid_utf8(each->name);
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
    if (diffuse_transmission && pigment.translucency > 0.0) {
      transmission = true;
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
  if (transmission) {
    model_.extensionsUsed.push_back("KHR_materials_diffuse_transmission");
  }
  return std::nullopt;
}

int GlbWriter::add_mesh(const std::string& name, MeshSurface& surface, const KeyShapes& shapes, Value extras) {
  if (surface.triangles.empty()) {
    return -1;
  }
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = surface.material;
  if (surface.indices_accessor < 0) {
    std::vector<std::uint32_t> indices;
    indices.reserve(3 * surface.triangles.size());
    for (const Triangle& triangle : surface.triangles) {
      indices.insert(indices.end(), triangle.begin(), triangle.end());
    }
    surface.indices_accessor =
        buffer_.add_indices(indices, static_cast<std::uint32_t>(shapes.positions.front().size() / 3));
  }
  primitive.indices = surface.indices_accessor;
  primitive.attributes["POSITION"] = buffer_.add_vectors3(shapes.positions.front(), true);
  const bool has_normals = !shapes.normals.front().empty();
  if (has_normals) {
    primitive.attributes["NORMAL"] = buffer_.add_vectors3(shapes.normals.front(), false);
  }
  if (!surface.uvs.empty()) {
    if (surface.uvs_accessor < 0) {
      std::vector<float> coordinates;
      coordinates.reserve(2 * surface.uvs.size());
      for (const Vec2 uv : surface.uvs) {
        coordinates.push_back(static_cast<float>(uv.x));
        coordinates.push_back(static_cast<float>(uv.y));
      }
      surface.uvs_accessor = buffer_.add_vectors2(coordinates);
    }
    primitive.attributes["TEXCOORD_0"] = surface.uvs_accessor;
  }
  for (std::size_t key = 1; key < shapes.positions.size(); ++key) {
    std::map<std::string, int>& target = primitive.targets.emplace_back();
    target["POSITION"] = buffer_.add_vectors3(shapes.positions[key], true);
    if (has_normals) {
      target["NORMAL"] = buffer_.add_vectors3(shapes.normals[key], false);
    }
  }
  tinygltf::Mesh mesh;
  mesh.name = valid_utf8(name);
  mesh.primitives.push_back(std::move(primitive));
  mesh.extras = std::move(extras);
  model_.meshes.push_back(std::move(mesh));
  return static_cast<int>(model_.meshes.size()) - 1;
}

tinygltf::Node GlbWriter::organ_node(OrganId id, double last_time) const {
  const Organ& organ = development_.organs()[id.value - 1];
  tinygltf::Node node;
  node.name = valid_utf8(organ_name(development_, id));
  node.extras =
      Value(Value::Object{{"organ", Value(static_cast<int>(id.value))},
                          {"kind", Value(valid_utf8(development_.species().organs[organ.kind].name))},
                          {"parent", Value(static_cast<int>(organ.parent.value))},
                          {"birth", Value(tidy(static_cast<float>(organ.birth)))},
                          {"age", Value(tidy(static_cast<float>(last_time - organ.birth)))},
                          {"divergence_deg", Value(tidy(static_cast<float>(math::degrees(organ.divergence_rad))))}});
  return node;
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
  add_channel_of(node, path, add_sampler(path, kept, output));
}

void GlbWriter::add_shared_channel(int node, const char* path, const std::vector<std::uint16_t>& kept,
                                   const std::vector<float>& output) {
  const auto [place, is_new] = shared_samplers_.try_emplace({path, kept, output}, -1);
  if (is_new) {
    place->second = add_sampler(path, kept, output);
  }
  add_channel_of(node, path, place->second);
}

int GlbWriter::add_sampler(const char* path, const std::vector<std::uint16_t>& kept, const std::vector<float>& output) {
  const std::string_view name = path;
  const int type = name == "rotation"  ? TINYGLTF_TYPE_VEC4
                   : name == "weights" ? TINYGLTF_TYPE_SCALAR
                                       : TINYGLTF_TYPE_VEC3;
  tinygltf::AnimationSampler sampler;
  sampler.input = times_accessor(kept);
  sampler.output = buffer_.add_keys(output, type);
  sampler.interpolation = "LINEAR";
  animation_.samplers.push_back(std::move(sampler));
  return static_cast<int>(animation_.samplers.size()) - 1;
}

void GlbWriter::add_channel_of(int node, const char* path, int sampler) {
  tinygltf::AnimationChannel channel;
  channel.sampler = sampler;
  channel.target_node = node;
  channel.target_path = path;
  animation_.channels.push_back(std::move(channel));
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
  if (bytes.size() > kMaxGlbBytes) {
    return unexpected(too_large);
  }
  return bytes;
}

}  // namespace anthesis::detail
