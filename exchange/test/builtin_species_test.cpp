#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "anthesis/exchange/species_file.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {
namespace {

class BuiltinSpeciesTest : public testing::TestWithParam<std::string> {};

std::size_t count(const Development& development, const std::string& kind) {
  std::size_t n = 0;
  for (const Organ& organ : development.organs()) {
    n += development.species().organs[organ.kind].name == kind;
  }
  return n;
}

TEST_P(BuiltinSpeciesTest, NoTriangleIsDegenerateOrInvertedAtAnyStage) {
  const Development development = *Development::grow(*find_species(GetParam()), {});
  for (std::size_t index = 0; index < development.templates().size(); ++index) {
    const OrganTemplate& organ = development.templates()[index];
    std::vector<Vec3> positions(organ.vertex_count());
    std::vector<Vec3> normals(organ.vertex_count());
    for (int step = 0; step <= 50; ++step) {
      organ.pose(step / 50.0, positions, normals);
      // Each petal by itself: where margins meet, the common normal belongs to neither side.
      smooth_normals(positions, organ.triangles(), {}, normals);
      for (const TemplateGroup& group : organ.groups()) {
        for (std::uint32_t k = group.first_triangle; k < group.first_triangle + group.triangle_count; ++k) {
          const Triangle& t = organ.triangles()[k];
          const Vec3 normal = area_vector(positions, t);
          double longest = 0.0;
          for (int i = 0; i < 3; ++i) {
            longest = std::max(longest, length(positions[t[(i + 1) % 3]] - positions[t[i]]));
          }
          ASSERT_GT(length(normal), 1e-3 * longest * longest) << group.name << " of template " << index << " at stage "
                                                              << step / 50.0 << ", v = " << organ.uvs()[t[0]].y;
          // A vertex normal is the mean of the faces about it: a face that turns from it has folded over.
          const Vec3 mean = normals[t[0]] + normals[t[1]] + normals[t[2]];
          ASSERT_GT(dot(normal, mean), 0.0) << group.name << " of template " << index << " at stage " << step / 50.0
                                            << ", v = " << organ.uvs()[t[0]].y;
        }
      }
    }
  }
}

TEST_P(BuiltinSpeciesTest, HasAFibonacciNumberOfRays) {
  const Development development = *Development::grow(*find_species(GetParam()), {});
  EXPECT_EQ(count(development, "ray_floret"), 34u);
  EXPECT_GE(count(development, "disk_floret"), 100u);
  EXPECT_GE(count(development, "bract"), 13u);
}

TEST_P(BuiltinSpeciesTest, DisksOpenFromTheRimAndAreNotAllOpenInBloom) {
  const Development development = *Development::grow(*find_species(GetParam()), {});
  const Canopy canopy = development.at(1.0);
  double outer = 0.0;
  double inner = 0.0;
  int outer_count = 0;
  int inner_count = 0;
  for (const OrganState& organ : canopy.organs) {
    if (development.species().organs[development.organs()[organ.id.value - 1].kind].name == "disk_floret") {
      (organ.s > 0.4 ? outer : inner) += organ.stage;
      ++(organ.s > 0.4 ? outer_count : inner_count);
    }
  }
  EXPECT_GT(outer / outer_count, inner / inner_count + 0.2);
}

TEST_P(BuiltinSpeciesTest, IsABudBeforeItIsABloom) {
  // The rays of the bud stand within the bracts; in bloom they reach far beyond them.
  const Development development = *Development::grow(*find_species(GetParam()), {});
  const auto reach = [&](double time, const std::string& kind) {
    double farthest = 0.0;
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;
    for (const OrganState& state : development.at(time).organs) {
      const Organ& organ = development.organs()[state.id.value - 1];
      if (development.species().organs[organ.kind].name != kind) {
        continue;
      }
      const OrganTemplate& shape = development.templates()[organ.template_index];
      positions.resize(shape.vertex_count());
      normals.resize(shape.vertex_count());
      shape.pose(state.stage, positions, normals);
      for (const Vec3 p : positions) {
        const Vec3 world = apply(state.world_from_organ, p);
        farthest = std::max(farthest, length(Vec2{world.x, world.y}));
      }
    }
    return farthest;
  };
  EXPECT_LT(reach(0.35, "ray_floret"), reach(0.35, "bract"));
  EXPECT_GT(reach(1.0, "ray_floret"), 1.1 * reach(1.0, "bract"));
}

TEST_P(BuiltinSpeciesTest, StamensThenPistilsRiseAboveThePetals) {
  const Species species = *find_species(GetParam());
  const auto kind = std::ranges::find(species.organs, "disk_floret", &OrganKind::name);
  const OrganTemplate floret = *OrganTemplate::build(kind->shape, 1.0, 1, 0);
  const auto top_mm = [&](double stage, std::initializer_list<std::string_view> parts) {
    std::vector<Vec3> positions(floret.vertex_count());
    std::vector<Vec3> normals(floret.vertex_count());
    floret.pose(stage, positions, normals);
    double top = 0.0;
    for (const TemplateGroup& group : floret.groups()) {
      if (std::ranges::find(parts, group.name) != parts.end()) {
        for (std::uint32_t i = group.first_vertex; i < group.first_vertex + group.vertex_count; ++i) {
          top = std::max(top, positions[i].z);
        }
      }
    }
    return top;
  };
  const auto corolla = [&](double stage) { return top_mm(stage, {"corolla"}); };
  const auto stamens = [&](double stage) { return top_mm(stage, {"stamens"}); };
  const auto pistil = [&](double stage) { return top_mm(stage, {"style", "stigma"}); };
  EXPECT_LT(std::max(stamens(0.0), pistil(0.0)), corolla(0.0));  // all within the bud
  EXPECT_GT(stamens(0.6), corolla(0.6));
  EXPECT_LT(pistil(0.6), stamens(0.6));
  EXPECT_GT(pistil(1.0), stamens(1.0));
  EXPECT_GT(pistil(1.0), corolla(1.0));
}

INSTANTIATE_TEST_SUITE_P(Species, BuiltinSpeciesTest, testing::Values("sunflower", "daisy"),
                         [](const auto& test) { return test.param; });

class GalleryTest : public testing::TestWithParam<std::string> {};

TEST_P(GalleryTest, MostOfItsHeadIsAFibonacciSpiral) {
  const Expected<Species> species = find_species(GetParam());
  ASSERT_TRUE(species) << to_string(species.error());
  const Expected<Development> development = Development::grow(*species, {});
  ASSERT_TRUE(development) << to_string(development.error());
  const Parastichies found = analyse_parastichies(pattern_of(*development, 1.0));
  std::size_t spiral = 0;
  std::size_t all = 0;
  for (const ParastichyRegion& region : found.regions) {
    all += region.organs;
    spiral += region.kind.series == ParastichySeries::kFibonacci ? region.organs : 0;
  }
  EXPECT_GT(4 * spiral, 3 * all - 12);  // a whorl at the foot of a small head is not
  EXPECT_NEAR(found.divergence.mean_rad, kGoldenAngleRad, 1e-9);
}

/// Those whose divergence is given, not those where it comes about.
std::vector<std::string> all_spirals() {
  std::vector<std::string> names;
  for (const BuiltinSpecies& species : builtin_species()) {
    if (find_species(std::string(species.name))->head.rule != PlacementRule::kActiveRing) {
      names.emplace_back(species.name);
    }
  }
  return names;
}

std::string plain(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Species, GalleryTest, testing::ValuesIn(all_spirals()), plain);

/// Scale against s, apex first, of the organs of a kind on the plant's own head.
std::vector<Vec2> sizes_of(const Development& development, const std::string& kind) {
  std::vector<Vec2> sizes;
  for (const OrganState& state : development.at(1.0).organs) {
    const Organ& organ = development.organs()[state.id.value - 1];
    if (development.species().organs[organ.kind].name == kind) {
      sizes.push_back({state.s, std::sqrt(state.area_mm2)});
    }
  }
  std::sort(sizes.begin(), sizes.end(), [](Vec2 a, Vec2 b) { return a.x < b.x; });
  return sizes;
}

// F92 fig. 4.
TEST(Gallery, DiskFloretsOfTheConeflowerShrinkLinearlyTowardsTheTip) {
  const Development coneflower = *Development::grow(*find_species("green-coneflower"), {});
  const std::vector<Vec2> sizes = sizes_of(coneflower, "disk_floret");
  ASSERT_GT(sizes.size(), 100u);
  const Vec2 first = sizes.front();
  const Vec2 last = sizes.back();
  EXPECT_LT(first.y, 0.8 * last.y);
  for (const Vec2 size : sizes) {
    const double linear = first.y + (last.y - first.y) * (size.x - first.x) / (last.x - first.x);
    EXPECT_NEAR(size.y, linear, 0.02 * last.y);
  }
}

// F92 figs. 8 to 12: patterns on the organs of patterns.
TEST(Gallery, OrgansCarryPatternsLevelByLevel) {
  const std::pair<const char*, int> plants[] = {
      {"goatsbeard", 2}, {"mammillaria-geminispina", 2}, {"cauliflower", 3}, {"broccoli", 3}, {"pot-of-daisies", 2}};
  for (const auto& [name, levels] : plants) {
    const Development plant = *Development::grow(*find_species(name), {});
    int deepest = 0;
    std::vector<int> level(plant.organs().size() + 1);
    for (const Organ& organ : plant.organs()) {
      level[organ.id.value] = level[organ.parent.value] + 1;
      deepest = std::max(deepest, level[organ.id.value]);
    }
    EXPECT_GE(deepest, levels) << name;
  }
}

}  // namespace
}  // namespace anthesis
