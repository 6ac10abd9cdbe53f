#include "anthesis/exchange/vein_glb.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>

#include "anthesis/base/math.h"
#include "glb_reader.h"

namespace anthesis {
namespace {

using test::GlbReader;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::array<Vec2, 4> kOutline = {Vec2{0.0, 4.0}, Vec2{2.0, 4.0}, Vec2{3.0, 2.0}, Vec2{1.0, 0.0}};

/// A stem that forks into an adaxial arm with a floret's tip and an abaxial one.
Vasculature fork(double height = 1.0) {
  Vasculature veins;
  const auto add = [&](Vec3 position, std::uint32_t parent, double diameter, VeinKind kind) {
    VeinVertex vertex;
    vertex.position = {position.x, position.y, height * position.z};
    vertex.parent = parent;
    vertex.diameter = diameter;
    vertex.kind = kind;
    veins.vertices.push_back(vertex);
  };
  add({0.0, 0.0, 0.0}, kNoVertex, 0.0, VeinKind::kAbaxial);
  add({0.0, 0.0, 1.0}, 0, 0.3, VeinKind::kAbaxial);
  add({1.0, 0.0, 2.0}, 1, 0.2, VeinKind::kAdaxial);
  add({1.0, 0.0, 3.0}, 2, 0.1, VeinKind::kFloret);
  add({-1.0, 0.0, 2.0}, 1, 0.15, VeinKind::kAbaxial);
  veins.ring_vertices = 1;
  return veins;
}

GlbReader still(const VeinGlbParams& params = {}) {
  const Vasculature veins = fork();
  const Expected<std::string> bytes = veins_glb({0.5, &veins, kOutline}, params, {{"head", "mine"}, {"seed", "3"}});
  EXPECT_TRUE(bytes.has_value());
  return GlbReader(*bytes);
}

Expected<std::string> book_bytes(const std::vector<double>& times, const VeinGlbParams& params = {}) {
  VeinGlb glb(params);
  for (const double time : times) {
    const Vasculature veins = fork(0.1 + time);
    if (std::optional<Error> error = glb.add({time, &veins, kOutline})) {
      return unexpected(*error);
    }
  }
  return glb.finish();
}

std::size_t node_named(const GlbReader& glb, const std::string& name) {
  for (std::size_t i = 0; i < glb.json["nodes"].size(); ++i) {
    if (glb.json["nodes"][i]["name"] == name) {
      return i;
    }
  }
  ADD_FAILURE() << "no node " << name;
  return 0;
}

const nlohmann::json& mesh_of(const GlbReader& glb, const std::string& node) {
  return glb.json["meshes"][glb.json["nodes"][node_named(glb, node)]["mesh"].get<std::size_t>()];
}

/// Of a small primitive, whose indices have 16 bits.
std::vector<Triangle> triangles_of(const std::string& bytes, const GlbReader& glb, const nlohmann::json& primitive) {
  const nlohmann::json& accessor = glb.json["accessors"][primitive["indices"].get<std::size_t>()];
  EXPECT_EQ(accessor["componentType"], 5123);
  const nlohmann::json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  std::uint32_t json_size = 0;
  std::memcpy(&json_size, bytes.data() + 12, 4);
  const char* at = bytes.data() + 20 + json_size + 8 + view.value("byteOffset", std::size_t{0}) +
                   accessor.value("byteOffset", std::size_t{0});
  std::vector<Triangle> triangles(accessor["count"].get<std::size_t>() / 3);
  for (Triangle& triangle : triangles) {
    for (std::uint32_t& corner : triangle) {
      std::uint16_t index = 0;
      std::memcpy(&index, at, 2);
      corner = index;
      at += 2;
    }
  }
  return triangles;
}

/// The scale of a node at a time, by steps, as the specification says.
double shown(const GlbReader& glb, std::size_t node, double seconds) {
  for (const nlohmann::json& channel : glb.json["animations"][0]["channels"]) {
    if (channel["target"]["node"] != node) {
      continue;
    }
    EXPECT_EQ(channel["target"]["path"], "scale");
    const nlohmann::json& sampler = glb.json["animations"][0]["samplers"][channel["sampler"].get<std::size_t>()];
    EXPECT_EQ(sampler["interpolation"], "STEP");
    const auto times = glb.floats(sampler["input"].get<std::size_t>());
    const auto scales = glb.floats(sampler["output"].get<std::size_t>());
    EXPECT_EQ(times.size(), scales.size());
    std::size_t key = 0;
    while (key + 1 < times.size() && static_cast<double>(times[key + 1][0]) <= seconds) {
      ++key;
    }
    EXPECT_EQ(scales[key][0], scales[key][1]);
    EXPECT_EQ(scales[key][0], scales[key][2]);
    return static_cast<double>(scales[key][0]);
  }
  ADD_FAILURE() << "no channel of node " << node;
  return -1.0;
}

TEST(VeinGlb, HasAPrimitiveAndAMaterialForEachKind) {
  const GlbReader glb = still();
  const nlohmann::json& primitives = mesh_of(glb, "veins")["primitives"];
  const Vasculature veins = fork();
  const Expected<VeinTubes> tubes = vein_tubes(veins);
  std::map<std::string, std::size_t> triangles;
  for (const Triangle& triangle : tubes->mesh.triangles) {
    ++triangles[std::string(vein_kind_name(tubes->kind[triangle[0]]))];
  }
  ASSERT_EQ(triangles.size(), 3u);
  std::set<std::string> names;
  for (const nlohmann::json& primitive : primitives) {
    const nlohmann::json& material = glb.json["materials"][primitive["material"].get<std::size_t>()];
    const std::string name = material["name"];
    names.insert(name);
    EXPECT_EQ(glb.json["accessors"][primitive["indices"].get<std::size_t>()]["count"], 3 * triangles[name]);
    EXPECT_EQ(material.value("alphaMode", "OPAQUE"), "OPAQUE");
    EXPECT_NEAR(material["pbrMetallicRoughness"]["roughnessFactor"].get<double>(), 0.5, 0.1);
    EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 0.0);
    const auto colour = material["pbrMetallicRoughness"]["baseColorFactor"].get<std::vector<double>>();
    if (name == "abaxial") {  // yellow, red, purple
      EXPECT_TRUE(colour[0] > 2.0 * colour[2] && colour[1] > 2.0 * colour[2]);
    } else if (name == "adaxial") {
      EXPECT_TRUE(colour[0] > 5.0 * colour[1] && colour[0] > 5.0 * colour[2]);
    } else {
      EXPECT_TRUE(colour[0] > 1.5 * colour[1] && colour[2] > 1.5 * colour[1]);
    }
  }
  EXPECT_THAT(names, ElementsAre("abaxial", "adaxial", "floret"));
}

TEST(VeinGlb, HoldsTheSurfaceOfTheTubesInSinglePrecision) {
  const GlbReader glb = still();
  const Vasculature veins = fork();
  const Expected<VeinTubes> tubes = vein_tubes(veins);
  std::multiset<std::array<float, 6>> wanted;
  for (std::size_t kind = 0; kind < 3; ++kind) {
    std::set<std::uint32_t> used;
    for (const Triangle& triangle : tubes->mesh.triangles) {
      if (static_cast<std::size_t>(tubes->kind[triangle[0]]) == kind) {
        used.insert(triangle.begin(), triangle.end());
      }
    }
    for (const std::uint32_t v : used) {
      const Vec3 p = tubes->mesh.positions_mm[v];
      const Vec3 n = tubes->mesh.normals[v];
      wanted.insert({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z),
                     std::round(1e4f * static_cast<float>(n.x)), std::round(1e4f * static_cast<float>(n.y)),
                     std::round(1e4f * static_cast<float>(n.z))});
    }
  }
  std::multiset<std::array<float, 6>> found;
  for (const nlohmann::json& primitive : mesh_of(glb, "veins")["primitives"]) {
    const nlohmann::json& accessor = glb.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    const auto positions = glb.floats(primitive["attributes"]["POSITION"].get<std::size_t>());
    const auto normals = glb.floats(primitive["attributes"]["NORMAL"].get<std::size_t>());
    ASSERT_EQ(positions.size(), normals.size());
    std::vector<float> low(3, std::numeric_limits<float>::max());
    std::vector<float> high(3, std::numeric_limits<float>::lowest());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      found.insert({positions[i][0], positions[i][1], positions[i][2], std::round(1e4f * normals[i][0]),
                    std::round(1e4f * normals[i][1]), std::round(1e4f * normals[i][2])});
      for (std::size_t c = 0; c < 3; ++c) {
        low[c] = std::min(low[c], positions[i][c]);
        high[c] = std::max(high[c], positions[i][c]);
      }
    }
    EXPECT_EQ(accessor["min"].get<std::vector<float>>(), low);
    EXPECT_EQ(accessor["max"].get<std::vector<float>>(), high);
  }
  EXPECT_EQ(found, wanted);
}

TEST(VeinGlb, IsInMetresWithYUp) {
  const GlbReader glb = still();
  EXPECT_EQ(glb.json["scenes"][0]["nodes"], nlohmann::json::array({0}));
  const nlohmann::json& root = glb.json["nodes"][0];
  const auto r = root["rotation"].get<std::vector<double>>();
  const double scale = root["scale"][0];
  const Vec3 up = scale * rotate(normalized(Quaternion{r[3], r[0], r[1], r[2]}), Vec3{0.0, 0.0, 1.0});
  EXPECT_NEAR(length(up - Vec3{0.0, 0.001, 0.0}), 0.0, 1e-9);
}

TEST(VeinGlb, TheReceptacleIsTheOutlineTurnedAboutTheAxis) {
  const GlbReader glb = still({.receptacle_sides = 16});
  const nlohmann::json& primitive = mesh_of(glb, "receptacle")["primitives"][0];
  const nlohmann::json& material = glb.json["materials"][primitive["material"].get<std::size_t>()];
  EXPECT_EQ(material["name"], "receptacle");
  EXPECT_EQ(material["alphaMode"], "BLEND");
  EXPECT_EQ(material["doubleSided"], true);
  EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorFactor"][3], 0.25);

  const auto positions = glb.floats(primitive["attributes"]["POSITION"].get<std::size_t>());
  const auto normals = glb.floats(primitive["attributes"]["NORMAL"].get<std::size_t>());
  ASSERT_EQ(positions.size(), 1u + 3u * 16u);  // one vertex at the apex
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double radius = std::hypot(positions[i][0], positions[i][1]);
    const auto on = [&](Vec2 p) {
      return std::abs(radius - p.x) < 1e-6 && std::abs(static_cast<double>(positions[i][2]) - p.y) < 1e-6;
    };
    EXPECT_TRUE(std::any_of(kOutline.begin(), kOutline.end(), on));
    // Its own middle is inside.
    const Vec3 out{positions[i][0], positions[i][1], positions[i][2] - 2.0f};
    EXPECT_GT(dot(out, Vec3{normals[i][0], normals[i][1], normals[i][2]}), 0.0);
  }
  const auto indices = glb.json["accessors"][primitive["indices"].get<std::size_t>()]["count"];
  EXPECT_EQ(indices, 3 * (16 + 2 * 2 * 16));
}

TEST(VeinGlb, TheReceptaclesTrianglesLookOutwards) {
  const Vasculature veins = fork();
  const std::string bytes = *veins_glb({0.5, &veins, kOutline}, {.receptacle_sides = 16});
  const GlbReader glb(bytes);
  const nlohmann::json& primitive = mesh_of(glb, "receptacle")["primitives"][0];
  const auto p = glb.floats(primitive["attributes"]["POSITION"].get<std::size_t>());
  const auto at = [&](std::uint32_t i) { return Vec3{p[i][0], p[i][1], p[i][2]}; };
  double volume = 0.0;  // under the surface; the open base lies in the plane through the origin
  for (const Triangle& t : triangles_of(bytes, glb, primitive)) {
    volume += dot(at(t[0]), cross(at(t[1]), at(t[2]))) / 6.0;
  }
  const auto frustum = [](double a, double b, double height) { return height * (a * a + a * b + b * b) / 3.0; };
  const double polygon = 0.5 * 16 * std::sin(math::kTurnRad / 16);
  EXPECT_NEAR(volume, polygon * (frustum(2, 3, 2) + frustum(3, 1, 2)), 1e-4);
}

TEST(VeinGlb, MayHaveNoReceptacle) {
  const GlbReader glb = still({.receptacle_alpha = 0.0});
  EXPECT_EQ(glb.json["meshes"].size(), 1u);
  EXPECT_EQ(glb.json["materials"].size(), 3u);
}

TEST(VeinGlb, SaysWhatItWasMadeFrom) {
  const GlbReader glb = still();
  EXPECT_EQ(glb.json["asset"]["extras"]["head"], "mine");
  EXPECT_EQ(glb.json["asset"]["extras"]["seed"], "3");
  EXPECT_THAT(glb.json["asset"]["generator"].get<std::string>(), HasSubstr("Anthesis"));
  EXPECT_EQ(glb.json["nodes"][node_named(glb, "frame 0.500")]["extras"]["time"], 0.5);
}

TEST(VeinGlb, AFlipBookShowsOneFrameAtATime) {
  const Expected<std::string> bytes = book_bytes({0.2, 0.4, 0.8}, {.duration_s = 9.0});
  ASSERT_TRUE(bytes.has_value());
  const GlbReader glb(*bytes);
  const std::vector<std::size_t> nodes = {node_named(glb, "frame 0.200"), node_named(glb, "frame 0.400"),
                                          node_named(glb, "frame 0.800")};
  // Gaps of 0.2 and 0.4, and 0.3 for the last frame.
  for (const auto& [seconds, page] :
       std::map<double, std::size_t>{{0.0, 0}, {1.9, 0}, {2.1, 1}, {5.9, 1}, {6.1, 2}, {8.9, 2}, {9.0, 2}, {20.0, 2}}) {
    for (std::size_t frame = 0; frame < 3; ++frame) {
      EXPECT_EQ(shown(glb, nodes[frame], seconds), frame == page ? 1.0 : 0.0) << seconds << ' ' << frame;
    }
  }
  std::set<int> inputs;
  for (const nlohmann::json& sampler : glb.json["animations"][0]["samplers"]) {
    inputs.insert(sampler["input"].get<int>());
  }
  ASSERT_EQ(inputs.size(), 1u);
  const nlohmann::json& times = glb.json["accessors"][static_cast<std::size_t>(*inputs.begin())];
  EXPECT_EQ(times["min"], nlohmann::json::array({0.0}));
  EXPECT_EQ(times["max"], nlohmann::json::array({9.0}));
}

TEST(VeinGlb, WithoutItsAnimationAFlipBookShowsTheLastFrame) {
  const Expected<std::string> bytes = book_bytes({0.0, 1.0});
  ASSERT_TRUE(bytes.has_value());
  const GlbReader glb(*bytes);
  EXPECT_EQ(glb.json["nodes"][node_named(glb, "frame 0.000")]["scale"], nlohmann::json::array({0.0, 0.0, 0.0}));
  EXPECT_FALSE(glb.json["nodes"][node_named(glb, "frame 1.000")].contains("scale"));
}

TEST(VeinGlb, EachFrameHasVeinsAndReceptacleOfItsOwn) {
  const Expected<std::string> bytes = book_bytes({0.0, 1.0});
  ASSERT_TRUE(bytes.has_value());
  const GlbReader glb(*bytes);
  for (const auto& [time, height] : std::map<std::string, double>{{"0.000", 0.3}, {"1.000", 3.3}}) {
    const auto children = glb.json["nodes"][node_named(glb, "frame " + time)]["children"];
    EXPECT_THAT(children.get<std::vector<std::size_t>>(),
                ElementsAre(node_named(glb, "veins " + time), node_named(glb, "receptacle " + time)));
    double top = 0.0;
    for (const nlohmann::json& primitive : mesh_of(glb, "veins " + time)["primitives"]) {
      top = std::max(
          top, glb.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()]["max"][2].get<double>());
    }
    EXPECT_NEAR(top, height + 0.05, 0.005);
  }
  EXPECT_EQ(glb.json["materials"].size(), 4u);  // shared
}

TEST(VeinGlb, EqualFramesGiveEqualBytes) {
  EXPECT_EQ(*book_bytes({0.0, 0.5, 1.0}), *book_bytes({0.0, 0.5, 1.0}));
}

TEST(VeinGlb, OfAManyPagedBookOnlyMeshesGrow) {
  std::vector<double> times;
  for (int i = 0; i <= 1000; ++i) {
    times.push_back(0.001 * i);
  }
  const Expected<std::string> bytes = book_bytes(times, {.receptacle_alpha = 0.0});
  ASSERT_TRUE(bytes.has_value());
  const GlbReader glb(*bytes);
  const nlohmann::json& view =
      glb.json["bufferViews"][glb.json["accessors"][glb.json["animations"][0]["samplers"][500]["output"]
                                                        .get<std::size_t>()]["bufferView"]
                                  .get<std::size_t>()];
  EXPECT_LT(view["byteLength"].get<std::size_t>(), 50'000u);  // and not the square of the pages
}

TEST(VeinGlb, RefusesWhatIsNoBook) {
  EXPECT_EQ(to_string(book_bytes({}).error()), "frames must be at least 1, got 0");
  EXPECT_EQ(to_string(book_bytes({0.5, 0.5}).error()), "time must be later than the frame before, got 0.5");
  EXPECT_EQ(to_string(book_bytes({1.5}).error()), "time must be between 0 and 1, got 1.5");
  EXPECT_THAT(to_string(book_bytes({0.0, 0.9999999999, 1.0}).error()), HasSubstr("single precision"));
  const Vasculature veins = fork();
  const std::array<Vec2, 2> inside_out = {Vec2{0.0, 1.0}, Vec2{-1.0, 0.0}};
  EXPECT_EQ(veins_glb({0.0, &veins, inside_out}).error().where, "outline");
  EXPECT_EQ(veins_glb({0.0, &veins, kOutline}, {.tubes = {.sides = 2}}).error().where, "sides");
  EXPECT_EQ(veins_glb({0.0, &veins, kOutline}, {.duration_s = 0.0}).error().where, "duration_s");
  EXPECT_EQ(veins_glb({0.0, &veins, kOutline}, {.receptacle_alpha = 2.0}).error().where, "receptacle_alpha");
  EXPECT_EQ(veins_glb({0.0, &veins, kOutline}, {.receptacle_sides = 2}).error().where, "receptacle_sides");
}

}  // namespace
}  // namespace anthesis
