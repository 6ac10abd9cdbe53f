#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <set>

#include "anthesis/base/parallel.h"
#include "anthesis/exchange/glb.h"
#include "anthesis/exchange/judge_sample.h"
#include "anthesis/exchange/mesh_file.h"
#include "bent_plant.h"
#include "glb_reader.h"
#include "tiny_species.h"

namespace anthesis {
namespace {

using test::bent;
using test::GlbReader;
using test::grow_tiny;

constexpr std::array<double, 5> kTimes = {0.0, 0.25, 0.5, 0.75, 1.0};

std::string glb_of(const Development& development, std::span<const Canopy> frames, const GlbOptions& options = {}) {
  Expected<std::string> bytes = to_glb(development, frames, options);
  EXPECT_TRUE(bytes.has_value()) << (bytes ? "" : to_string(bytes.error()));
  return bytes ? *bytes : std::string();
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

std::string name_of(const Development& development, OrganId id) {
  return development.species().organs[development.organs()[id.value - 1].kind].name + "." + std::to_string(id.value);
}

const nlohmann::json& primitive_of(const GlbReader& glb, std::size_t node) {
  return glb.json["meshes"][glb.json["nodes"][node]["mesh"].get<std::size_t>()]["primitives"][0];
}

/// The time of a key as the file has it, in single precision.
double seconds_of(double time) {
  return static_cast<double>(static_cast<float>(GlbOptions{}.duration_s * time));
}

/// What a reader of single precision makes of an attribute at a key: base and targets, each times its weight.
std::vector<std::array<float, 3>> blended(const GlbReader& glb, std::size_t node, const char* attribute,
                                          double seconds) {
  const nlohmann::json& primitive = primitive_of(glb, node);
  const std::size_t targets = primitive.contains("targets") ? primitive["targets"].size() : 0;
  const std::vector<double> weights = glb.property(node, "weights", seconds, std::vector<double>(targets, 0.0));
  EXPECT_EQ(weights.size(), targets);
  std::vector<std::array<float, 3>> result;
  for (const std::vector<float>& p : glb.floats(primitive["attributes"][attribute])) {
    result.push_back({p[0], p[1], p[2]});
  }
  for (std::size_t k = 0; k < targets; ++k) {
    const auto weight = static_cast<float>(weights[k]);
    EXPECT_TRUE(weight == 0.0f || weight == 1.0f) << weight;
    const std::vector<std::vector<float>> delta = glb.floats(primitive["targets"][k][attribute]);
    for (std::size_t i = 0; i < result.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        result[i][c] += weight * delta[i][c];
      }
    }
  }
  return result;
}

void expect_same_bits(const std::vector<std::array<float, 3>>& found, const std::vector<std::array<float, 3>>& wanted,
                      const std::string& where) {
  ASSERT_EQ(found.size(), wanted.size()) << where;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      // A sum never gives -0: 0 is as good.
      ASSERT_EQ(std::bit_cast<std::uint32_t>(found[i][c] + 0.0f), std::bit_cast<std::uint32_t>(wanted[i][c] + 0.0f))
          << where << " vertex " << i << ": " << found[i][c] << " for " << wanted[i][c];
    }
  }
}

std::vector<std::array<float, 3>> singles(const std::vector<Vec3>& positions_mm) {
  std::vector<std::array<float, 3>> result;
  for (const Vec3 p : positions_mm) {
    result.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  return result;
}

void expect_identity(const GlbReader& glb, std::size_t node, double seconds) {
  EXPECT_EQ(glb.property(node, "translation", seconds, {0, 0, 0}), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(glb.property(node, "rotation", seconds, {0, 0, 0, 1}), (std::vector<double>{0, 0, 0, 1}));
  EXPECT_EQ(glb.property(node, "scale", seconds, {1, 1, 1}), (std::vector<double>{1, 1, 1}));
}

TEST(ToGlbOfFrames, EveryVertexOfEveryKeyFrameIsTheGivenNumberToTheLastBit) {
  const Development development = grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const GlbReader glb(glb_of(development, frames));
  int born = 0;
  int unborn = 0;
  for (const Canopy& canopy : frames) {
    const double seconds = seconds_of(canopy.time);
    std::set<std::uint32_t> there;
    for (const OrganState& state : canopy.organs) {
      const std::string name = name_of(development, state.id);
      const std::size_t node = node_named(glb, name);
      expect_identity(glb, node, seconds);
      expect_same_bits(blended(glb, node, "POSITION", seconds), state.deformed_mm, name);
      there.insert(state.id.value);
      ++born;
    }
    for (const OrganState& state : frames.back().organs) {
      if (!there.contains(state.id.value)) {
        const std::size_t node = node_named(glb, name_of(development, state.id));
        EXPECT_EQ(glb.property(node, "scale", seconds, {1, 1, 1}), (std::vector<double>{0, 0, 0}));
        ++unborn;
      }
    }
    for (const Body& body : canopy.bodies) {
      const std::size_t node = node_named(glb, body.name);
      expect_identity(glb, node, seconds);
      expect_same_bits(blended(glb, node, "POSITION", seconds), singles(body.mesh.positions_mm), body.name);
    }
  }
  EXPECT_GT(born, 50);
  EXPECT_GT(unborn, 10);
}

TEST(ToGlbOfFrames, ReadsBackAsTheGivenTrianglesInEveryFrame) {
  const Development development = grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const Expected<CheckedMesh> mesh = read_mesh(glb_of(development, frames), "bent.glb");
  ASSERT_TRUE(mesh.has_value()) << to_string(mesh.error());
  ASSERT_EQ(mesh->times_s().size(), frames.size());
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    const MeshPose pose = mesh->pose(frame);
    std::map<std::string, std::vector<Vec3>> corners;  // of the triangles of each part that is seen
    for (std::size_t t = 0; t < mesh->triangles().size(); ++t) {
      const std::uint32_t part = mesh->part_of_triangle()[t];
      if (pose.shown[part] != 0) {
        for (const std::uint32_t vertex : mesh->triangles()[t]) {
          corners[mesh->parts()[part]].push_back(pose.positions[vertex]);
        }
      }
    }
    EXPECT_EQ(corners.size(), frames[frame].organs.size() + frames[frame].bodies.size());
    for (const OrganState& state : frames[frame].organs) {
      std::vector<Vec3> wanted;
      for (const Triangle& triangle :
           development.templates()[development.organs()[state.id.value - 1].template_index].triangles()) {
        for (const std::uint32_t vertex : triangle) {
          const std::array<float, 3>& p = state.deformed_mm[vertex];
          wanted.push_back({p[0], p[1], p[2]});
        }
      }
      ASSERT_EQ(corners[name_of(development, state.id)], wanted);
    }
  }
}

TEST(ToGlbOfFrames, NormalsOfEveryKeyFrameAreThoseOfTheBentSurface) {
  const Development development = grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const GlbReader glb(glb_of(development, frames));
  for (const Canopy& canopy : frames) {
    for (const OrganState& state : canopy.organs) {
      const OrganTemplate& shape = development.templates()[development.organs()[state.id.value - 1].template_index];
      std::vector<Vec3> positions_mm;
      for (const std::array<float, 3>& p : state.deformed_mm) {
        positions_mm.push_back({p[0], p[1], p[2]});
      }
      std::vector<Vec3> normals(positions_mm.size());
      smooth_normals(positions_mm, shape.triangles(), shape.twins(), normals);
      const std::vector<std::array<float, 3>> found =
          blended(glb, node_named(glb, name_of(development, state.id)), "NORMAL", seconds_of(canopy.time));
      for (std::size_t i = 0; i < found.size(); ++i) {
        const Vec3 n = {found[i][0], found[i][1], found[i][2]};
        EXPECT_NEAR(length(n), 1.0, 1e-6);
        EXPECT_LT(length(n - normals[i]), 1e-6);
      }
    }
  }
}

TEST(ToGlbOfFrames, VerticesMoveInStraightLinesAndNewbornsFromAPointAtTheirPlaceOfBirth) {
  const Development development = grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const GlbReader glb(glb_of(development, frames));
  int newborns = 0;
  for (std::size_t frame = 1; frame < frames.size(); ++frame) {
    const double seconds = 0.5 * (seconds_of(frames[frame - 1].time) + seconds_of(frames[frame].time));
    for (const OrganState& state : frames[frame].organs) {
      const auto before = std::find_if(frames[frame - 1].organs.begin(), frames[frame - 1].organs.end(),
                                       [&](const OrganState& s) { return s.id == state.id; });
      const bool newborn = before == frames[frame - 1].organs.end();
      newborns += newborn ? 1 : 0;
      const std::vector<Vec3> found = glb.positions_mm(node_named(glb, name_of(development, state.id)), seconds);
      for (std::size_t i = 0; i < found.size(); ++i) {
        const auto vector = [](const std::array<float, 3>& p) { return Vec3{p[0], p[1], p[2]}; };
        const Vec3 from = newborn ? state.world_from_organ.position_mm : vector(before->deformed_mm[i]);
        ASSERT_LT(length(found[i] - 0.5 * (from + vector(state.deformed_mm[i]))), 1e-4);
      }
    }
  }
  EXPECT_GT(newborns, 10);
}

TEST(ToGlbOfFrames, OrgansHaveAMeshEachAndShareIndicesTextureCoordinatesAndMaterialWithTheirTemplate) {
  const Development development = grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const GlbReader glb(glb_of(development, frames));
  const std::size_t bodies = frames.back().bodies.size();
  EXPECT_EQ(glb.json["meshes"].size(), development.organs().size() + bodies);
  EXPECT_EQ(glb.json["nodes"].size(), development.organs().size() + bodies + 1);
  std::map<std::uint32_t, std::set<std::array<int, 3>>> surfaces;
  for (const Organ& organ : development.organs()) {
    const nlohmann::json& primitive = primitive_of(glb, node_named(glb, name_of(development, organ.id)));
    surfaces[organ.template_index].insert({primitive["indices"].get<int>(),
                                           primitive["attributes"]["TEXCOORD_0"].get<int>(),
                                           primitive["material"].get<int>()});
  }
  EXPECT_GT(surfaces.size(), 1u);
  for (const auto& [t, different] : surfaces) {
    EXPECT_EQ(different.size(), 1u) << "template " << t;
  }
  EXPECT_EQ(glb.json["asset"]["extras"]["collisions"], "resolved");
  const nlohmann::json& node = glb.json["nodes"][node_named(glb, name_of(development, {5}))];
  EXPECT_EQ(node["extras"]["organ"], 5);
  EXPECT_NEAR(node["extras"]["age"].get<double>(), 1.0 - development.organs()[4].birth, 1e-6);
}

TEST(ToGlbOfFrames, AFrameInWhichAnOrganDoesNotChangeAddsNoTarget) {
  const Development development = grow_tiny();
  std::vector<Canopy> frames;
  for (const double time : {0.5, 0.6, 0.7, 0.8, 0.9}) {
    frames.push_back(bent(development, time < 0.75 ? 0.5 : 0.8));
    frames.back().time = time;
  }
  frames[4] = frames[3];
  frames[4].time = 0.9;
  const GlbReader glb(glb_of(development, frames));
  for (const OrganState& state : frames.front().organs) {
    const std::size_t node = node_named(glb, name_of(development, state.id));
    ASSERT_EQ(primitive_of(glb, node)["targets"].size(), 1u);
    EXPECT_EQ(glb.json["meshes"][glb.json["nodes"][node]["mesh"].get<std::size_t>()]["extras"]["targetNames"],
              nlohmann::json({"time 0.500"}));
    for (std::size_t frame = 0; frame < frames.size(); ++frame) {
      const double seconds = 4.0 * static_cast<double>(frame) / 4.0;
      expect_same_bits(blended(glb, node, "POSITION", seconds),
                       frame < 3 ? state.deformed_mm
                                 : std::find_if(frames[3].organs.begin(), frames[3].organs.end(),
                                                [&](const OrganState& s) { return s.id == state.id; })
                                       ->deformed_mm,
                       "frame " + std::to_string(frame));
    }
  }
}

TEST(ToGlbOfFrames, WithoutAnimationThePlantStandsAsInTheLastFrame) {
  const Development development = grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const GlbReader glb(glb_of(development, frames));
  for (const OrganState& state : frames.back().organs) {
    const std::size_t node = node_named(glb, name_of(development, state.id));
    for (const char* property : {"translation", "rotation", "scale", "weights", "matrix"}) {
      EXPECT_FALSE(glb.json["nodes"][node].contains(property)) << property;
    }
    std::vector<std::array<float, 3>> base;
    for (const std::vector<float>& p : glb.floats(primitive_of(glb, node)["attributes"]["POSITION"])) {
      base.push_back({p[0], p[1], p[2]});
    }
    expect_same_bits(base, state.deformed_mm, "base");
  }
}

TEST(ToGlbOfFrames, OneFrameIsAStillPlantWithoutTargets) {
  const Development development = grow_tiny();
  const std::array<Canopy, 1> frame = {bent(development, 0.6)};
  const GlbReader glb(glb_of(development, frame));
  EXPECT_FALSE(glb.json.contains("animations"));
  EXPECT_EQ(glb.json["asset"]["extras"]["time"], 0.6);
  EXPECT_EQ(glb.json["nodes"].size(), frame[0].organs.size() + frame[0].bodies.size() + 1);
  for (const nlohmann::json& mesh : glb.json["meshes"]) {
    EXPECT_FALSE(mesh["primitives"][0].contains("targets"));
  }
  for (const OrganState& state : frame[0].organs) {
    expect_same_bits(blended(glb, node_named(glb, name_of(development, state.id)), "POSITION", 0.0), state.deformed_mm,
                     "still");
  }
}

TEST(ToGlbOfFrames, CanopiesWithoutBentOrgansAreTakenToo) {
  const Development development = grow_tiny();
  std::vector<Canopy> frames;
  for (const double time : kTimes) {
    frames.push_back(development.at(time));
  }
  const GlbReader glb(glb_of(development, frames));
  EXPECT_FALSE(glb.json["asset"]["extras"].contains("collisions"));
  for (const OrganState& state : frames[2].organs) {
    const OrganTemplate& shape = development.templates()[development.organs()[state.id.value - 1].template_index];
    std::vector<Vec3> positions_mm(shape.vertex_count());
    std::vector<Vec3> normals(shape.vertex_count());
    shape.pose(state.stage, positions_mm, normals);
    const std::vector<Vec3> found =
        glb.positions_mm(node_named(glb, name_of(development, state.id)), seconds_of(frames[2].time));
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_LT(length(found[i] - apply(state.world_from_organ, positions_mm[i])), 1e-5);
    }
  }
}

TEST(ToGlbOfFrames, RefusesWhatIsNotOfTheDevelopmentOrCannotBeExact) {
  const Development development = grow_tiny();
  const auto refused = [&](const auto& spoil) {
    std::vector<Canopy> frames = {bent(development, 0.5), bent(development, 1.0)};
    GlbOptions options;
    spoil(frames, options);
    const Expected<std::string> bytes = to_glb(development, frames, options);
    return bytes ? std::string("accepted") : bytes.error().where;
  };
  EXPECT_EQ(refused([](std::vector<Canopy>&, GlbOptions&) {}), "accepted");
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) { frames.clear(); }), "frames");
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) { std::swap(frames[0], frames[1]); }), "frames");
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) { frames[1].time = 0.5; }), "frames");
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) {
              frames[0].time = 0.4;
              frames[1].time = 1.1;
            }),
            "time");
  EXPECT_EQ(refused([](std::vector<Canopy>&, GlbOptions& options) { options.duration_s = 0.0; }), "duration_s");
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) { frames[1].organs[2].deformed_mm.pop_back(); }),
            name_of(development, {3}));
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) { frames[1].organs[2].id.value = 1; }), "organ 1");
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) { frames[1].organs.back().id.value = 9999; }),
            "organ 9999");
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) {
              frames[1].organs[2].deformed_mm[0][1] = std::numeric_limits<float>::quiet_NaN();
            }),
            name_of(development, {3}));
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) {
              frames[1].bodies[0].mesh.positions_mm[0].z = std::numeric_limits<double>::infinity();
            }),
            "receptacle");
  // Both are exact; their difference takes 25 bits.
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) {
              frames[0].organs[2].deformed_mm[0][1] = -1023.0f;
              frames[1].organs[2].deformed_mm[0][1] = 1023.0f - 1.0f / 16384.0f;
            }),
            name_of(development, {3}));
  // Not a number of single precision.
  EXPECT_EQ(refused([](std::vector<Canopy>& frames, GlbOptions&) { frames[1].bodies[0].mesh.positions_mm[0].x = 0.1; }),
            "receptacle");
}

TEST(ToGlbOfFrames, SameBytesForAnyNumberOfThreadsAndCanBeCancelled) {
  const Development development = grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const std::string once = glb_of(development, frames);
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(glb_of(development, frames), once) << threads << " threads";
  }
  const Expected<std::string> bytes = to_glb(development, frames, {}, [](std::string_view, double) { return false; });
  ASSERT_FALSE(bytes.has_value());
  EXPECT_EQ(bytes.error().code, ErrorCode::kCancelled);
}

TEST(ExpectedPositionsOfFrames, AreTheGivenNumbersAndAgreeWithTheFile) {
  const Development development = grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const std::array<int, 3> sampled = {1, 2, 4};
  const Expected<std::string> text = expected_positions_json(development, frames, GlbOptions{}, sampled);
  ASSERT_TRUE(text.has_value());
  const nlohmann::json expected = nlohmann::json::parse(*text);
  const GlbReader glb(glb_of(development, frames));
  EXPECT_EQ(expected["organs"].size(), development.organs().size());
  EXPECT_EQ(expected["bodies"].size(), frames.back().bodies.size());
  EXPECT_EQ(expected["times_s"], nlohmann::json({1.0, 2.0, 4.0}));
  EXPECT_EQ(expected["duration_s"], 4.0);
  int compared = 0;
  for (const char* list : {"organs", "bodies"}) {
    for (const nlohmann::json& item : expected[list]) {
      EXPECT_LT(item["tolerance_m"].get<double>(), 1e-7);
      for (std::size_t i = 0; i < sampled.size(); ++i) {
        if (item["positions"][i].is_null()) {
          continue;
        }
        const std::vector<Vec3> found =
            glb.positions_mm(node_named(glb, item["name"]), expected["times_s"][i].get<double>());
        ASSERT_EQ(found.size(), item["vertex_count"].get<std::size_t>());
        for (std::size_t v = 0; v < item["vertices"].size(); ++v) {
          const Vec3 p = found[item["vertices"][v].get<std::size_t>()];
          const nlohmann::json& wanted = item["positions"][i][v];
          EXPECT_LE(length(0.001 * Vec3{p.x, p.z, -p.y} - Vec3{wanted[0], wanted[1], wanted[2]}), 1e-15);
          ++compared;
        }
      }
    }
  }
  EXPECT_GT(compared, 100);
  const std::array<int, 1> beyond = {5};
  EXPECT_EQ(expected_positions_json(development, frames, GlbOptions{}, beyond).error().where, "frames");
}

}  // namespace
}  // namespace anthesis
