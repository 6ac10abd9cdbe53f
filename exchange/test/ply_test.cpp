#include "anthesis/exchange/ply.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <set>

#include "anthesis/base/parallel.h"
#include "bent_plant.h"
#include "tiny_species.h"

namespace anthesis {
namespace {

TEST(ToPly, ReadsBackWithEveryOrganColourAndTriangle) {
  const Development development = test::grow_tiny();
  const Expected<std::string> bytes = to_ply(development, 1.0);
  ASSERT_TRUE(bytes.has_value());
  const std::string end = "end_header\n";
  const std::size_t start = bytes->find(end) + end.size();
  const std::string header = bytes->substr(0, start);
  EXPECT_THAT(header, testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(header, testing::HasSubstr("comment kind 1: floret\n"));
  const auto count = [&](const std::string& element) {
    return std::stoul(header.substr(header.find("element " + element + " ") + element.size() + 9));
  };
  const std::size_t vertices = count("vertex");
  const std::size_t faces = count("face");
  constexpr std::size_t kVertexBytes = 35;
  constexpr std::size_t kFaceBytes = 13;
  ASSERT_EQ(bytes->size(), start + vertices * kVertexBytes + faces * kFaceBytes);

  std::set<std::int32_t> organs;
  for (std::size_t i = 0; i < vertices; ++i) {
    const char* vertex = bytes->data() + start + i * kVertexBytes;
    float n[3];
    std::int32_t organ = 0;
    std::int32_t kind = 0;
    std::memcpy(n, vertex + 12, 12);
    std::memcpy(&organ, vertex + 27, 4);
    std::memcpy(&kind, vertex + 31, 4);
    organs.insert(organ);
    EXPECT_NEAR(std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), 1.0, 1e-5);
    EXPECT_EQ(kind, organ == 0 ? -1 : static_cast<std::int32_t>(development.organs()[organ - 1].kind));
  }
  EXPECT_EQ(organs.size(), development.organs().size() + 1);  // and 0 for the bodies
  for (std::size_t i = 0; i < faces; ++i) {
    const char* face = bytes->data() + start + vertices * kVertexBytes + i * kFaceBytes;
    EXPECT_EQ(face[0], 3);
    std::uint32_t corners[3];
    std::memcpy(corners, face + 1, 12);
    for (const std::uint32_t corner : corners) {
      EXPECT_LT(corner, vertices);
    }
  }

  // The first vertex of all, in the world.
  const OrganState state = development.at(1.0).organs.front();
  const OrganTemplate& shape = development.templates()[development.organs()[state.id.value - 1].template_index];
  std::vector<Vec3> posed(shape.vertex_count());
  std::vector<Vec3> unused(shape.vertex_count());
  shape.pose(state.stage, posed, unused);
  const Vec3 wanted = apply(state.world_from_organ, posed.front());
  float p[3];
  std::memcpy(p, bytes->data() + start, 12);
  EXPECT_LT(length(Vec3{p[0], p[1], p[2]} - wanted), 1e-4);
}

TEST(ToPly, SameBytesForAnyNumberOfThreads) {
  const Development development = test::grow_tiny();
  const std::string once = *to_ply(development, 0.5);
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(*to_ply(development, 0.5), once);
  }
}

TEST(ToPly, StatesBentOrgansAndTheirBodiesToTheLastBit) {
  const Development development = test::grow_tiny();
  const Canopy canopy = test::bent(development, 0.7);
  const Expected<std::string> bytes = to_ply(development, canopy);
  ASSERT_TRUE(bytes.has_value());
  const std::string end = "end_header\n";
  const std::size_t start = bytes->find(end) + end.size();
  EXPECT_THAT(bytes->substr(0, start), testing::HasSubstr("comment collisions: resolved\n"));
  EXPECT_THAT(to_ply(development, 0.7)->substr(0, start), testing::Not(testing::HasSubstr("collisions")));
  std::vector<std::array<float, 3>> wanted;
  for (const OrganState& state : canopy.organs) {
    wanted.insert(wanted.end(), state.deformed_mm.begin(), state.deformed_mm.end());
  }
  for (const Body& body : canopy.bodies) {
    for (const Vec3 p : body.mesh.positions_mm) {
      wanted.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
      EXPECT_EQ(wanted.back()[2], p.z);
    }
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    ASSERT_EQ(std::memcmp(bytes->data() + start + 35 * i, wanted[i].data(), 12), 0) << "vertex " << i;
  }
}

TEST(ToPly, OfACanopyIsThatOfItsTime) {
  const Development development = test::grow_tiny();
  EXPECT_EQ(*to_ply(development, development.at(0.4)), *to_ply(development, 0.4));
}

TEST(ToPly, RefusesCanopiesOfAnotherPlant) {
  const Development development = test::grow_tiny();
  Canopy canopy = test::bent(development, 0.7);
  canopy.organs.front().deformed_mm.pop_back();
  EXPECT_EQ(to_ply(development, canopy).error().code, ErrorCode::kInvalidParameter);
}

TEST(ToPly, RefusesTimesOutsideTheDevelopment) {
  EXPECT_EQ(to_ply(test::grow_tiny(), 2.0).error().where, "time");
}

}  // namespace
}  // namespace anthesis
