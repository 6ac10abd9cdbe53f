#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "anthesis/geometry/vec.h"

namespace anthesis::test {

/// Reads what the tests need of a GLB, straight from the specification and by nothing that writes it.
class GlbReader {
 public:
  explicit GlbReader(const std::string& bytes) {
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word(bytes, 4), 2u);
    EXPECT_EQ(word(bytes, 8), bytes.size());
    const std::size_t json_size = word(bytes, 12);
    EXPECT_EQ(word(bytes, 16), 0x4E4F534Au);
    EXPECT_EQ(json_size % 4, 0u);
    json = nlohmann::json::parse(bytes.substr(20, json_size));
    const std::size_t chunk = 20 + json_size;
    EXPECT_EQ(word(bytes, chunk + 4), 0x004E4942u);
    EXPECT_EQ(chunk + 8 + word(bytes, chunk), bytes.size());
    binary_ = bytes.substr(chunk + 8);
  }

  std::vector<std::vector<float>> floats(std::size_t accessor_index) const {
    const nlohmann::json& accessor = json["accessors"][accessor_index];
    EXPECT_EQ(accessor["componentType"], 5126);
    const nlohmann::json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t width = accessor["type"] == "SCALAR" ? 1
                              : accessor["type"] == "VEC2" ? 2
                              : accessor["type"] == "VEC3" ? 3
                                                           : 4;
    const std::size_t stride = view.value("byteStride", 4 * width);
    std::size_t at = view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
    std::vector<std::vector<float>> result;
    for (std::size_t i = 0; i < accessor["count"].get<std::size_t>(); ++i, at += stride) {
      std::vector<float> element(width);
      std::memcpy(element.data(), binary_.data() + at, 4 * width);
      result.push_back(std::move(element));
    }
    return result;
  }

  /// A node's property at `seconds`: the channel's value, or the node's own, or `otherwise`.
  std::vector<double> property(std::size_t node, const std::string& path, double seconds,
                               std::vector<double> otherwise) const {
    if (json.contains("animations")) {
      const nlohmann::json& animation = json["animations"][0];
      for (const nlohmann::json& channel : animation["channels"]) {
        if (channel["target"]["node"] == node && channel["target"]["path"] == path) {
          const nlohmann::json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
          return sampled(floats(sampler["input"]), floats(sampler["output"]), seconds);
        }
      }
    }
    return json["nodes"][node].contains(path) ? json["nodes"][node][path].get<std::vector<double>>() : otherwise;
  }

  /// World positions of a node's mesh in millimetres with +z up, the root's turn and scale undone.
  std::vector<Vec3> positions_mm(std::size_t node, double seconds) const {
    const nlohmann::json& mesh = json["meshes"][json["nodes"][node]["mesh"].get<std::size_t>()];
    const std::vector<double> t = property(node, "translation", seconds, {0, 0, 0});
    const std::vector<double> r = property(node, "rotation", seconds, {0, 0, 0, 1});
    const std::vector<double> s = property(node, "scale", seconds, {1, 1, 1});
    const std::vector<double> weights = property(node, "weights", seconds, {});
    const Quaternion rotation = normalized(Quaternion{r[3], r[0], r[1], r[2]});
    std::vector<Vec3> result;
    for (const nlohmann::json& primitive : mesh["primitives"]) {
      std::vector<std::vector<float>> positions = floats(primitive["attributes"]["POSITION"]);
      for (std::size_t k = 0; k < weights.size(); ++k) {
        const std::vector<std::vector<float>> delta = floats(primitive["targets"][k]["POSITION"]);
        for (std::size_t i = 0; i < positions.size(); ++i) {
          for (std::size_t c = 0; c < 3; ++c) {
            positions[i][c] += static_cast<float>(weights[k]) * delta[i][c];
          }
        }
      }
      for (const std::vector<float>& p : positions) {
        result.push_back(Vec3{t[0], t[1], t[2]} + rotate(rotation, Vec3{s[0] * p[0], s[1] * p[1], s[2] * p[2]}));
      }
    }
    return result;
  }

  nlohmann::json json;

 private:
  static std::uint32_t word(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  }

  static std::vector<double> sampled(const std::vector<std::vector<float>>& times,
                                     const std::vector<std::vector<float>>& values, double seconds) {
    const std::size_t width = values.size() * values.front().size() / times.size();  // weights come as scalars
    const auto value = [&](std::size_t key, std::size_t c) {
      const std::size_t flat = key * width + c;
      return static_cast<double>(values[flat / values.front().size()][flat % values.front().size()]);
    };
    std::size_t after = 0;
    while (after < times.size() && times[after][0] < seconds - 1e-6) {
      ++after;
    }
    std::vector<double> result;
    for (std::size_t c = 0; c < width; ++c) {
      if (after == 0 || after == times.size()) {
        result.push_back(value(after == 0 ? 0 : times.size() - 1, c));
      } else {
        const double f = (seconds - times[after - 1][0]) / (times[after][0] - times[after - 1][0]);
        result.push_back((1.0 - f) * value(after - 1, c) + f * value(after, c));
      }
    }
    return result;
  }

  std::string binary_;
};

}  // namespace anthesis::test
