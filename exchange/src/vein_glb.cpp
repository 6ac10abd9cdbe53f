#include "anthesis/exchange/vein_glb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"
#include "anthesis/corolla/pigment.h"
#include "glb_writer.h"
#include "gltf_buffer.h"
#include "provenance.h"
#include "text.h"

namespace anthesis {
namespace {

using tinygltf::Value;

constexpr std::size_t kMaxFrames = 2000;
constexpr double kMaxDuration_s = 86400.0;
constexpr double kMetresPerUnit = 0.001;
constexpr double kRoughness = 0.5;
constexpr std::array<double, 3> kReceptacleColour = {0.25, 0.45, 0.12};  // linear; the light green of stems
constexpr std::array<VeinKind, 3> kKinds = {VeinKind::kAbaxial, VeinKind::kFloret, VeinKind::kAdaxial};

Error too_large() {
  return {ErrorCode::kTooLarge, "glb", "must be at most 2 GiB: ask for fewer frames or fewer sides"};
}

std::optional<Error> check_outline(std::span<const Vec2> outline) {
  for (const Vec2 point : outline) {
    if (!(std::isfinite(point.x) && std::isfinite(point.y) && point.x >= 0.0)) {
      return invalid_parameter("outline", "must be finite with radii >= 0", std::isfinite(point.x) ? point.x : point.y);
    }
  }
  return std::nullopt;
}

/// What the outline sweeps when it turns about the axis. Normals look outwards.
Mesh revolved(std::span<const Vec2> outline, int sides) {
  std::vector<Vec2> points(outline.begin(), outline.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  Mesh mesh;
  if (points.size() < 2) {
    return mesh;
  }
  std::vector<std::uint32_t> first;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 in = i == 0 ? Vec2{} : normalized(points[i] - points[i - 1]);
    const Vec2 out = i + 1 == points.size() ? Vec2{} : normalized(points[i + 1] - points[i]);
    const Vec2 sum = in + out;
    const Vec2 along = length(sum) > 1e-9 ? normalized(sum) : in;
    Vec2 normal{-along.y, along.x};
    first.push_back(static_cast<std::uint32_t>(mesh.positions_mm.size()));
    if (points[i].x == 0.0) {  // on the axis, one vertex
      mesh.positions_mm.push_back({0.0, 0.0, points[i].y});
      mesh.normals.push_back({0.0, 0.0, i == 0 ? 1.0 : -1.0});
      continue;
    }
    for (int j = 0; j < sides; ++j) {
      const math::SinCos angle = math::sin_cos(math::kTurnRad * j / sides);
      mesh.positions_mm.push_back({points[i].x * angle.cos, points[i].x * angle.sin, points[i].y});
      mesh.normals.push_back({normal.x * angle.cos, normal.x * angle.sin, normal.y});
    }
  }
  const auto around = static_cast<std::uint32_t>(sides);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const bool from_axis = points[i].x == 0.0;
    const bool to_axis = points[i + 1].x == 0.0;
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t next = (j + 1) % around;
      const std::uint32_t a = first[i] + (from_axis ? 0 : j);
      const std::uint32_t b = first[i] + (from_axis ? 0 : next);
      const std::uint32_t c = first[i + 1] + (to_axis ? 0 : j);
      const std::uint32_t d = first[i + 1] + (to_axis ? 0 : next);
      if (!to_axis) {
        mesh.triangles.push_back({a, c, d});
      }
      if (!from_axis) {
        mesh.triangles.push_back({a, d, b});
      }
    }
  }
  return mesh;
}

}  // namespace

std::optional<Error> check(const VeinGlbParams& params) {
  if (std::optional<Error> error = check(params.tubes)) {
    return error;
  }
  if (!(params.duration_s > 0.0 && params.duration_s <= kMaxDuration_s)) {
    return invalid_parameter("duration_s", "must be > 0 and at most 86400", params.duration_s);
  }
  if (!(params.receptacle_alpha >= 0.0 && params.receptacle_alpha <= 1.0)) {
    return invalid_parameter("receptacle_alpha", "must be between 0 and 1", params.receptacle_alpha);
  }
  if (params.receptacle_sides < 3 || params.receptacle_sides > 1024) {
    return invalid_parameter("receptacle_sides", "must be between 3 and 1024", params.receptacle_sides);
  }
  return std::nullopt;
}

struct VeinGlb::State {
  State(const VeinGlbParams& given, MadeFrom lines) : params(given), made_from(std::move(lines)), buffer(model) {
    tinygltf::Node root;
    root.name = "head";
    // +z to +y: a quarter turn about x, clockwise seen from +x.
    const double half = detail::tidy(static_cast<float>(std::sqrt(0.5)));
    root.rotation = {-half, 0.0, 0.0, half};
    root.scale = std::vector<double>(3, kMetresPerUnit);
    model.nodes.push_back(std::move(root));
  }

  int add_node(tinygltf::Node node, int parent) {
    const int index = static_cast<int>(model.nodes.size());
    model.nodes.push_back(std::move(node));
    model.nodes[static_cast<std::size_t>(parent)].children.push_back(index);
    return index;
  }

  /// The material of a kind, or of the receptacle (kKinds.size()), made when first asked for.
  int material(std::size_t which) {
    if (materials[which] >= 0) {
      return materials[which];
    }
    tinygltf::Material material;
    tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
    pbr.metallicFactor = 0.0;
    pbr.roughnessFactor = kRoughness;
    if (which < kKinds.size()) {
      material.name = vein_kind_name(kKinds[which]);
      const std::array<std::uint8_t, 3> colour = vein_colour(kKinds[which]);
      for (std::size_t c = 0; c < 3; ++c) {
        pbr.baseColorFactor[c] = detail::tidy(static_cast<float>(linear_from_srgb(colour[c] / 255.0)));
      }
    } else {
      material.name = "receptacle";
      material.alphaMode = "BLEND";
      material.doubleSided = true;
      pbr.baseColorFactor = {kReceptacleColour[0], kReceptacleColour[1], kReceptacleColour[2],
                             detail::tidy(static_cast<float>(params.receptacle_alpha))};
    }
    materials[which] = static_cast<int>(model.materials.size());
    model.materials.push_back(std::move(material));
    return materials[which];
  }

  tinygltf::Primitive primitive(std::span<const float> positions, std::span<const float> normals,
                                std::span<const std::uint32_t> indices, std::size_t material_of) {
    bytes += 2 * positions.size_bytes() + indices.size_bytes() / (positions.size() / 3 <= 0xffff ? 2 : 1);
    tinygltf::Primitive result;
    result.mode = TINYGLTF_MODE_TRIANGLES;
    result.material = material(material_of);
    result.indices = buffer.add_indices(indices, static_cast<std::uint32_t>(positions.size() / 3));
    result.attributes["POSITION"] = buffer.add_vectors3(positions, true);
    result.attributes["NORMAL"] = buffer.add_vectors3(normals, false);
    return result;
  }

  /// The triangles that `belongs` takes, with the vertices they use.
  template <class Belongs>
  void add_primitive(tinygltf::Mesh& to, const Mesh& mesh, std::size_t material_of, const Belongs& belongs) {
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> place(mesh.positions_mm.size(), kNone);
    std::vector<float> positions;
    std::vector<float> normals;
    std::vector<std::uint32_t> indices;
    for (const Triangle& triangle : mesh.triangles) {
      if (!belongs(triangle)) {
        continue;
      }
      for (const std::uint32_t corner : triangle) {
        if (place[corner] == kNone) {
          place[corner] = static_cast<std::uint32_t>(positions.size() / 3);
          detail::append(positions, mesh.positions_mm[corner]);
          detail::append(normals, detail::unit(mesh.normals[corner]));
        }
        indices.push_back(place[corner]);
      }
    }
    if (!indices.empty()) {
      to.primitives.push_back(primitive(positions, normals, indices, material_of));
    }
  }

  /// A node of the mesh, unless it has no surface.
  void add_mesh(tinygltf::Mesh mesh, const std::string& name, int parent) {
    if (mesh.primitives.empty()) {
      return;
    }
    tinygltf::Node node;
    node.name = name;
    node.mesh = static_cast<int>(model.meshes.size());
    mesh.name = name;
    model.meshes.push_back(std::move(mesh));
    add_node(std::move(node), parent);
  }

  std::optional<Error> animate();

  VeinGlbParams params;
  MadeFrom made_from;
  std::vector<double> times;
  std::vector<int> frames;  ///< node of each
  std::array<int, kKinds.size() + 1> materials = {-1, -1, -1, -1};
  std::uint64_t bytes = 0;  ///< of meshes so far
  tinygltf::Model model;
  detail::GltfBuffer buffer;
};

VeinGlb::VeinGlb(const VeinGlbParams& params, MadeFrom made_from)
    : state_(std::make_unique<State>(params, std::move(made_from))) {
  ANTHESIS_ASSERT(!check(params));
}

VeinGlb::~VeinGlb() = default;
VeinGlb::VeinGlb(VeinGlb&&) noexcept = default;
VeinGlb& VeinGlb::operator=(VeinGlb&&) noexcept = default;

std::optional<Error> VeinGlb::add(const VeinFrame& frame) {
  ANTHESIS_ASSERT(frame.veins != nullptr);
  State& state = *state_;
  if (!(frame.time >= 0.0 && frame.time <= 1.0)) {
    return invalid_parameter("time", "must be between 0 and 1", frame.time);
  }
  if (!state.times.empty() && !(frame.time > state.times.back())) {
    return invalid_parameter("time", "must be later than the frame before", frame.time);
  }
  if (state.times.size() == kMaxFrames) {
    return Error{ErrorCode::kTooLarge, "frames", "must be at most 2000"};
  }
  if (std::optional<Error> error = check_outline(frame.outline)) {
    return error;
  }
  const Expected<VeinTubes> tubes = vein_tubes(*frame.veins, state.params.tubes);
  if (!tubes) {
    return tubes.error();
  }
  if (state.bytes + 48 * std::uint64_t{tubes->mesh.positions_mm.size()} > detail::kMaxGlbBytes) {
    return too_large();
  }

  tinygltf::Node node;
  node.name = detail::shape_name("frame", frame.time);
  node.extras = Value(Value::Object{{"time", Value(frame.time)}});
  const int parent = state.add_node(std::move(node), 0);
  tinygltf::Mesh veins;
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    state.add_primitive(veins, tubes->mesh, kind,
                        [&](const Triangle& triangle) { return tubes->kind[triangle[0]] == kKinds[kind]; });
  }
  state.add_mesh(std::move(veins), detail::shape_name("veins", frame.time), parent);
  if (state.params.receptacle_alpha > 0.0) {
    tinygltf::Mesh receptacle;
    state.add_primitive(receptacle, revolved(frame.outline, state.params.receptacle_sides), kKinds.size(),
                        [](const Triangle&) { return true; });
    state.add_mesh(std::move(receptacle), detail::shape_name("receptacle", frame.time), parent);
  }
  state.times.push_back(frame.time);
  state.frames.push_back(parent);
  return std::nullopt;
}

/// Keys at the start of each frame and at the end, which all channels share.
std::optional<Error> VeinGlb::State::animate() {
  const std::size_t count = times.size();
  std::vector<double> starts = times;
  starts.push_back(times.back() + (times.back() - times.front()) / static_cast<double>(count - 1));
  std::vector<float> seconds;
  for (const double start : detail::key_seconds(starts, params.duration_s)) {
    seconds.push_back(static_cast<float>(start));
  }
  for (std::size_t frame = 1; frame < count; ++frame) {
    if (!(seconds[frame - 1] < seconds[frame] && seconds[frame] < seconds[frame + 1])) {
      return invalid_parameter("time", "must lie farther from that before than single precision tells", times[frame]);
    }
  }
  const int input = buffer.add_times(seconds);

  // 0 0 0 1 0 0 0: the scales of each frame but the last are a stretch of these.
  std::vector<float> scales(3 * (2 * count + 1), 0.0f);
  std::fill_n(scales.begin() + static_cast<std::ptrdiff_t>(3 * count), 3, 1.0f);
  const int first = buffer.add_keys(scales, TINYGLTF_TYPE_VEC3);
  const tinygltf::Accessor whole = model.accessors[static_cast<std::size_t>(first)];
  std::vector<float> last_scales(3 * (count + 1), 0.0f);
  std::fill(last_scales.end() - 6, last_scales.end(), 1.0f);

  tinygltf::Animation animation;
  animation.name = "development";
  for (std::size_t frame = 0; frame < count; ++frame) {
    int output = first;
    if (frame + 1 == count) {
      output = buffer.add_keys(last_scales, TINYGLTF_TYPE_VEC3);
    } else {
      tinygltf::Accessor stretch = whole;
      stretch.byteOffset += 12 * (count - frame);
      stretch.count = count + 1;
      if (frame == 0) {
        model.accessors[static_cast<std::size_t>(first)] = stretch;
      } else {
        output = static_cast<int>(model.accessors.size());
        model.accessors.push_back(stretch);
      }
    }
    tinygltf::AnimationSampler sampler;
    sampler.input = input;
    sampler.output = output;
    sampler.interpolation = "STEP";
    animation.samplers.push_back(std::move(sampler));
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(frame);
    channel.target_node = frames[frame];
    channel.target_path = "scale";
    animation.channels.push_back(std::move(channel));
    if (frame + 1 < count) {
      model.nodes[static_cast<std::size_t>(frames[frame])].scale = {0.0, 0.0, 0.0};
    }
  }
  model.animations.push_back(std::move(animation));
  return std::nullopt;
}

Expected<std::string> VeinGlb::finish() {
  State& state = *state_;
  tinygltf::Model& model = state.model;
  if (state.times.empty()) {
    return unexpected(invalid_parameter("frames", "must be at least 1", 0));
  }
  if (state.times.size() == 1) {
    for (tinygltf::Node& node : model.nodes) {
      if (node.mesh >= 0) {
        tinygltf::Mesh& mesh = model.meshes[static_cast<std::size_t>(node.mesh)];
        node.name = node.name.substr(0, node.name.find(' '));
        mesh.name = node.name;
      }
    }
  } else if (std::optional<Error> error = state.animate()) {
    return unexpected(*error);
  }
  tinygltf::Scene scene;
  scene.name = model.nodes.front().name;
  scene.nodes = {0};
  model.scenes.push_back(std::move(scene));
  model.defaultScene = 0;
  model.asset.version = "2.0";
  model.asset.generator = detail::generator();
  Value::Object extras;
  for (const auto& [key, value] : state.made_from) {
    extras[detail::valid_utf8(key)] = Value(detail::valid_utf8(value));
  }
  if (!extras.empty()) {
    model.asset.extras = Value(std::move(extras));
  }
  if (!state.buffer.finish()) {
    return unexpected(too_large());
  }
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, stream, false, true)) {
    return unexpected(Error{ErrorCode::kIo, "glb", "could not be put together"});
  }
  model.buffers.clear();
  std::string bytes = std::move(stream).str();
  if (bytes.size() > detail::kMaxGlbBytes) {
    return unexpected(too_large());
  }
  return bytes;
}

Expected<std::string> veins_glb(const VeinFrame& frame, const VeinGlbParams& params, const MadeFrom& made_from) {
  if (std::optional<Error> error = check(params)) {
    return unexpected(*error);
  }
  VeinGlb glb(params, made_from);
  if (std::optional<Error> error = glb.add(frame)) {
    return unexpected(*error);
  }
  return glb.finish();
}

}  // namespace anthesis
