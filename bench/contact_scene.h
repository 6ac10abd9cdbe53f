#pragma once
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "anthesis/contact/sheet.h"

namespace anthesis {

/// The peers' scenes: petals of 19 x 19 vertices in layers half an edge apart, in one step of growth.
struct ContactScene {
  static constexpr std::uint32_t kVerticesOfBody = 361;

  std::vector<Vec3> from_mm;  ///< crossing-free
  std::vector<Vec3> to_mm;
  std::vector<Triangle> triangles;  ///< of all bodies
  Sheet sheet;                      ///< of each of them
  std::uint32_t body_count = 0;     ///< 0: the file is not there

  bool found() const { return body_count > 0; }
  std::uint32_t first_vertex(std::uint32_t body) const { return body * kVerticesOfBody; }
  double mean_edge_mm() const {
    double sum = 0.0;
    for (const auto& [a, b] : sheet.edges) {
      sum += length(from_mm[b] - from_mm[a]);
    }
    return sum / static_cast<double>(sheet.edges.size());
  }
};

inline constexpr const char* kNoContactScene = "no contact scenes; set ANTHESIS_REFERENCE";

/// `name`: "art_154x19_a05", for instance. The file holds the numbers of vertices and triangles, then the vertices
/// before and after, then the triangles.
inline ContactScene read_contact_scene(const std::string& name) {
  const char* given = std::getenv("ANTHESIS_REFERENCE");
  const std::string folder = given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT;
  std::ifstream file(folder + "/contact-scenes/" + name + ".bin", std::ios::binary);
  const auto read = [&file](auto& to) {
    file.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size() * sizeof(to[0])));
  };
  std::array<std::int32_t, 2> counts = {};
  read(counts);
  ContactScene scene;
  if (!file) {
    return scene;
  }
  scene.from_mm.resize(static_cast<std::size_t>(counts[0]));
  scene.to_mm.resize(scene.from_mm.size());
  scene.triangles.resize(static_cast<std::size_t>(counts[1]));
  read(scene.from_mm);
  read(scene.to_mm);
  read(scene.triangles);
  scene.body_count = static_cast<std::uint32_t>(scene.from_mm.size() / ContactScene::kVerticesOfBody);
  // All bodies have the triangles of the first one.
  scene.sheet = make_sheet(ContactScene::kVerticesOfBody,
                           std::span(scene.triangles).first(scene.triangles.size() / scene.body_count));
  scene.sheet.shape_mm.assign(scene.from_mm.begin(), scene.from_mm.begin() + ContactScene::kVerticesOfBody);
  return scene;
}

}  // namespace anthesis
