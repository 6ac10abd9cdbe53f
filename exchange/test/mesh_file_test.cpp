#include "anthesis/exchange/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "anthesis/exchange/glb.h"
#include "anthesis/exchange/ply.h"
#include "tiny_species.h"

namespace anthesis {
namespace {

using nlohmann::json;
using testing::ElementsAre;

CheckedMesh read(std::string bytes) {
  Expected<CheckedMesh> mesh = read_mesh(std::move(bytes), "a.file");
  if (!mesh) {
    ADD_FAILURE() << to_string(mesh.error());
    std::abort();
  }
  return std::move(*mesh);
}

std::string error_of(std::string bytes) {
  const Expected<CheckedMesh> mesh = read_mesh(std::move(bytes), "a.file");
  return mesh ? "no error" : to_string(mesh.error());
}

template <class Value>
std::string raw(Value value, bool big = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big) {
    std::reverse(bytes.begin(), bytes.end());
  }
  return bytes;
}

// ---- PLY

const std::string kAsciiPly =
    "ply\n"
    "format ascii 1.0\n"
    "comment kind 0: ray_floret\n"
    "comment kind 1: disk floret\n"
    "element vertex 5\n"
    "property double z\n"
    "property uchar red\n"
    "property float x\n"
    "property list uchar short friends\n"
    "property int organ\n"
    "property float y\n"
    "property int kind\n"
    "element edge 1\n"
    "property int vertex1\n"
    "property int vertex2\n"
    "element face 2\n"
    "property uchar flags\n"
    "property list uchar uint vertex_index\n"
    "end_header\n"
    "0.1 1 1 0 12 2 0\n"
    "0.2 1 3 2 -7 7 12 4 0\n"
    "0.3 1 5 0 12 0.1 0\n"
    "0.4 1 7 1 3 12 8 0\n"
    "5e-1 1 -9 0 0 +10 -1\n"
    "0 1\n"
    "0 4 0 1 2 3\n"
    "0 3 4 3 2\n";

TEST(ReadPly, ReadsAnyOrderOfPropertiesAndCutsPolygonsIntoFans) {
  const CheckedMesh mesh = read(kAsciiPly);
  EXPECT_THAT(mesh.triangles(), ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{4, 3, 2}));
  EXPECT_THAT(mesh.times_s(), ElementsAre(0.0));
  EXPECT_EQ(mesh.mm_per_unit(), (Vec3{1, 1, 1}));
  // Doubles are the nearest to their text, floats the nearest float.
  EXPECT_THAT(mesh.pose(0).positions, ElementsAre(Vec3{1, 2, 0.1}, Vec3{3, 4, 0.2}, Vec3{5, double{0.1f}, 0.3},
                                                  Vec3{7, 8, 0.4}, Vec3{-9, 10, 0.5}));
}

TEST(ReadPly, NamesTheOrgans) {
  const CheckedMesh mesh = read(kAsciiPly);
  EXPECT_THAT(mesh.parts(), ElementsAre("plant", "ray_floret.12"));
  EXPECT_THAT(mesh.part_of_triangle(), ElementsAre(1, 1, 0));
  std::string nameless = kAsciiPly;
  nameless.replace(nameless.find("int organ"), 9, "int hello");
  EXPECT_THAT(read(nameless).parts(), ElementsAre("mesh"));
}

std::string binary_ply(bool big) {
  std::string bytes = "ply\r\nformat binary_";
  bytes += big ? "big" : "little";
  bytes +=
      "_endian 1.0\r\nelement thing 2\r\nproperty list int double bits\r\nelement vertex 3\r\nproperty float32 x\r\n"
      "property float64 y\r\nproperty int16 z\r\nelement face 1\r\nproperty list uint8 uint16 vertex_indices\r\n"
      "end_header\r\n";
  bytes += raw(std::int32_t{1}, big) + raw(0.5, big) + raw(std::int32_t{0}, big);
  for (int i = 0; i < 3; ++i) {
    bytes += raw(0.1f * static_cast<float>(i), big) + raw(0.1 * i, big) + raw(static_cast<std::int16_t>(-i), big);
  }
  bytes += raw(std::uint8_t{3}) + raw(std::uint16_t{2}, big) + raw(std::uint16_t{0}, big) + raw(std::uint16_t{1}, big);
  return bytes;
}

TEST(ReadPly, ReadsBothOrdersOfBytes) {
  for (const bool big : {false, true}) {
    const CheckedMesh mesh = read(binary_ply(big));
    EXPECT_THAT(mesh.triangles(), ElementsAre(Triangle{2, 0, 1}));
    EXPECT_THAT(mesh.pose(0).positions,
                ElementsAre(Vec3{0, 0, 0}, Vec3{0.1f, 0.1, -1}, Vec3{0.1f * 2.0f, 0.1 * 2, -2}));
  }
}

TEST(ReadPly, SaysWhereAFileIsWrong) {
  const auto with = [](const std::string& what, const std::string& instead) {
    std::string text = kAsciiPly;
    text.replace(text.find(what), what.size(), instead);
    return error_of(text);
  };
  EXPECT_EQ(with("format ascii 1.0", "format ascii 2.0"),
            "a.file: header line 2: must be format ascii, binary_little_endian or binary_big_endian, and 1.0, got "
            "\"format ascii 2.0\"");
  EXPECT_EQ(with("element vertex 5", "element vertex -5"),
            "a.file: header line 5: must be element NAME COUNT, got \"element vertex -5\"");
  EXPECT_EQ(with("property double z", "property long z"),
            "a.file: header line 6: must be property TYPE NAME or property list TYPE TYPE NAME, got \"property long "
            "z\"");
  EXPECT_EQ(with("uchar uint", "float uint"),
            "a.file: header line 18: must count its list in whole numbers, got \"property list float uint "
            "vertex_index\"");
  EXPECT_EQ(with("format ascii 1.0\n", ""), "a.file: header line 18: must come after a line that states the format");
  EXPECT_EQ(with("property float x", "property float w"), "a.file: header: must give each vertex a number x");
  EXPECT_EQ(with("vertex_index", "vertices"),
            "a.file: header: must give each face a list vertex_indices of whole numbers");
  EXPECT_EQ(with("element face", "element faces"), "a.file: header: must have one element vertex and one element face");
  EXPECT_EQ(with("end_header", "the end"),
            "a.file: header line 19: must begin with format, comment, element or property, got \"the end\"");
  EXPECT_EQ(with("element vertex 5", "element vertex 50000001"),
            "a.file: header: must have at most 50000000 vertices, got 50000001");
  EXPECT_EQ(with("element vertex 5", "element vertex 5000"),
            "a.file: header: must announce what the file holds, got 5000 of vertex and 124 bytes left for them");
  EXPECT_EQ(with("0.3 1 5", "0.3 1 nan"), "a.file: vertex 2: x must be within -1e100 to 1e100, got nan");
  EXPECT_EQ(with("0.3 1 5", "0.3 1 5x"), "a.file: vertex 2: must be whole: a number is missing or is none");
  EXPECT_EQ(with("0 4 0 1 2 3", "0 4 0 1 2 5"), "a.file: face 0: must name vertices below 5, got 5");
  EXPECT_EQ(with("0 4 0 1 2 3", "0 4 0 1 2 -1"), "a.file: face 0: must name vertices below 5, got -1");
  EXPECT_EQ(with("0 4 0 1 2 3", "0 2 0 1"), "a.file: face 0: must have 3 vertices or more, got 2");
  EXPECT_EQ(with("0 3 4 3 2\n", "0 3 4 3"), "a.file: face 1: must be whole: a number is missing or is none");
  EXPECT_EQ(error_of("ply\nformat ascii 1.0"),
            "a.file: header line 2: must end; the header ends with the line end_header");
}

TEST(ReadMesh, KnowsWhatItIsNot) {
  const std::string expected = "a.file: is neither a PLY nor a GLB file: must begin with \"ply\" or \"glTF\"";
  EXPECT_EQ(error_of(""), expected);
  EXPECT_EQ(error_of("pl"), expected);
  EXPECT_EQ(error_of("solid cube"), expected);
}

// ---- GLB

/// Puts a GLB together by hand.
struct GlbText {
  json document = {{"asset", {{"version", "2.0"}}}};
  std::string binary;

  template <class Value>
  std::size_t add(const std::vector<Value>& values, const std::string& type, int component, std::size_t width) {
    document["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", sizeof(Value) * values.size()}});
    document["accessors"].push_back({{"bufferView", document["bufferViews"].size() - 1},
                                     {"componentType", component},
                                     {"count", values.size() / width},
                                     {"type", type}});
    for (const Value value : values) {
      binary += raw(value);
    }
    binary.resize((binary.size() + 3) & ~std::size_t{3});
    return document["accessors"].size() - 1;
  }
  std::size_t vectors(const std::vector<float>& values) { return add(values, "VEC3", 5126, 3); }
  std::size_t scalars(const std::vector<float>& values) { return add(values, "SCALAR", 5126, 1); }

  std::string bytes() const {
    json whole = document;
    whole["buffers"] = {{{"byteLength", binary.size()}}};
    std::string text = whole.dump();
    text.resize((text.size() + 3) & ~std::size_t{3}, ' ');
    const auto size = [](std::size_t n) { return raw(static_cast<std::uint32_t>(n)); };
    return "glTF" + size(2) + size(12 + 8 + text.size() + 8 + binary.size()) + size(text.size()) + "JSON" + text +
           size(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

/// A root that turns and scales everything, and under it one triangle twice: once as it is, once moved and turned.
GlbText two_triangles() {
  GlbText glb;
  const std::size_t positions = glb.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0.1f});
  const std::size_t target = glb.vectors({0, 0, 0, 0, 0, 0, 0, 0, 0.2f});
  const std::size_t indices = glb.add(std::vector<std::uint8_t>{2, 0, 1}, "SCALAR", 5121, 1);
  glb.document["meshes"] = {
      {{"primitives",
        {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"targets", {{{"POSITION", target}}}}}}}}};
  const double half = std::sqrt(0.5);
  glb.document["nodes"] = {
      {{"name", "plant"}, {"children", {1, 2}}, {"rotation", {-half, 0, 0, half}}, {"scale", {0.001, 0.001, 0.001}}},
      {{"name", "ray_floret.1"}, {"mesh", 0}},
      {{"mesh", 0}, {"translation", {0, 0, 5}}, {"rotation", {0, 0, 1, 0}}, {"weights", {1}}}};
  glb.document["scenes"] = {{{"nodes", {0}}}};
  return glb;
}

TEST(ReadGlb, PlacesNodesAndLeavesTheRootsTransformOut) {
  const CheckedMesh mesh = read(two_triangles().bytes());
  EXPECT_THAT(mesh.parts(), ElementsAre("ray_floret.1", "node 2"));
  EXPECT_THAT(mesh.triangles(), ElementsAre(Triangle{2, 0, 1}, Triangle{5, 3, 4}));
  EXPECT_THAT(mesh.part_of_triangle(), ElementsAre(0, 1));
  EXPECT_EQ(mesh.vertex_count(), 6u);
  EXPECT_THAT(mesh.times_s(), ElementsAre(0.0));
  EXPECT_EQ(mesh.mm_per_unit(), (Vec3{1, 1, 1}));
  const MeshPose pose = mesh.pose(0);
  EXPECT_THAT(pose.shown, ElementsAre(1, 1));
  EXPECT_THAT(pose.positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, double{0.1f}}, Vec3{0, 0, 5},
                                          Vec3{-1, 0, 5}, Vec3{0, -1, double{0.1f} + double{0.2f} + 5.0}));
}

TEST(ReadGlb, TakesMetresAndTheWholeTransformWhereThereIsNoCommonRoot) {
  GlbText glb = two_triangles();
  glb.document["nodes"][0].erase("children");
  glb.document["nodes"][1] = {{"mesh", 0}, {"matrix", {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 7, 8, 9, 1}}};
  glb.document["scenes"] = {{{"nodes", {0, 1}}}};
  const CheckedMesh mesh = read(glb.bytes());
  EXPECT_EQ(mesh.mm_per_unit(), (Vec3{1000, 1000, 1000}));
  EXPECT_THAT(mesh.pose(0).positions, ElementsAre(Vec3{7, 8, 9}, Vec3{7, 10, 9}, Vec3{5, 8, 9.0 + 2.0 * double{0.1f}}));
}

TEST(ReadGlb, ShowsEveryKeyOfTheAnimationExactly) {
  GlbText glb = two_triangles();
  const std::size_t early = glb.scalars({0.0f, 0.3f});
  const std::size_t late = glb.scalars({0.1f, 0.3f, 0.5f});
  const std::size_t weights = glb.scalars({0.0f, 1.0f, 0.5f});
  const std::size_t places = glb.vectors({0, 0, 1, 0, 0, 4});
  const std::size_t scales = glb.vectors({1, 1, 1, 0, 0, 0});
  const auto channel = [](int sampler, int node, const char* path) {
    return json{{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}};
  };
  glb.document["animations"] = {
      {{"samplers",
        {{{"input", late}, {"output", weights}},
         {{"input", early}, {"output", places}},
         {{"input", early}, {"output", scales}, {"interpolation", "STEP"}}}},
       {"channels", {channel(0, 1, "weights"), channel(1, 2, "translation"), channel(2, 1, "scale")}}}};
  const CheckedMesh mesh = read(glb.bytes());
  EXPECT_THAT(mesh.times_s(), ElementsAre(0.0, 0.1f, 0.3f, 0.5f));
  const auto tip = [&mesh](std::size_t frame) { return mesh.pose(frame).positions[2].z; };
  const auto height = [&mesh](std::size_t frame) { return mesh.pose(frame).positions[3].z; };
  EXPECT_EQ(tip(0), double{0.1f});
  EXPECT_EQ(tip(1), double{0.1f});
  EXPECT_EQ(height(0), 1.0);
  EXPECT_NEAR(height(1), 2.0, 1e-6);
  EXPECT_EQ(height(2), 4.0);
  EXPECT_EQ(height(3), 4.0);
  // Scaled to nothing from the third key on.
  EXPECT_THAT(mesh.pose(1).shown, ElementsAre(1, 1));
  EXPECT_THAT(mesh.pose(2).shown, ElementsAre(0, 1));

  glb.document["animations"][0]["channels"].erase(2);
  const CheckedMesh shown = read(glb.bytes());
  EXPECT_EQ(shown.pose(2).positions[2].z, double{0.1f} + double{0.2f});
  EXPECT_EQ(shown.pose(3).positions[2].z, double{0.1f} + 0.5 * double{0.2f});
}

TEST(ReadGlb, TurnsAtConstantSpeedAndFollowsCubicCurves) {
  GlbText glb = two_triangles();
  const float half = static_cast<float>(std::sqrt(0.5));
  const std::size_t keys = glb.scalars({0.0f, 3.0f});
  const std::size_t middle = glb.scalars({1.0f});
  const std::size_t turns = glb.add(std::vector<float>{0, 0, 0, 1, 0, 0, half, half}, "VEC4", 5126, 4);
  const std::size_t still = glb.add(std::vector<float>{0, 0, 0, 1}, "VEC4", 5126, 4);
  // In-tangent, value, out-tangent of two keys: z = t^3, whose slope is 0 and 27.
  const std::size_t cubic = glb.vectors({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 27, 0, 0, 27, 0, 0, 0});
  glb.document["animations"] = {{{"samplers",
                                  {{{"input", keys}, {"output", turns}},
                                   {{"input", keys}, {"output", cubic}, {"interpolation", "CUBICSPLINE"}},
                                   {{"input", middle}, {"output", still}}}},
                                 {"channels",
                                  {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}},
                                   {{"sampler", 1}, {"target", {{"node", 2}, {"path", "translation"}}}},
                                   {{"sampler", 2}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}}};
  const CheckedMesh mesh = read(glb.bytes());
  EXPECT_THAT(mesh.times_s(), ElementsAre(0.0, 1.0, 3.0));
  const MeshPose pose = mesh.pose(1);
  EXPECT_NEAR(pose.positions[1].x, std::cos(M_PI / 6), 1e-6);  // a third of a quarter turn
  EXPECT_NEAR(pose.positions[1].y, std::sin(M_PI / 6), 1e-6);
  EXPECT_NEAR(pose.positions[3].z, 1.0, 1e-12);
}

TEST(ReadGlb, ReadsStripsFansAndMeshesWithoutIndices) {
  GlbText glb;
  const std::size_t positions = glb.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
  const std::size_t wide = glb.add(std::vector<std::uint32_t>{4, 3, 2}, "SCALAR", 5125, 1);
  const std::size_t narrow = glb.add(std::vector<std::uint16_t>{0, 1, 3, 2}, "SCALAR", 5123, 1);
  const json attributes = {{"POSITION", positions}};
  glb.document["meshes"] = {{{"primitives",
                              {{{"attributes", attributes}, {"mode", 5}},
                               {{"attributes", attributes}, {"mode", 1}},
                               {{"attributes", attributes}, {"mode", 6}, {"indices", narrow}},
                               {{"attributes", attributes}, {"indices", wide}}}}}};
  glb.document["nodes"] = {{{"mesh", 0}}};
  glb.document["scenes"] = {{{"nodes", {0}}}};
  EXPECT_THAT(read(glb.bytes()).triangles(), ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}, Triangle{2, 3, 4},
                                                         Triangle{5, 6, 8}, Triangle{5, 8, 7}, Triangle{14, 13, 12}));
}

TEST(ReadGlb, SaysWhereAFileIsWrong) {
  const auto with = [](auto change) {
    GlbText glb = two_triangles();
    change(glb.document);
    return error_of(glb.bytes());
  };
  EXPECT_EQ(with([](json& d) { d["nodes"][1]["mesh"] = 3; }), "a.file: meshes[3]: must exist: there are 1");
  EXPECT_EQ(with([](json& d) { d["nodes"][1]["mesh"] = -1; }),
            "a.file: nodes[1].mesh: must be a whole number, 0 to 2^40");
  EXPECT_EQ(with([](json& d) { d["nodes"][1]["children"] = {0}; }), "a.file: nodes[0]: must have one parent");
  EXPECT_EQ(with([](json& d) {
              d["nodes"][1]["scale"] = {1, 2};
            }),
            "a.file: nodes[1].scale: must be a list of 3 finite numbers");
  EXPECT_EQ(with([](json& d) { d["nodes"][1]["skin"] = 0; }),
            "a.file: nodes[1]: must have no skin: skins are not read here");
  EXPECT_EQ(with([](json& d) { d["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }),
            "a.file: extensionsRequired: must name no extension that changes the mesh, got KHR_draco_mesh_compression");
  EXPECT_EQ(with([](json& d) { d["extensionsRequired"] = {"KHR_materials_unlit"}; }), "no error");
  EXPECT_EQ(with([](json& d) { d["accessors"][0]["sparse"] = json::object(); }),
            "a.file: accessors[0]: must not be sparse: that is not read here");
  EXPECT_EQ(with([](json& d) { d["accessors"][0]["componentType"] = 5122; }),
            "a.file: accessors[0].componentType: must be 5126 (float) here: quantized numbers are not read, got 5122");
  EXPECT_EQ(with([](json& d) { d["accessors"][0]["count"] = 4; }),
            "a.file: accessors[0]: must have elements, all within its view of 36 bytes");
  EXPECT_EQ(with([](json& d) { d["accessors"][0]["byteOffset"] = 1099511627776; }),
            "a.file: accessors[0]: must have elements, all within its view of 36 bytes");
  EXPECT_EQ(with([](json& d) { d["bufferViews"][0]["byteLength"] = 1000; }),
            "a.file: bufferViews[0]: must be within the binary chunk of 76 bytes");
  EXPECT_EQ(with([](json& d) { d["accessors"][0]["count"] = 2; }),
            "a.file: meshes[0].primitives[0].targets[0]: must move all 2 vertices, got 3");
  EXPECT_EQ(with([](json& d) {
              d["nodes"][2]["weights"] = {1, 2};
            }),
            "a.file: nodes[2].weights: must be a list of 1 finite numbers");
  EXPECT_EQ(with([](json& d) { d["meshes"][0]["primitives"][0]["attributes"].erase("POSITION"); }),
            "a.file: meshes[0].primitives[0].attributes.POSITION: must be a whole number, 0 to 2^40");
  EXPECT_EQ(with([](json& d) { d["scenes"] = json::array(); }), "a.file: scenes[0]: must exist: there are 0");
  EXPECT_EQ(with([](json& d) { d["nodes"] = 7; }), "a.file: nodes: must be a list");

  GlbText glb = two_triangles();
  glb.binary[72] = 3;  // an index
  EXPECT_EQ(error_of(glb.bytes()), "a.file: accessors[2]: must name vertices below 3, got 3 in element 0");
  glb.binary[72] = 2;
  glb.binary.replace(0, 4, raw(std::numeric_limits<float>::infinity()));
  EXPECT_EQ(error_of(glb.bytes()), "a.file: accessors[0]: must have finite numbers, got inf in element 0");
  const std::string whole = two_triangles().bytes();
  EXPECT_EQ(error_of(whole.substr(0, whole.size() - 1)), "a.file: header: must state the length of the file, " +
                                                             std::to_string(whole.size() - 1) + " bytes, got " +
                                                             std::to_string(whole.size()));
}

TEST(ReadGlb, RefusesAnimationsThatDoNotFit) {
  GlbText glb = two_triangles();
  const std::size_t keys = glb.scalars({0.0f, 3.0f});
  const std::size_t places = glb.vectors({0, 0, 0, 1, 1, 1});
  const std::size_t backwards = glb.scalars({3.0f, 0.0f});
  const json animation = {{"samplers", {{{"input", keys}, {"output", places}}}},
                          {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}};
  const auto with = [&](auto change) {
    GlbText changed = glb;
    changed.document["animations"] = {animation};
    change(changed.document["animations"][0], changed.document);
    return error_of(changed.bytes());
  };
  EXPECT_EQ(with([](json&, json&) {}), "no error");
  EXPECT_EQ(with([&](json& a, json&) { a["samplers"][0]["input"] = backwards; }),
            "a.file: accessors[" + std::to_string(backwards) + "]: must ascend, as the times of an animation do");
  EXPECT_EQ(with([](json& a, json&) { a["channels"][0]["target"]["path"] = "weights"; }),
            "a.file: accessors[" + std::to_string(places) + "].type: must be SCALAR here");
  EXPECT_EQ(with([](json& a, json&) { a["samplers"][0]["interpolation"] = "CUBICSPLINE"; }),
            "a.file: animations[0].samplers[0]: must have 9 numbers for each of the 2 times, got 6");
  EXPECT_EQ(with([](json& a, json&) { a["channels"].push_back(a["channels"][0]); }),
            "a.file: animations[0]: must move each property of a node once");
  EXPECT_EQ(with([](json& a, json&) { a["channels"][0]["sampler"] = 1; }),
            "a.file: animations[0].channels[0].sampler: must exist: there are 1");
  EXPECT_EQ(with([](json&, json& d) { d["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }),
            "a.file: animations[0].channels[0]: must not move a node that has a matrix");
}

// ---- Our own files

TEST(ReadMesh, ReadsBackThePlyWeWrite) {
  const Development development = test::grow_tiny();
  const CheckedMesh mesh = read(to_ply(development, 0.7).value());
  EXPECT_EQ(mesh.parts().front(), "plant");
  EXPECT_THAT(mesh.parts(), testing::Contains("petal.1"));
  const Canopy canopy = development.at(0.7);
  EXPECT_EQ(mesh.parts().size(), canopy.organs.size() + 1);
}

TEST(ReadMesh, ReadsBackTheGlbWeWriteWithinSinglePrecision) {
  const Development development = test::grow_tiny();
  const CheckedMesh mesh = read(to_glb(development, {.time = 0.7}).value());
  const CheckedMesh ply = read(to_ply(development, 0.7).value());
  ASSERT_EQ(mesh.triangles().size(), ply.triangles().size());
  EXPECT_EQ(mesh.mm_per_unit(), (Vec3{1, 1, 1}));
  const std::size_t frames = read(to_glb(development, {.frames = 9}).value()).times_s().size();
  EXPECT_EQ(frames, 9u);
}

TEST(ReadMesh, SurvivesFilesThatAreCutOrChanged) {
  const Development development = test::grow_tiny();
  std::mt19937_64 random(3);
  for (const std::string& whole : {two_triangles().bytes(), kAsciiPly, binary_ply(false),
                                   to_glb(development, {.frames = 3}).value(), to_ply(development, 0.4).value()}) {
    for (int i = 0; i < 300; ++i) {
      std::string bytes = whole;
      for (std::uint64_t k = 0; k < 1 + random() % 4; ++k) {
        bytes[random() % std::min<std::size_t>(bytes.size(), 3000)] = static_cast<char>(random());
      }
      if (i % 3 == 0) {
        bytes.resize(random() % bytes.size());
      }
      const Expected<CheckedMesh> mesh = read_mesh(bytes, "a");
      if (mesh) {
        EXPECT_EQ(mesh->pose(mesh->times_s().size() - 1).positions.size(), mesh->vertex_count());
      } else {
        EXPECT_THAT(to_string(mesh.error()), testing::StartsWith("a: "));
      }
    }
  }
}

}  // namespace
}  // namespace anthesis
