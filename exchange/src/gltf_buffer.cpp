#include "gltf_buffer.h"

#include <algorithm>
#include <limits>

namespace anthesis::detail {
namespace {

// tinygltf writes offsets as int, and many readers hold them so.
constexpr std::uint64_t kMaxBytes = std::numeric_limits<std::int32_t>::max();

template <std::size_t kWidth>
void bound(tinygltf::Accessor& accessor, std::span<const float> values) {
  accessor.minValues.assign(kWidth, 0.0);
  accessor.maxValues.assign(kWidth, 0.0);
  for (std::size_t c = 0; c < kWidth; ++c) {
    float low = values[c];
    float high = values[c];
    for (std::size_t i = c; i < values.size(); i += kWidth) {
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    accessor.minValues[c] = low;
    accessor.maxValues[c] = high;
  }
}

}  // namespace

GltfBuffer::Run& GltfBuffer::run(Run& which, int target, std::size_t stride) {
  if (which.view < 0) {
    which.view = static_cast<int>(model_.bufferViews.size());
    tinygltf::BufferView view;
    view.buffer = 0;
    view.target = target;
    view.byteStride = stride;
    model_.bufferViews.push_back(view);
  }
  return which;
}

int GltfBuffer::add(Run& run, const void* data, std::size_t size, std::size_t count, int component, int type) {
  tinygltf::Accessor accessor;
  accessor.bufferView = run.view;
  accessor.byteOffset = run.bytes.size();
  accessor.componentType = component;
  accessor.count = count;
  accessor.type = type;
  const auto* bytes = static_cast<const unsigned char*>(data);
  run.bytes.insert(run.bytes.end(), bytes, bytes + size);
  run.bytes.resize((run.bytes.size() + 3) & ~std::size_t{3});
  model_.accessors.push_back(std::move(accessor));
  return static_cast<int>(model_.accessors.size()) - 1;
}

int GltfBuffer::add_indices(std::span<const std::uint32_t> values, std::uint32_t vertex_count) {
  // The largest value of a type is not an index: it restarts primitives.
  if (vertex_count <= std::numeric_limits<std::uint16_t>::max()) {
    const std::vector<std::uint16_t> narrow(values.begin(), values.end());
    return add(run(short_indices_, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, 0), narrow.data(), 2 * narrow.size(),
               narrow.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_SCALAR);
  }
  return add(run(long_indices_, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, 0), values.data(), values.size_bytes(),
             values.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR);
}

int GltfBuffer::add_vectors3(std::span<const float> values, bool bounds) {
  const int index = add(run(vectors3_, TINYGLTF_TARGET_ARRAY_BUFFER, 12), values.data(), values.size_bytes(),
                        values.size() / 3, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
  if (bounds) {
    bound<3>(model_.accessors.back(), values);
  }
  return index;
}

int GltfBuffer::add_vectors2(std::span<const float> values) {
  return add(run(vectors2_, TINYGLTF_TARGET_ARRAY_BUFFER, 8), values.data(), values.size_bytes(), values.size() / 2,
             TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2);
}

int GltfBuffer::add_times(std::span<const float> values) {
  const int index = add_keys(values, TINYGLTF_TYPE_SCALAR);
  bound<1>(model_.accessors.back(), values);
  return index;
}

int GltfBuffer::add_keys(std::span<const float> values, int type) {
  const std::size_t width =
      static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
  return add(run(keys_, 0, 0), values.data(), values.size_bytes(), values.size() / width, TINYGLTF_COMPONENT_TYPE_FLOAT,
             type);
}

int GltfBuffer::add_png(std::string_view bytes, const std::string& name) {
  images_.emplace_back();
  Run& image_run = run(images_.back(), 0, 0);
  image_run.bytes.assign(bytes.begin(), bytes.end());
  tinygltf::Image image;
  image.name = name;
  image.bufferView = image_run.view;
  image.mimeType = "image/png";
  model_.images.push_back(std::move(image));
  return static_cast<int>(model_.images.size()) - 1;
}

bool GltfBuffer::finish() {
  std::vector<Run*> runs = {&short_indices_, &long_indices_, &vectors3_, &vectors2_, &keys_};
  for (Run& image : images_) {
    runs.push_back(&image);
  }
  std::uint64_t total = 0;
  for (const Run* run : runs) {
    if (__builtin_add_overflow(total, std::uint64_t{run->bytes.size()} + 3, &total)) {
      return false;
    }
  }
  if (total > kMaxBytes) {
    return false;
  }
  tinygltf::Buffer buffer;
  buffer.data.reserve(total);
  for (Run* run : runs) {
    if (run->view < 0) {
      continue;
    }
    buffer.data.resize((buffer.data.size() + 3) & ~std::size_t{3});
    tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(run->view)];
    view.byteOffset = buffer.data.size();
    view.byteLength = run->bytes.size();
    buffer.data.insert(buffer.data.end(), run->bytes.begin(), run->bytes.end());
    run->bytes = {};
  }
  model_.buffers.push_back(std::move(buffer));
  return true;
}

}  // namespace anthesis::detail
