#include "anthesis/phyllotaxis/meristem_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A flat meristem on which everything grows by e^20 from time 0 to 1, and elements become what it was at its
/// beginning when they are as large.
MeristemTreeParams self_similar() {
  const auto uniform = GrowthFunction::from_rate(FunctionGraph({{0.0, 5.0}, {1.0, 5.0}}));
  MeristemLevel level;
  level.dynamics.mode = MeristemMode::kSegregation;
  level.dynamics.profiles = {{0.0, {{0, 0}, {1, 0}}}};
  level.dynamics.meristem_growth = uniform;
  level.dynamics.area_growth = uniform;
  level.dynamics.meristem_area_mm2 = 5.0;
  level.dynamics.threshold_area_mm2 = 7.0;
  level.onset_area_mm2 = 5.0;
  return {{level}, 3, 0.7};
}

/// A cone whose elements are steeper cones with elements of their own, all from the rim upwards.
MeristemTreeParams cones() {
  MeristemLevel whole;
  whole.dynamics.profiles = {{0.0, {{0, 2}, {1, 0}}}};
  whole.dynamics.interval = 0.02;
  whole.dynamics.meristem_area_mm2 = 30.0;
  whole.dynamics.area_growth = FunctionGraph({{0.0, 0.6}, {0.5, 1.0}, {1.0, 1.0}});
  MeristemLevel part;
  part.dynamics.profiles = {{0.0, {{0, 1.5}, {1, 0}}}, {0.5, {{0, 4}, {1, 0}}}};
  part.dynamics.interval = 0.03;
  part.dynamics.meristem_area_mm2 = 20.0;
  part.onset_age = 0.2;
  return {{whole, part}, 2, 0.7};
}

MeristemTree run(const MeristemTreeParams& params) {
  auto tree = MeristemTree::run(params, 100'000);
  EXPECT_TRUE(tree);
  return std::move(*tree);
}

Placement inverse(const Placement& placement) {
  Placement result;
  result.rotation = conjugate(placement.rotation);
  result.scale = 1.0 / placement.scale;
  result.position_mm = -result.scale * rotate(result.rotation, placement.position_mm);
  return result;
}

double distance(const Placement& a, const Placement& b) {
  const double turn = std::abs(a.rotation.w * b.rotation.w + a.rotation.x * b.rotation.x + a.rotation.y * b.rotation.y +
                               a.rotation.z * b.rotation.z);
  return length(a.position_mm - b.position_mm) + std::abs(a.scale - b.scale) + std::abs(1.0 - turn);
}

/// Elements of an element born by `time`, in order of birth.
std::vector<std::uint32_t> children_of(const MeristemTree& tree, std::uint32_t parent, double time) {
  std::vector<std::uint32_t> children;
  for (std::uint32_t i = 0; i < tree.born(time); ++i) {
    if (tree.elements()[i].parent == parent && i != 0) {
      children.push_back(i);
    }
  }
  return children;
}

/// How far a part of one tree is from being similar to a part of another, element by element.
double dissimilarity(const MeristemTree& a, std::span<const Placement> a_places, std::uint32_t a_part, double a_time,
                     const MeristemTree& b, std::span<const Placement> b_places, std::uint32_t b_part, double b_time) {
  const auto a_children = children_of(a, a_part, a_time);
  const auto b_children = children_of(b, b_part, b_time);
  if (a_children.size() != b_children.size()) {
    return kNever;
  }
  double worst = 0.0;
  for (std::size_t k = 0; k < a_children.size(); ++k) {
    const Placement in_a = inverse(a_places[a_part]) * a_places[a_children[k]];
    const Placement in_b = inverse(b_places[b_part]) * b_places[b_children[k]];
    worst = std::max({worst, distance(in_a, in_b),
                      dissimilarity(a, a_places, a_children[k], a_time, b, b_places, b_children[k], b_time)});
  }
  return worst;
}

TEST(MeristemTree, APartOfSomeAgeIsTheWholeAtThatAgeUpToSimilarity) {
  MeristemTreeParams curved = self_similar();
  curved.levels[0].dynamics.profiles = {{0.0, {{0, 1}, {1, 1}, {1, 0}}}, {0.3, {{0, 2}, {1, 1}, {1, 0}}}};
  curved.levels[0].dynamics.area_growth = FunctionGraph({{0.0, 1.0}, {0.4, 4.0}, {1.0, 10.0}});
  for (const MeristemTreeParams& params : {self_similar(), curved}) {
    const MeristemTree tree = run(params);
    MeristemTreeParams shallower = params;
    shallower.depth = params.depth - 1;  // below a part there is a level less than below the whole
    const MeristemTree whole = run(shallower);
    const auto places = tree.places(1.0);
    int parts_with_parts = 0;
    for (std::uint32_t part = 1; part < places.size(); ++part) {
      const double age = 1.0 - tree.elements()[part].onset;
      if (tree.elements()[part].level == 1 && age >= 0.0) {
        EXPECT_LT(dissimilarity(tree, places, part, 1.0, whole, whole.places(age), 0, age), 1e-9);
        parts_with_parts += children_of(tree, part, 1.0).size() > 5;
      }
    }
    EXPECT_GT(parts_with_parts, 5);
  }
}

TEST(MeristemTree, UniformGrowthOnlyEnlargesWhatIsThere) {
  const MeristemTree tree = run(self_similar());
  const auto before = tree.places(0.8);
  const auto after = tree.places(0.93);
  ASSERT_GT(before.size(), 30u);
  ASSERT_GT(after.size(), before.size());
  const double factor = math::exp(5.0 * 0.13 / 2.0);  // of lengths; areas grow by its square
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(after[i].scale / before[i].scale, factor, 1e-9);
    EXPECT_LT(length(after[i].position_mm - factor * before[i].position_mm), 1e-9 * after[0].scale);
  }
}

TEST(MeristemTree, FlatMeristemsLieInOnePlaneAndPartsKeepWithinTheirParents) {
  const MeristemTree tree = run(self_similar());
  const auto places = tree.places(1.0);
  std::uint32_t deepest = 0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Placement& parent = places[tree.elements()[i].parent];
    deepest = std::max(deepest, tree.elements()[i].level);
    EXPECT_EQ(places[i].position_mm.z, 0.0);
    EXPECT_LT(length(rotate(places[i].rotation, {0, 0, 1}) - Vec3{0, 0, 1}), 1e-12);
    EXPECT_LT(length(places[i].position_mm - parent.position_mm), parent.scale);
    EXPECT_LT(places[i].scale, parent.scale);
  }
  EXPECT_EQ(deepest, 3u);
}

TEST(MeristemTree, AnElementBecomesAMeristemWhenItsAreaIsReached) {
  const MeristemTreeParams params = self_similar();
  const MeristemTree tree = run(params);
  for (const MeristemElement& element : tree.elements()) {
    if (element.level == 0) {
      EXPECT_EQ(element.onset, 0.0);
    } else if (element.level == 3) {
      EXPECT_EQ(element.onset, kNever);
    } else if (element.onset <= 1.0) {
      EXPECT_NEAR(params.levels[0].dynamics.area_growth(element.onset - element.birth), 5.0, 1e-12);
    } else {
      EXPECT_LT(params.levels[0].dynamics.area_growth(1.0 - element.birth), 5.0);
    }
  }
}

TEST(MeristemTree, AnElementBecomesAMeristemAtItsAge) {
  const MeristemTree tree = run(cones());
  for (const MeristemElement& element : tree.elements()) {
    if (element.level == 1) {
      EXPECT_EQ(element.onset, element.birth + 0.2 <= 1.0 ? element.birth + 0.2 : kNever);
    }
  }
}

TEST(MeristemTree, AgeAndAreaMustBothBeReached) {
  MeristemTreeParams params = self_similar();
  const double age_at_area = math::log(5.0) / 5.0;
  for (const double age : {0.9 * age_at_area, 1.1 * age_at_area}) {
    params.levels[0].onset_age = age;
    const MeristemElement first = run(params).elements()[1];
    EXPECT_NEAR(first.onset - first.birth, std::max(age, age_at_area), 1e-12);
  }
}

TEST(MeristemTree, ElementsOfTheLastLevelNeverBecomeMeristems) {
  MeristemTreeParams params = self_similar();
  params.depth = 1;
  const MeristemTree tree = run(params);
  EXPECT_EQ(tree.elements().size(), 1 + tree.dynamics(0).primordia().size());
  for (const MeristemElement& element : tree.elements().subspan(1)) {
    EXPECT_EQ(element.level, 1u);
    EXPECT_EQ(element.onset, kNever);
  }
}

TEST(MeristemTree, FirstElementOfAPartLiesAsFarAsPossibleFromTheCentreOfTheWhole) {
  for (const MeristemTreeParams& params : {self_similar(), cones()}) {
    const MeristemTree tree = run(params);
    const double time = 0.97;
    const auto places = tree.places(time);
    int checked = 0;
    for (std::uint32_t part = 1; part < places.size(); ++part) {
      const auto children = children_of(tree, part, time);
      if (children.empty()) {
        continue;
      }
      const std::uint32_t carrier = tree.elements()[part].parent;
      const Vec2 apex = tree.surface(carrier, time).profile_mm().at(0.0);
      const Vec3 centre = apply(places[carrier], {0.0, 0.0, apex.y});
      const Vec3 first = (inverse(places[part]) * places[children[0]]).position_mm;  // in the part's own frame
      const double far = length(apply(places[part], first) - centre);
      const double radius = std::hypot(first.x, first.y);
      EXPECT_LT(std::abs(first.y), 1e-12 * radius);
      for (int step = 1; step < 360; ++step) {
        const auto [sine, cosine] = math::sin_cos(math::radians(step));
        const Vec3 elsewhere{radius * cosine, radius * sine, first.z};
        EXPECT_LT(length(apply(places[part], elsewhere) - centre), far);
      }
      ++checked;
    }
    EXPECT_GT(checked, 20);
  }
}

TEST(MeristemTree, ElementsStandUprightOnTheSurfaceOfTheirParent) {
  const MeristemTree tree = run(cones());
  const double time = 0.9;
  const auto places = tree.places(time);
  for (std::uint32_t i = 1; i < places.size(); ++i) {
    const std::uint32_t parent = tree.elements()[i].parent;
    const Placement in_parent = inverse(places[parent]) * places[i];
    const SurfaceOfRevolution surface = tree.surface(parent, time);
    const double height = surface.profile_mm().at(0.0).y;
    const Vec3 p = in_parent.position_mm;
    const double radius = std::hypot(p.x, p.y);
    EXPECT_NEAR(p.z, height * (1.0 - radius), 1e-9);  // a straight cone over the unit circle
    const Vec3 outward{p.x / radius, p.y / radius, 0.0};
    const Vec3 normal = normalized(height * outward + Vec3{0.0, 0.0, 1.0});
    EXPECT_LT(length(rotate(in_parent.rotation, {0, 0, 1}) - normal), 1e-9);
    EXPECT_NEAR(std::abs(math::atan2(p.y, p.x) - tree.elements()[i].azimuth_rad), 0.0, math::kTurnRad * 1.001);
    EXPECT_NEAR(math::cos(math::atan2(p.y, p.x) - tree.elements()[i].azimuth_rad), 1.0, 1e-12);
  }
}

TEST(MeristemTree, ARimEnclosesItsShareOfTheElementsArea) {
  const MeristemTree tree = run(cones());
  const double time = 0.9;
  const auto places = tree.places(time);
  const SurfaceOfRevolution whole = tree.dynamics(0).surface(time);
  EXPECT_NEAR(places[0].scale, whole.profile_mm().at(1.0).x, 1e-12);
  const auto bands = tree.dynamics(0).places(time, whole);
  const auto children = children_of(tree, 0, time);
  ASSERT_EQ(children.size(), bands.size());
  for (std::size_t k = 0; k < bands.size(); ++k) {
    const double radius = places[children[k]].scale;
    EXPECT_NEAR(math::kPi * radius * radius / bands[k].area_mm2, 0.7, 1e-12);
  }
}

TEST(MeristemTree, ExactlyTheElementsBornByATimeAreThere) {
  for (const MeristemTreeParams& params : {self_similar(), cones()}) {
    const MeristemTree tree = run(params);
    const auto elements = tree.elements();
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (i > 0) {
        EXPECT_LT(elements[i].parent, i);
        EXPECT_GE(elements[i].birth, elements[i - 1].birth);
        EXPECT_EQ(elements[i].level, elements[elements[i].parent].level + 1);
      }
      for (const double time : {std::nextafter(elements[i].birth, 0.0), elements[i].birth}) {
        // The tree's count by time and each meristem's own by age must agree, to the last bit.
        std::vector<std::size_t> children(elements.size());
        for (std::size_t k = 1; k < tree.born(time); ++k) {
          ++children[elements[k].parent];
        }
        for (std::size_t k = 0; k < tree.born(time); ++k) {
          if (elements[k].onset <= time) {
            EXPECT_EQ(children[k], tree.dynamics(elements[k].level).born(time - elements[k].onset));
          }
        }
      }
    }
    EXPECT_EQ(tree.born(1.0), elements.size());
    EXPECT_EQ(tree.places(1.0).size(), elements.size());
  }
}

TEST(MeristemTree, NothingDependsOnWhichTimesAreAskedFor) {
  const MeristemTree tree = run(cones());
  const auto direct = tree.places(0.6);
  for (int frame = 0; frame < 20; ++frame) {
    tree.places(frame / 20.0);
  }
  const auto again = tree.places(0.6);
  ASSERT_EQ(direct.size(), again.size());
  for (std::size_t i = 0; i < direct.size(); ++i) {
    EXPECT_EQ(direct[i].position_mm, again[i].position_mm);
    EXPECT_EQ(direct[i].rotation, again[i].rotation);
  }
}

TEST(MeristemTree, RefusesMoreElementsThanTheLimit) {
  const auto tree = MeristemTree::run(self_similar(), 50);
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.error().code, ErrorCode::kTooLarge);
  EXPECT_EQ(tree.error().where, "depth");
}

TEST(CheckMeristemTree, NamesWhatIsWrong) {
  MeristemTreeParams params = cones();
  params.levels[1].dynamics.profiles[1].controls[1].x = 0.0;
  params.levels[1].dynamics.profiles[1].controls[0].x = 1.0;
  EXPECT_EQ(check(params)->where, "levels[1].receptacle[1].points");
  params = cones();
  params.levels[1].onset_age = -0.1;
  EXPECT_EQ(check(params)->where, "levels[1].onset_age");
  params = cones();
  params.levels[0].dynamics.interval = 0.0;
  EXPECT_EQ(check(params)->where, "levels[0].interval");
  params = cones();
  params.depth = 0;
  EXPECT_EQ(check(params)->where, "depth");
  params = cones();
  params.fill = 1.5;
  EXPECT_EQ(check(params)->where, "fill");
  EXPECT_EQ(check(MeristemTreeParams{})->where, "levels");
}

}  // namespace
}  // namespace anthesis
