// glTF 2.0 in its binary form, as the specification describes it: only what moves vertices. Everything is checked
// before it is used, since any bytes may come; numbers of the binary chunk are read where they are.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "anthesis/base/parallel.h"
#include "mesh_source.h"
#include "text.h"

namespace anthesis::detail {
namespace {

using nlohmann::json;

constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;
// A text of that size is a tree of several GB already.
constexpr std::size_t kJsonLimit = std::size_t{1} << 28;  // bytes
constexpr double kMillimetresPerMetre = 1000.0;

constexpr std::uint64_t kByte = 5121;
constexpr std::uint64_t kShort = 5123;
constexpr std::uint64_t kInt = 5125;
constexpr std::uint64_t kFloat = 5126;

/// Numbers in the binary chunk, all of which are within it.
struct Numbers {
  const char* data = nullptr;
  std::size_t count = 0;  ///< of elements
  std::size_t stride = 0;
  std::size_t width = 1;  ///< numbers in each element
  std::uint64_t component = kFloat;

  float real(std::size_t element, std::size_t k) const {
    float value = 0.0f;
    std::memcpy(&value, data + element * stride + 4 * k, 4);
    return value;
  }
  /// The elements' numbers as one row.
  double flat(std::size_t i) const { return real(i / width, i % width); }
  std::size_t flat_count() const { return count * width; }

  std::uint32_t whole(std::size_t element) const {
    std::uint32_t value = 0;  // the file is little-endian, as the machine
    std::memcpy(&value, data + element * stride, component == kByte ? 1 : component == kShort ? 2 : 4);
    return value;
  }
  Vec3 vector(std::size_t element) const { return {real(element, 0), real(element, 1), real(element, 2)}; }
};

/// v -> linear v + offset
struct Affine {
  std::array<double, 9> linear = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row
  Vec3 offset;

  Vec3 turned(Vec3 v) const {
    const auto& m = linear;
    return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
            m[6] * v.x + m[7] * v.y + m[8] * v.z};
  }
  Vec3 operator()(Vec3 v) const { return turned(v) + offset; }
};

Affine operator*(const Affine& a, const Affine& b) {
  Affine result;
  for (int column = 0; column < 3; ++column) {
    const Vec3 turned = a.turned({b.linear[column], b.linear[3 + column], b.linear[6 + column]});
    result.linear[column] = turned.x;
    result.linear[3 + column] = turned.y;
    result.linear[6 + column] = turned.z;
  }
  result.offset = a(b.offset);
  return result;
}

/// How one property of a node changes.
struct Channel {
  enum class Between { kLinear, kStep, kCubic };
  Numbers times;
  Numbers values;
  Between between = Between::kLinear;

  /// The property's `width` numbers at a time. At a key they are exactly the key's.
  void sample(double time, std::size_t width, bool rotation, std::vector<double>& result) const;
};

Quaternion quaternion(const double* xyzw) {
  return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

void Channel::sample(double time, std::size_t width, bool rotation, std::vector<double>& result) const {
  result.resize(width);
  // In a cubic channel each key has a tangent before and one after its value.
  const std::size_t row = between == Between::kCubic ? 3 * width : width;
  const std::size_t in_row = between == Between::kCubic ? width : 0;
  const auto take = [&](std::size_t key) {
    for (std::size_t k = 0; k < width; ++k) {
      result[k] = values.flat(key * row + in_row + k);
    }
  };
  // The first key later than `time`.
  std::size_t after = 0;
  for (std::size_t end = times.count; after < end;) {
    const std::size_t middle = after + (end - after) / 2;
    if (static_cast<double>(times.real(middle, 0)) <= time) {
      after = middle + 1;
    } else {
      end = middle;
    }
  }
  if (after == 0 || after == times.count) {
    return take(after == 0 ? 0 : times.count - 1);
  }
  const std::size_t before = after - 1;
  const double t0 = times.real(before, 0);
  const double span = times.real(after, 0) - t0;
  const double t = (time - t0) / span;
  if (t <= 0.0 || between == Between::kStep) {
    return take(before);
  }
  if (between == Between::kCubic) {
    const double t2 = t * t;
    const double t3 = t2 * t;
    for (std::size_t k = 0; k < width; ++k) {
      const double from = values.flat(before * row + width + k);
      const double leaving = span * values.flat(before * row + 2 * width + k);
      const double to = values.flat(after * row + width + k);
      const double arriving = span * values.flat(after * row + k);
      result[k] = (2.0 * t3 - 3.0 * t2 + 1.0) * from + (t3 - 2.0 * t2 + t) * leaving + (3.0 * t2 - 2.0 * t3) * to +
                  (t3 - t2) * arriving;
    }
    return;
  }
  if (rotation) {
    std::array<double, 8> ends = {};
    for (std::size_t k = 0; k < 4; ++k) {
      ends[k] = values.flat(before * row + k);
      ends[4 + k] = values.flat(after * row + k);
    }
    const Quaternion q = slerp(normalized(quaternion(ends.data())), normalized(quaternion(ends.data() + 4)), t);
    result = {q.x, q.y, q.z, q.w};
    return;
  }
  for (std::size_t k = 0; k < width; ++k) {
    result[k] = (1.0 - t) * values.flat(before * row + k) + t * values.flat(after * row + k);
  }
}

enum Property { kTranslation, kRotation, kScale, kWeights, kPropertyCount };
constexpr std::array<const char*, kPropertyCount> kPropertyNames = {"translation", "rotation", "scale", "weights"};
constexpr std::array<std::size_t, kWeights> kPropertyWidths = {3, 4, 3};

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

struct Primitive {
  Numbers positions;
  std::vector<Numbers> targets;
};

struct GltfMesh {
  std::vector<Primitive> primitives;
  std::vector<double> weights;      ///< as many as there are targets
  std::vector<Triangle> triangles;  ///< of all primitives, whose vertices follow each other
  std::size_t vertex_count = 0;
};

/// A node of the scene.
struct Node {
  std::uint32_t parent = kNone;  ///< comes before its children
  std::uint32_t mesh = kNone;
  std::uint32_t part = kNone;    ///< of a node with a mesh
  std::size_t first_vertex = 0;  ///< of its mesh
  bool has_matrix = false;
  Affine matrix;                                        ///< instead of the properties, if it has one
  std::array<std::vector<double>, kPropertyCount> own;  ///< where no channel says otherwise
};

class GlbMesh : public MeshSource {
 public:
  MeshPose pose(std::size_t frame) const override;

  std::string bytes;
  std::vector<GltfMesh> meshes;
  std::vector<Node> nodes;
  bool root_left_out = false;

  using Channels = std::vector<std::pair<std::array<std::uint32_t, 2>, Channel>>;  ///< of (node, property), ascending
  std::vector<Channels> animations;
  std::vector<std::uint32_t> animation_of_frame;  ///< kNone without animations
};

MeshPose GlbMesh::pose(std::size_t frame) const {
  MeshPose result;
  result.positions.resize(vertex_count);
  result.shown.assign(parts.size(), 1);
  const Channels* channels = animation_of_frame[frame] == kNone ? nullptr : &animations[animation_of_frame[frame]];
  const double time = times_s[frame];
  const auto property = [&](std::uint32_t node, Property which, std::vector<double>& value) {
    value = nodes[node].own[which];
    if (channels == nullptr) {
      return;
    }
    const std::array<std::uint32_t, 2> key = {node, static_cast<std::uint32_t>(which)};
    const auto found = std::lower_bound(channels->begin(), channels->end(), key,
                                        [](const auto& channel, const auto& wanted) { return channel.first < wanted; });
    if (found != channels->end() && found->first == key) {
      found->second.sample(time, value.size(), which == kRotation, value);
    }
  };

  std::vector<Affine> root_from_node(nodes.size());
  std::vector<double> value;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const Node& node = nodes[i];
    if (node.parent == kNone && root_left_out) {
      continue;
    }
    Affine& own = root_from_node[i];
    if (node.has_matrix) {
      own = node.matrix;
    } else {
      property(i, kRotation, value);
      const Quaternion rotation = normalized(quaternion(value.data()));
      const Vec3 x = rotate(rotation, {1, 0, 0});
      const Vec3 y = rotate(rotation, {0, 1, 0});
      const Vec3 z = rotate(rotation, {0, 0, 1});
      property(i, kScale, value);
      own.linear = {x.x * value[0], y.x * value[1], z.x * value[2], x.y * value[0], y.y * value[1],
                    z.y * value[2], x.z * value[0], y.z * value[1], z.z * value[2]};
      property(i, kTranslation, value);
      own.offset = {value[0], value[1], value[2]};
    }
    if (node.parent != kNone) {
      own = root_from_node[node.parent] * own;
    }
  }

  parallel_for(nodes.size(), [&](std::size_t i) {
    const Node& node = nodes[i];
    if (node.mesh == kNone) {
      return;
    }
    const Affine& place = root_from_node[i];
    result.shown[node.part] =
        std::any_of(place.linear.begin(), place.linear.end(), [](double k) { return k != 0.0; }) ? 1 : 0;
    std::vector<double> weights;
    property(static_cast<std::uint32_t>(i), kWeights, weights);
    Vec3* to = result.positions.data() + node.first_vertex;
    for (const Primitive& primitive : meshes[node.mesh].primitives) {
      for (std::size_t v = 0; v < primitive.positions.count; ++v) {
        Vec3 p = primitive.positions.vector(v);
        for (std::size_t k = 0; k < weights.size(); ++k) {
          if (weights[k] != 0.0 && primitive.targets[k].data != nullptr) {
            p += weights[k] * primitive.targets[k].vector(v);
          }
        }
        *to++ = place(p);
      }
    }
  });
  return result;
}

/// Reads one file. A function that returns false has said why in `error`.
class GlbReader {
 public:
  GlbReader(std::string_view file_name, GlbMesh& mesh) : file_name_(file_name), mesh_(mesh) {}

  bool read() { return read_chunks() && check_extensions() && read_scene() && read_animations() && place_frames(); }

  Error error;

 private:
  bool fail(const std::string& place, std::string message, ErrorCode code = ErrorCode::kParse) {
    error = {code, file_name_ + ": " + place + ':', std::move(message)};
    return false;
  }

  bool read_chunks();
  bool check_extensions();
  bool read_scene();
  bool read_node(std::size_t index, std::uint32_t parent, std::vector<std::uint32_t>& children);
  bool node_indices(const json& from, const std::string& place, std::vector<std::uint32_t>& result);
  bool read_transform(const json& from, const std::string& place, Node& node);
  bool read_mesh(std::size_t index, std::uint32_t& mesh);
  bool read_primitive(const json& from, const std::string& place, GltfMesh& mesh);
  bool add_triangles(const json& from, const std::string& place, std::size_t vertices, GltfMesh& mesh);
  bool read_animations();
  bool read_animation(const json& from, const std::string& place);
  bool place_frames();

  /// A list of the document, empty if it is missing.
  bool list(const json& object, const std::string& place, const char* key, const json*& result);
  /// An element of a list of the document.
  bool element(const char* key, std::uint64_t index, const json*& result);
  bool whole(const json& object, const std::string& place, const char* key, std::optional<std::uint64_t> otherwise,
             std::uint64_t& result);
  bool numbers(const json& object, const std::string& place, const char* key, std::size_t count,
               std::vector<double>& result);
  bool accessor(std::uint64_t index, std::string_view type, Numbers& result);
  bool finite(const Numbers& all, std::uint64_t index);

  std::string file_name_;
  GlbMesh& mesh_;
  json document_;
  std::string_view binary_;
  std::vector<std::uint32_t> mesh_of_;              ///< index in mesh_.meshes of a mesh of the document, or kNone
  std::vector<std::uint32_t> node_of_;              ///< the same of nodes
  std::set<std::uint64_t> found_finite_;            ///< accessors
  std::vector<std::vector<std::uint64_t>> inputs_;  ///< accessors of each animation's times
};

std::string at(const char* list, std::uint64_t index) {
  return std::string(list) + '[' + std::to_string(index) + ']';
}

bool GlbReader::read_chunks() {
  const std::string_view bytes = mesh_.bytes;
  const auto word = [bytes](std::size_t place) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + place, 4);
    return value;
  };
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunkHeader = 8;
  if (bytes.size() < kHeader + kChunkHeader) {
    return fail("header", "must be whole: the file has " + std::to_string(bytes.size()) + " bytes");
  }
  if (word(4) != 2) {
    return fail("header", "must be of glTF version 2, got " + std::to_string(word(4)));
  }
  if (word(8) != bytes.size()) {
    return fail("header", "must state the length of the file, " + std::to_string(bytes.size()) + " bytes, got " +
                              std::to_string(word(8)));
  }
  const std::size_t json_size = word(12);
  if (word(16) != kJsonChunk || json_size > bytes.size() - kHeader - kChunkHeader) {
    return fail("chunk 0", "must be JSON, within the file");
  }
  if (json_size > kJsonLimit) {
    return fail("chunk 0", "must have at most " + std::to_string(kJsonLimit) + " bytes", ErrorCode::kTooLarge);
  }
  const std::string_view text = bytes.substr(kHeader + kChunkHeader, json_size);
  const std::size_t next = kHeader + kChunkHeader + json_size;
  if (bytes.size() - next >= kChunkHeader && word(next + 4) == kBinaryChunk) {
    if (word(next) > bytes.size() - next - kChunkHeader) {
      return fail("chunk 1", "must be within the file");
    }
    binary_ = bytes.substr(next + kChunkHeader, word(next));
  }
  document_ = json::parse(text.begin(), text.end(), nullptr, false);
  if (!document_.is_object()) {
    return fail("chunk 0", "must be a JSON object");
  }
  return true;
}

bool GlbReader::check_extensions() {
  const json* required = nullptr;
  if (!list(document_, "", "extensionsRequired", required)) {
    return false;
  }
  for (const json& extension : *required) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : "?";
    constexpr std::array<std::string_view, 4> kLooksOnly = {"KHR_materials_", "KHR_texture_", "KHR_lights_",
                                                            "EXT_texture_"};
    if (std::none_of(kLooksOnly.begin(), kLooksOnly.end(),
                     [&name](std::string_view prefix) { return name.starts_with(prefix); })) {
      return fail("extensionsRequired", "must name no extension that changes the mesh, got " + valid_utf8(name));
    }
  }
  return true;
}

bool GlbReader::list(const json& object, const std::string& place, const char* key, const json*& result) {
  static const json kEmpty = json::array();
  const auto found = object.find(key);
  result = found == object.end() ? &kEmpty : &*found;
  return result->is_array() || fail(place.empty() ? key : place + '.' + key, "must be a list");
}

bool GlbReader::element(const char* key, std::uint64_t index, const json*& result) {
  const json* all = nullptr;
  if (!list(document_, "", key, all)) {
    return false;
  }
  if (index >= all->size()) {
    return fail(at(key, index), "must exist: there are " + std::to_string(all->size()));
  }
  result = &(*all)[index];
  return result->is_object() || fail(at(key, index), "must be an object");
}

bool GlbReader::whole(const json& object, const std::string& place, const char* key,
                      std::optional<std::uint64_t> otherwise, std::uint64_t& result) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40;  // so that sums and products of what is read do not overflow
  const auto found = object.find(key);
  if (found == object.end() && otherwise) {
    result = *otherwise;
    return true;
  }
  if (found == object.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > kMost) {
    return fail(place + '.' + key, "must be a whole number, 0 to 2^40");
  }
  result = found->get<std::uint64_t>();
  return true;
}

bool GlbReader::numbers(const json& object, const std::string& place, const char* key, std::size_t count,
                        std::vector<double>& result) {
  const auto found = object.find(key);
  if (found == object.end()) {
    return true;
  }
  const auto is_finite = [](const json& number) { return number.is_number() && std::isfinite(number.get<double>()); };
  if (!found->is_array() || found->size() != count || !std::all_of(found->begin(), found->end(), is_finite)) {
    return fail(place + '.' + key, "must be a list of " + std::to_string(count) + " finite numbers");
  }
  result = found->get<std::vector<double>>();
  return true;
}

bool GlbReader::accessor(std::uint64_t index, std::string_view type, Numbers& result) {
  const json* from = nullptr;
  const json* view = nullptr;
  if (!element("accessors", index, from)) {
    return false;
  }
  const std::string place = at("accessors", index);
  if (from->contains("sparse")) {
    return fail(place, "must not be sparse: that is not read here");
  }
  std::uint64_t view_index = 0;
  std::uint64_t count = 0;
  std::uint64_t offset = 0;
  std::uint64_t component = 0;
  if (!whole(*from, place, "bufferView", std::nullopt, view_index) ||
      !whole(*from, place, "count", std::nullopt, count) || !whole(*from, place, "byteOffset", 0, offset) ||
      !whole(*from, place, "componentType", std::nullopt, component) || !element("bufferViews", view_index, view)) {
    return false;
  }
  const auto given_type = from->find("type");
  if (given_type == from->end() || *given_type != std::string(type)) {
    return fail(place + ".type", "must be " + std::string(type) + " here");
  }
  const bool indices = type == "SCALAR" && result.component != kFloat;
  if (indices ? component != kByte && component != kShort && component != kInt : component != kFloat) {
    return fail(place + ".componentType", indices ? "must be 5121, 5123 or 5125 for indices"
                                                  : "must be 5126 (float) here: quantized numbers are not read, got " +
                                                        std::to_string(component));
  }
  result.component = component;
  result.width = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : 4;
  const std::size_t size = result.width * (component == kByte ? 1 : component == kShort ? 2 : 4);

  const std::string view_place = at("bufferViews", view_index);
  std::uint64_t buffer = 0;
  std::uint64_t view_offset = 0;
  std::uint64_t view_length = 0;
  std::uint64_t stride = 0;
  if (!whole(*view, view_place, "buffer", std::nullopt, buffer) ||
      !whole(*view, view_place, "byteOffset", 0, view_offset) ||
      !whole(*view, view_place, "byteLength", std::nullopt, view_length) ||
      !whole(*view, view_place, "byteStride", size, stride)) {
    return false;
  }
  const json* buffer_object = nullptr;
  if (!element("buffers", buffer, buffer_object)) {
    return false;
  }
  if (buffer != 0 || buffer_object->contains("uri")) {
    return fail(view_place + ".buffer", "must be the file's own binary chunk");
  }
  if (view_offset + view_length > binary_.size()) {
    return fail(view_place, "must be within the binary chunk of " + std::to_string(binary_.size()) + " bytes");
  }
  if (stride < size || stride > 252) {
    return fail(view_place + ".byteStride",
                "must be " + std::to_string(size) + " to 252, got " + std::to_string(stride));
  }
  if (count == 0 || count > binary_.size() || offset + (count - 1) * stride + size > view_length) {
    return fail(place, "must have elements, all within its view of " + std::to_string(view_length) + " bytes");
  }
  result.data = binary_.data() + view_offset + offset;
  result.count = count;
  result.stride = stride;
  return true;
}

bool GlbReader::finite(const Numbers& all, std::uint64_t index) {
  if (!found_finite_.insert(index).second) {
    return true;  // so that a file that uses one accessor a million times takes no longer than its size says
  }
  for (std::size_t i = 0; i < all.count; ++i) {
    for (std::size_t k = 0; k < all.width; ++k) {
      if (!std::isfinite(all.real(i, k))) {
        return fail(at("accessors", index),
                    "must have finite numbers, got " + to_text(all.real(i, k)) + " in element " + std::to_string(i));
      }
    }
  }
  return true;
}

bool GlbReader::read_scene() {
  std::uint64_t scene_index = 0;
  const json* scene = nullptr;
  const json* roots = nullptr;
  const json* nodes = nullptr;
  const json* meshes = nullptr;
  if (!whole(document_, "glTF", "scene", 0, scene_index) || !element("scenes", scene_index, scene) ||
      !list(*scene, at("scenes", scene_index), "nodes", roots) || !list(document_, "", "nodes", nodes) ||
      !list(document_, "", "meshes", meshes)) {
    return false;
  }
  node_of_.assign(nodes->size(), kNone);
  mesh_of_.assign(meshes->size(), kNone);
  mesh_.root_left_out = roots->size() == 1;

  // Depth first and in the order of the file: a stack, filled from the end.
  struct Waiting {
    std::uint32_t node;
    std::uint32_t parent;
  };
  std::vector<Waiting> waiting;
  std::vector<std::uint32_t> next;
  if (!node_indices(*roots, at("scenes", scene_index) + ".nodes", next)) {
    return false;
  }
  for (auto root = next.rbegin(); root != next.rend(); ++root) {
    waiting.push_back({*root, kNone});
  }
  while (!waiting.empty()) {
    const Waiting node = waiting.back();
    waiting.pop_back();
    next.clear();
    if (!read_node(node.node, node.parent, next)) {
      return false;
    }
    for (auto child = next.rbegin(); child != next.rend(); ++child) {
      waiting.push_back({*child, node_of_[node.node]});
    }
  }
  if (mesh_.triangles.empty()) {
    return fail(at("scenes", scene_index), "must show a mesh of triangles");
  }
  mesh_.mm_per_unit = kMillimetresPerMetre * Vec3{1.0, 1.0, 1.0};
  if (mesh_.root_left_out) {
    const Node& root = mesh_.nodes.front();
    if (root.has_matrix) {
      const auto& m = root.matrix.linear;
      mesh_.mm_per_unit = kMillimetresPerMetre * Vec3{length(Vec3{m[0], m[3], m[6]}), length(Vec3{m[1], m[4], m[7]}),
                                                      length(Vec3{m[2], m[5], m[8]})};
    } else {
      const std::vector<double>& scale = root.own[kScale];
      mesh_.mm_per_unit = kMillimetresPerMetre * Vec3{std::fabs(scale[0]), std::fabs(scale[1]), std::fabs(scale[2])};
    }
  }
  return true;
}

bool GlbReader::read_node(std::size_t index, std::uint32_t parent, std::vector<std::uint32_t>& children) {
  const json* from = nullptr;
  if (!element("nodes", index, from)) {
    return false;
  }
  const std::string place = at("nodes", index);
  if (node_of_[index] != kNone) {
    return fail(place, "must have one parent");
  }
  node_of_[index] = static_cast<std::uint32_t>(mesh_.nodes.size());
  if (from->contains("skin")) {
    return fail(place, "must have no skin: skins are not read here");
  }
  if (const auto extensions = from->find("extensions");
      extensions != from->end() && extensions->contains("EXT_mesh_gpu_instancing")) {
    return fail(place, "must not be instanced by EXT_mesh_gpu_instancing: that is not read here");
  }
  Node node;
  node.parent = parent;
  node.own = {std::vector<double>{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}, {}};
  if (!read_transform(*from, place, node)) {
    return false;
  }
  if (from->contains("mesh")) {
    std::uint64_t mesh_index = 0;
    if (!whole(*from, place, "mesh", std::nullopt, mesh_index) || !read_mesh(mesh_index, node.mesh)) {
      return false;
    }
    const GltfMesh& mesh = mesh_.meshes[node.mesh];
    node.own[kWeights] = mesh.weights;
    if (!numbers(*from, place, "weights", mesh.weights.size(), node.own[kWeights])) {
      return false;
    }
    if (mesh.vertex_count > kMeshVertexLimit - mesh_.vertex_count ||
        mesh.triangles.size() > kMeshTriangleLimit - mesh_.triangles.size()) {
      return fail(place,
                  "must be within the first " + std::to_string(kMeshVertexLimit) + " vertices and " +
                      std::to_string(kMeshTriangleLimit) + " triangles of the scene",
                  ErrorCode::kTooLarge);
    }
    node.part = static_cast<std::uint32_t>(mesh_.parts.size());
    const auto name = from->find("name");
    mesh_.parts.push_back(name != from->end() && name->is_string()
                              ? valid_utf8(one_line(name->get_ref<const std::string&>()))
                              : "node " + std::to_string(index));
    node.first_vertex = mesh_.vertex_count;
    mesh_.vertex_count += mesh.vertex_count;
    const auto first = static_cast<std::uint32_t>(node.first_vertex);
    for (const Triangle& triangle : mesh.triangles) {
      mesh_.triangles.push_back({first + triangle[0], first + triangle[1], first + triangle[2]});
    }
    mesh_.part_of_triangle.resize(mesh_.triangles.size(), node.part);
  }
  mesh_.nodes.push_back(std::move(node));

  const json* list_of_children = nullptr;
  return list(*from, place, "children", list_of_children) &&
         node_indices(*list_of_children, place + ".children", children);
}

bool GlbReader::node_indices(const json& from, const std::string& place, std::vector<std::uint32_t>& result) {
  for (const json& index : from) {
    if (!index.is_number_unsigned() || index.get<std::uint64_t>() >= node_of_.size()) {
      return fail(place, "must name nodes that exist: there are " + std::to_string(node_of_.size()));
    }
    result.push_back(index.get<std::uint32_t>());
  }
  return true;
}

bool GlbReader::read_transform(const json& from, const std::string& place, Node& node) {
  std::vector<double> matrix;
  if (!numbers(from, place, "matrix", 16, matrix)) {
    return false;
  }
  if (!matrix.empty()) {
    const auto& m = matrix;  // column by column
    if (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0) {
      return fail(place + ".matrix", "must have the last row 0, 0, 0, 1");
    }
    node.has_matrix = true;
    node.matrix = {{m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]}, {m[12], m[13], m[14]}};
  }
  for (std::size_t k = 0; k < kWeights; ++k) {
    if (!numbers(from, place, kPropertyNames[k], kPropertyWidths[k], node.own[k])) {
      return false;
    }
  }
  return true;
}

bool GlbReader::read_mesh(std::size_t index, std::uint32_t& mesh_index) {
  const json* from = nullptr;
  const json* primitives = nullptr;
  const std::string place = at("meshes", index);
  if (!element("meshes", index, from) || !list(*from, place, "primitives", primitives)) {
    return false;
  }
  if (mesh_of_[index] != kNone) {
    mesh_index = mesh_of_[index];
    return true;
  }
  GltfMesh mesh;
  for (std::size_t i = 0; i < primitives->size(); ++i) {
    const json& primitive = (*primitives)[i];
    const std::string primitive_place = place + '.' + at("primitives", i);
    if (!primitive.is_object()) {
      return fail(primitive_place, "must be an object");
    }
    if (!read_primitive(primitive, primitive_place, mesh)) {
      return false;
    }
  }
  const std::size_t targets = mesh.primitives.empty() ? 0 : mesh.primitives.front().targets.size();
  for (const Primitive& primitive : mesh.primitives) {
    if (primitive.targets.size() != targets) {
      return fail(place, "must have as many morph targets in each primitive");
    }
  }
  mesh.weights.assign(targets, 0.0);
  if (!numbers(*from, place, "weights", targets, mesh.weights)) {
    return false;
  }
  mesh_index = mesh_of_[index] = static_cast<std::uint32_t>(mesh_.meshes.size());
  mesh_.meshes.push_back(std::move(mesh));
  return true;
}

bool GlbReader::read_primitive(const json& from, const std::string& place, GltfMesh& mesh) {
  std::uint64_t mode = 0;
  if (!whole(from, place, "mode", 4, mode)) {
    return false;
  }
  if (mode < 4) {
    return true;  // points and lines have no surface
  }
  if (mode > 6) {
    return fail(place + ".mode", "must be 0 to 6, got " + std::to_string(mode));
  }
  if (const auto extensions = from.find("extensions");
      extensions != from.end() && extensions->contains("KHR_draco_mesh_compression")) {
    return fail(place, "must not be compressed by KHR_draco_mesh_compression: that is not read here");
  }
  const auto position_of = [this](const json& attributes, const std::string& where, std::uint64_t& index) {
    return attributes.is_object() ? whole(attributes, where, "POSITION", std::nullopt, index)
                                  : fail(where, "must be an object");
  };
  const auto attributes = from.find("attributes");
  std::uint64_t index = 0;
  Primitive primitive;
  if (!position_of(attributes == from.end() ? json() : *attributes, place + ".attributes", index) ||
      !accessor(index, "VEC3", primitive.positions) || !finite(primitive.positions, index)) {
    return false;
  }
  const json* targets = nullptr;
  if (!list(from, place, "targets", targets)) {
    return false;
  }
  for (std::size_t k = 0; k < targets->size(); ++k) {
    const json& target = (*targets)[k];
    const std::string target_place = place + '.' + at("targets", k);
    Numbers moves;
    if (target.is_object() && !target.contains("POSITION")) {
      primitive.targets.push_back(moves);  // moves normals only
      continue;
    }
    if (!position_of(target, target_place, index) || !accessor(index, "VEC3", moves) || !finite(moves, index)) {
      return false;
    }
    if (moves.count != primitive.positions.count) {
      return fail(target_place, "must move all " + std::to_string(primitive.positions.count) + " vertices, got " +
                                    std::to_string(moves.count));
    }
    primitive.targets.push_back(moves);
  }
  if (primitive.positions.count > kMeshVertexLimit - mesh.vertex_count) {
    return fail(place, "must be within the first " + std::to_string(kMeshVertexLimit) + " vertices",
                ErrorCode::kTooLarge);
  }
  if (!add_triangles(from, place, primitive.positions.count, mesh)) {
    return false;
  }
  mesh.vertex_count += primitive.positions.count;
  mesh.primitives.push_back(std::move(primitive));
  return true;
}

bool GlbReader::add_triangles(const json& from, const std::string& place, std::size_t vertices, GltfMesh& mesh) {
  std::optional<Numbers> indices;
  std::size_t count = vertices;
  if (from.contains("indices")) {
    std::uint64_t index = 0;
    indices.emplace();
    indices->component = kInt;  // whole numbers, please
    if (!whole(from, place, "indices", std::nullopt, index) || !accessor(index, "SCALAR", *indices)) {
      return false;
    }
    count = indices->count;
    for (std::size_t i = 0; i < count; ++i) {
      if (indices->whole(i) >= vertices) {
        return fail(at("accessors", index), "must name vertices below " + std::to_string(vertices) + ", got " +
                                                std::to_string(indices->whole(i)) + " in element " + std::to_string(i));
      }
    }
  }
  const std::uint64_t mode = from.value("mode", std::uint64_t{4});
  const std::size_t triangles = mode == 4 ? count / 3 : count < 3 ? 0 : count - 2;
  if (mode == 4 && count % 3 != 0) {
    return fail(place, "must have three vertices for each triangle, got " + std::to_string(count));
  }
  if (triangles > kMeshTriangleLimit - mesh.triangles.size()) {
    return fail(place, "must be within the first " + std::to_string(kMeshTriangleLimit) + " triangles",
                ErrorCode::kTooLarge);
  }
  const auto first = static_cast<std::uint32_t>(mesh.vertex_count);
  const auto vertex = [&](std::size_t i) {
    return first + (indices ? indices->whole(i) : static_cast<std::uint32_t>(i));
  };
  mesh.triangles.reserve(mesh.triangles.size() + triangles);
  for (std::size_t i = 0; i < triangles; ++i) {
    if (mode == 4) {
      mesh.triangles.push_back({vertex(3 * i), vertex(3 * i + 1), vertex(3 * i + 2)});
    } else if (mode == 5) {  // strip: every second one the other way round
      mesh.triangles.push_back({vertex(i), vertex(i + 1 + i % 2), vertex(i + 2 - i % 2)});
    } else {  // fan
      mesh.triangles.push_back({vertex(0), vertex(i + 1), vertex(i + 2)});
    }
  }
  return true;
}

bool GlbReader::read_animations() {
  const json* animations = nullptr;
  if (!list(document_, "", "animations", animations)) {
    return false;
  }
  for (std::size_t i = 0; i < animations->size(); ++i) {
    const std::string place = at("animations", i);
    if (!(*animations)[i].is_object()) {
      return fail(place, "must be an object");
    }
    if (!read_animation((*animations)[i], place)) {
      return false;
    }
  }
  return true;
}

bool GlbReader::read_animation(const json& from, const std::string& place) {
  const json* channels = nullptr;
  const json* samplers = nullptr;
  if (!list(from, place, "channels", channels) || !list(from, place, "samplers", samplers)) {
    return false;
  }
  GlbMesh::Channels result;
  std::set<std::uint64_t> inputs;
  for (std::size_t i = 0; i < channels->size(); ++i) {
    const json& channel = (*channels)[i];
    const std::string channel_place = place + '.' + at("channels", i);
    const auto target = channel.find("target");
    if (!channel.is_object() || target == channel.end() || !target->is_object()) {
      return fail(channel_place, "must have a target");
    }
    const std::string path = target->contains("path") && (*target)["path"].is_string()
                                 ? (*target)["path"].get<std::string>()
                                 : std::string();
    const auto property = std::find(kPropertyNames.begin(), kPropertyNames.end(), path) - kPropertyNames.begin();
    if (property == kPropertyCount) {
      return fail(channel_place + ".target.path", "must be translation, rotation, scale or weights");
    }
    if (!target->contains("node")) {
      continue;  // somebody else's extension says what moves
    }
    std::uint64_t node = 0;
    if (!whole(*target, channel_place + ".target", "node", std::nullopt, node)) {
      return false;
    }
    if (node >= node_of_.size()) {
      return fail(channel_place + ".target.node", "must exist: there are " + std::to_string(node_of_.size()));
    }
    if (node_of_[node] == kNone) {
      continue;  // not in the scene
    }
    const Node& moved = mesh_.nodes[node_of_[node]];
    if (moved.has_matrix && property != kWeights) {
      return fail(channel_place, "must not move a node that has a matrix");
    }
    std::uint64_t sampler_index = 0;
    if (!whole(channel, channel_place, "sampler", std::nullopt, sampler_index)) {
      return false;
    }
    if (sampler_index >= samplers->size() || !(*samplers)[sampler_index].is_object()) {
      return fail(channel_place + ".sampler", "must exist: there are " + std::to_string(samplers->size()));
    }
    const json& sampler = (*samplers)[sampler_index];
    const std::string sampler_place = place + '.' + at("samplers", sampler_index);
    Channel read;
    const auto interpolation = sampler.find("interpolation");
    if (interpolation != sampler.end()) {
      if (*interpolation == "STEP") {
        read.between = Channel::Between::kStep;
      } else if (*interpolation == "CUBICSPLINE") {
        read.between = Channel::Between::kCubic;
      } else if (*interpolation != "LINEAR") {
        return fail(sampler_place + ".interpolation", "must be LINEAR, STEP or CUBICSPLINE");
      }
    }
    std::uint64_t input = 0;
    std::uint64_t output = 0;
    if (!whole(sampler, sampler_place, "input", std::nullopt, input) ||
        !whole(sampler, sampler_place, "output", std::nullopt, output) || !accessor(input, "SCALAR", read.times) ||
        !accessor(output,
                  property == kWeights    ? "SCALAR"
                  : property == kRotation ? "VEC4"
                                          : "VEC3",
                  read.values)) {
      return false;
    }
    if (inputs.insert(input).second) {
      if (!finite(read.times, input)) {
        return false;
      }
      for (std::size_t k = 1; k < read.times.count; ++k) {
        if (!(read.times.real(k, 0) > read.times.real(k - 1, 0))) {
          return fail(at("accessors", input), "must ascend, as the times of an animation do");
        }
      }
    }
    const std::size_t width = moved.own[static_cast<std::size_t>(property)].size();
    const std::size_t rows = read.between == Channel::Between::kCubic ? 3 : 1;
    if (read.values.flat_count() != read.times.count * rows * width) {
      return fail(sampler_place, "must have " + std::to_string(rows * width) + " numbers for each of the " +
                                     std::to_string(read.times.count) + " times, got " +
                                     std::to_string(read.values.flat_count()));
    }
    if (!finite(read.values, output)) {
      return false;
    }
    result.push_back({{node_of_[node], static_cast<std::uint32_t>(property)}, read});
  }
  if (result.empty()) {
    return true;
  }
  std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 1; i < result.size(); ++i) {
    if (result[i].first == result[i - 1].first) {
      return fail(place, "must move each property of a node once");
    }
  }
  mesh_.animations.push_back(std::move(result));
  inputs_.emplace_back(inputs.begin(), inputs.end());
  return true;
}

bool GlbReader::place_frames() {
  mesh_.animation_of_frame = {kNone};
  if (mesh_.animations.empty()) {
    return true;
  }
  mesh_.times_s.clear();
  mesh_.animation_of_frame.clear();
  for (std::uint32_t i = 0; i < mesh_.animations.size(); ++i) {
    std::set<double> times;
    for (const std::uint64_t input : inputs_[i]) {
      Numbers keys;
      if (!accessor(input, "SCALAR", keys)) {
        return false;
      }
      for (std::size_t k = 0; k < keys.count; ++k) {
        times.insert(keys.real(k, 0));
        if (times.size() + mesh_.times_s.size() > kMeshFrameLimit) {
          return fail(at("animations", i), "must be within the first " + std::to_string(kMeshFrameLimit) + " key times",
                      ErrorCode::kTooLarge);
        }
      }
    }
    mesh_.times_s.insert(mesh_.times_s.end(), times.begin(), times.end());
    mesh_.animation_of_frame.resize(mesh_.times_s.size(), i);
  }
  return true;
}

}  // namespace

Expected<std::unique_ptr<const MeshSource>> read_glb(std::string bytes, std::string_view file_name) {
  auto mesh = std::make_unique<GlbMesh>();
  mesh->bytes = std::move(bytes);
  GlbReader reader(file_name, *mesh);
  if (!reader.read()) {
    return unexpected(reader.error);
  }
  return mesh;
}

}  // namespace anthesis::detail
