#include "anthesis/exchange/obj.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "anthesis/base/parallel.h"
#include "bent_plant.h"
#include "tiny_species.h"

namespace anthesis {
namespace {

TEST(ToObj, ReadsBackWithEveryOrganAndEveryTriangle) {
  const Development development = test::grow_tiny();
  const Expected<ObjText> files = to_obj(development, 1.0, "tiny plant.mtl");
  ASSERT_TRUE(files.has_value());
  const Canopy canopy = development.at(1.0);

  std::set<std::string> objects;
  std::set<std::string> used_materials;
  std::size_t positions = 0;
  std::size_t uvs = 0;
  std::size_t normals = 0;
  std::size_t faces = 0;
  std::vector<Vec3> first_of_object;
  std::stringstream stream(files->obj);
  for (std::string line; std::getline(stream, line);) {
    std::stringstream words(line);
    std::string word;
    words >> word;
    if (word == "mtllib") {
      words >> word;
      EXPECT_EQ(word, "tiny_plant.mtl");
    } else if (word == "o") {
      words >> word;
      EXPECT_TRUE(objects.insert(word).second) << word;
      first_of_object.emplace_back(Vec3{1e9, 0.0, 0.0});
    } else if (word == "usemtl") {
      words >> word;
      used_materials.insert(word);
    } else if (word == "v") {
      Vec3 p;
      words >> p.x >> p.y >> p.z;
      ++positions;
      if (first_of_object.back().x == 1e9) {
        first_of_object.back() = p;
      }
    } else if (word == "vt") {
      ++uvs;
    } else if (word == "vn") {
      ++normals;
    } else if (word == "f") {
      ++faces;
      for (int corner = 0; corner < 3; ++corner) {
        std::size_t v = 0;
        std::size_t t = 0;
        std::size_t n = 0;
        char slash = 0;
        words >> v >> slash >> t >> slash >> n;
        // Everything a face names has been written before it.
        EXPECT_TRUE(v >= 1 && v <= positions && t >= 1 && t <= uvs && n >= 1 && n <= normals) << line;
      }
    }
  }
  std::size_t expected_vertices = 0;
  std::size_t expected_faces = 0;
  for (const OrganState& state : canopy.organs) {
    const OrganTemplate& shape = development.templates()[development.organs()[state.id.value - 1].template_index];
    expected_vertices += shape.vertex_count();
    expected_faces += shape.triangles().size();
  }
  for (const Body& body : canopy.bodies) {
    expected_vertices += body.mesh.positions_mm.size();
    expected_faces += body.mesh.triangles.size();
    EXPECT_TRUE(objects.contains(body.name));
  }
  EXPECT_EQ(objects.size(), canopy.organs.size() + canopy.bodies.size());
  EXPECT_EQ(positions, expected_vertices);
  EXPECT_EQ(normals, expected_vertices);
  EXPECT_EQ(faces, expected_faces);
  for (const std::string& material : used_materials) {
    EXPECT_THAT(files->mtl, testing::HasSubstr("newmtl " + material + "\n"));
  }

  const OrganState& state = canopy.organs.front();
  const OrganTemplate& shape = development.templates()[development.organs()[state.id.value - 1].template_index];
  std::vector<Vec3> posed(shape.vertex_count());
  std::vector<Vec3> unused(shape.vertex_count());
  shape.pose(state.stage, posed, unused);
  EXPECT_LT(length(first_of_object.front() - apply(state.world_from_organ, posed.front())), 1e-4);
}

TEST(ToObj, StatesBentOrgansAndTheirBodiesSoThatTheyReadBackToTheLastBit) {
  const Development development = test::grow_tiny();
  const Canopy canopy = test::bent(development, 0.7);
  const Expected<ObjText> files = to_obj(development, canopy, "bent.mtl");
  ASSERT_TRUE(files.has_value());
  EXPECT_THAT(files->obj, testing::HasSubstr("\n# collisions: resolved\n"));
  EXPECT_THAT(files->mtl, testing::HasSubstr("\n# collisions: resolved\n"));
  std::vector<float> wanted;
  for (const OrganState& state : canopy.organs) {
    for (const std::array<float, 3>& p : state.deformed_mm) {
      wanted.insert(wanted.end(), p.begin(), p.end());
    }
  }
  for (const Body& body : canopy.bodies) {
    for (const Vec3 p : body.mesh.positions_mm) {
      wanted.insert(wanted.end(), {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
  }
  std::size_t next = 0;
  std::stringstream stream(files->obj);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("v ")) {
      std::stringstream words(line.substr(2));
      for (std::string word; words >> word; ++next) {
        ASSERT_LT(next, wanted.size());
        ASSERT_EQ(std::stof(word), wanted[next]) << line;
      }
    }
  }
  EXPECT_EQ(next, wanted.size());
}

TEST(ToObj, OfACanopyIsThatOfItsTime) {
  const Development development = test::grow_tiny();
  EXPECT_EQ(to_obj(development, development.at(0.4), "a.mtl")->obj, to_obj(development, 0.4, "a.mtl")->obj);
}

TEST(ToObj, SameBytesForAnyNumberOfThreads) {
  const Development development = test::grow_tiny();
  const std::string once = to_obj(development, 0.5, "a.mtl")->obj;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(to_obj(development, 0.5, "a.mtl")->obj, once);
  }
}

}  // namespace
}  // namespace anthesis
