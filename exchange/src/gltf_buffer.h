#pragma once
#include <tiny_gltf.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace anthesis::detail {

/// Collects the numbers of a glTF model, each kind in its own run of bytes, so that few buffer views hold many
/// accessors; `finish` joins the runs into the model's one buffer.
class GltfBuffer {
 public:
  explicit GltfBuffer(tinygltf::Model& model) : model_(model) {}

  /// Each returns the index of the new accessor. Vectors are consecutive floats, three (two) for each element.
  int add_indices(std::span<const std::uint32_t> values, std::uint32_t vertex_count);
  int add_vectors3(std::span<const float> values, bool bounds);
  void reserve_vectors3(std::size_t count) { vectors3_.bytes.reserve(12 * count); }  ///< elements of add_vectors3
  int add_vectors2(std::span<const float> values);
  int add_times(std::span<const float> values);
  int add_keys(std::span<const float> values, int type);  ///< output of an animation sampler, TINYGLTF_TYPE_*

  /// Returns the index of the new image.
  int add_png(std::string_view bytes, const std::string& name);

  /// Lays the runs out in the model's buffer. Call once, at the end; false if they are more than glTF's readers take.
  bool finish();

 private:
  struct Run {
    int view = -1;
    std::vector<unsigned char> bytes;
  };
  Run& run(Run& which, int target, std::size_t stride);
  int add(Run& run, const void* data, std::size_t size, std::size_t count, int component, int type);

  tinygltf::Model& model_;
  Run short_indices_;
  Run long_indices_;
  Run vectors3_;
  Run vectors2_;
  Run keys_;
  std::vector<Run> images_;
};

}  // namespace anthesis::detail
