#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "anthesis/base/progress.h"
#include "anthesis/exchange/glb.h"
#include "anthesis/inflorescence/development.h"
#include "gltf_buffer.h"
#include "texture.h"

namespace anthesis::detail {

/// The most a GLB may have: its lengths are 32 bits, and many readers take them as signed.
inline constexpr std::uint64_t kMaxGlbBytes = 0x7fffffff;

/// The double whose shortest decimal text is that of the float: 0.1 and not 0.10000000149011612, which reads back as
/// the same float. Halves the text of the nodes.
double tidy(float value);

template <class Floats>
std::vector<double> tidy_all(const Floats& values) {
  std::vector<double> result;
  for (const float value : values) {
    result.push_back(tidy(value));
  }
  return result;
}

/// "stage 0.250": the name of a key shape, as Blender and three.js show it.
std::string shape_name(const char* unit, double value);

/// Where the keys of developmental `times` (at least one) lie in an animation: from 0 to `duration_s`, in proportion.
std::vector<double> key_seconds(std::span<const double> times, double duration_s);

void append(std::vector<float>& to, Vec3 v);

/// A unit vector in single precision; a vector without direction becomes +z.
Vec3 unit(Vec3 v);

/// The pigments of a template, each once, in the order of its groups.
using Pigments = std::vector<std::string>;

Pigments pigments_of(const OrganTemplate& shape);

/// A material, and where each of its pigments lies in its texture.
struct WornMaterial {
  int index = -1;
  std::vector<AtlasTile> tiles;
};

/// Texture coordinates of a template in the texture of its material.
std::vector<Vec2> atlas_uvs(const OrganTemplate& shape, const Pigments& pigments, const WornMaterial& worn);

/// Positions and normals of a moving shape at its keys, in single precision: key 0 as it is, the others as differences.
struct KeyShapes {
  std::vector<std::vector<float>> positions;
  std::vector<std::vector<float>> normals;
};

/// The next key, from the positions and normals of the shape there. Rounded first and subtracted then, so that base +
/// difference rounds to the key.
void append_key(KeyShapes& shapes, std::span<const Vec3> positions_mm, std::span<const Vec3> normals);

/// What all meshes of one shape have in common. Indices and texture coordinates are written with the first of them.
struct MeshSurface {
  int material = -1;
  std::span<const Triangle> triangles;
  std::vector<Vec2> uvs;
  int indices_accessor = -1;  ///< -1: not yet written
  int uvs_accessor = -1;
};

/// Writes one file: holds the model while its meshes, nodes and animation come in.
class GlbWriter {
 public:
  /// `seconds`: of the frames.
  GlbWriter(const Development& development, const std::vector<double>& seconds)
      : development_(development), seconds_(seconds.begin(), seconds.end()), buffer_(model_) {}

  /// `still_time`: of a file of one time.
  void write_asset(std::optional<double> still_time, bool resolved);
  void add_root();
  std::optional<Error> add_materials(const std::vector<Pigments>& sets, bool diffuse_transmission,
                                     const Progress& progress);
  const WornMaterial& material_of(const Pigments& pigments) const { return materials_.at(pigments); }

  /// Returns the index of the new mesh; -1 for a surface without triangles.
  int add_mesh(const std::string& name, MeshSurface& surface, const KeyShapes& shapes, tinygltf::Value extras);

  /// A node of an organ, with its name and extras, as yet without mesh and place. `last_time`: of the file.
  tinygltf::Node organ_node(OrganId id, double last_time) const;

  /// Returns the index of the new node, a child of the root.
  int add_node(tinygltf::Node node);

  /// Keys of a node's property, `width` numbers for each frame. Frames that linear interpolation gives anyway are left
  /// out; of a property that does not change, all.
  void add_channel(int node, const char* path, std::size_t width, const std::vector<float>& values);

  /// Keys of a node's property at the frames `kept`. Channels of equal keys share them.
  void add_shared_channel(int node, const char* path, const std::vector<std::uint16_t>& kept,
                          const std::vector<float>& output);

  void reserve_vertices(std::size_t count) { buffer_.reserve_vectors3(count); }

  /// Errors: kTooLarge, kIo.
  Expected<std::string> finish();

 private:
  int add_texture(std::string_view png, const std::string& name);
  int add_sampler(const char* path, const std::vector<std::uint16_t>& kept, const std::vector<float>& output);
  void add_channel_of(int node, const char* path, int sampler);
  int times_accessor(const std::vector<std::uint16_t>& frames);

  const Development& development_;
  std::vector<float> seconds_;
  tinygltf::Model model_;
  GltfBuffer buffer_;
  tinygltf::Animation animation_;
  std::map<Pigments, WornMaterial> materials_;
  std::map<std::vector<std::uint16_t>, int> times_;  ///< accessor of each set of frames that some channel keeps
  std::map<std::tuple<std::string, std::vector<std::uint16_t>, std::vector<float>>, int> shared_samplers_;
};

}  // namespace anthesis::detail
