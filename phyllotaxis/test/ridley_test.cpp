#include "anthesis/phyllotaxis/ridley.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "anthesis/base/math.h"
#include "anthesis/base/random.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {
namespace {

/// Area of the band between two profile parameters by a composite Simpson rule: independent of the surface's own
/// tables.
double band_area_mm2(const SurfaceOfRevolution& surface, double from, double to) {
  constexpr int kSteps = 64;  // even
  const auto density = [&](double t) { return math::kTurnRad * surface.radius_mm(t) * surface.speed_mm(t); };
  double sum = density(from) + density(to);
  for (int i = 1; i < kSteps; ++i) {
    sum += (i % 2 == 1 ? 4.0 : 2.0) * density(from + (to - from) * i / kSteps);
  }
  return std::abs(to - from) / kSteps / 3.0 * sum;
}

struct Case {
  const char* name;
  SurfaceOfRevolution surface;
};

std::vector<Case> surfaces() {
  // A quarter circle as a quintic Bezier curve is no circle; what counts is that the surface is round and smooth.
  return {{"disk", {{{0, 0}, {4, 0}}, 1}},
          {"sphere", {{{0, 1}, {0.55, 1}, {1, 0.55}, {1, 0}, {1, -0.55}, {0.55, -1}, {0, -1}}, 3}},
          {"cone", {{{0, 5}, {2, 0}}, 1}},
          {"concave", {{{0, 0}, {1, 0.1}, {1.2, 1.5}, {2.5, 2}, {3, 1.2}}, 3}}};
}

TEST(PlaceOrgans, BandsHaveTheirAreas) {
  for (const Case& c : surfaces()) {
    Rng rng(6, 0, RandomPurpose::kTest);
    std::vector<double> areas(300);
    for (double& area : areas) {
      area = rng.uniform(0.5, 1.5);
    }
    const double sum = std::accumulate(areas.begin(), areas.end(), 0.0);
    for (double& area : areas) {
      area *= c.surface.area_mm2() / sum;
    }
    std::vector<double> t(areas.size());
    ASSERT_EQ(place_organs(c.surface, areas, SpiralDirection::kFromApex, t), areas.size()) << c.name;
    for (std::size_t i = 0; i + 1 < areas.size(); ++i) {
      const double expected = 0.5 * (areas[i] + areas[i + 1]);
      // Split at the profile's knots, where Simpson's rule would lose its order.
      double area = 0.0;
      double from = t[i];
      for (const double knot : c.surface.profile_mm().knots()) {
        if (knot > from && knot < t[i + 1]) {
          area += band_area_mm2(c.surface, from, knot);
          from = knot;
        }
      }
      area += band_area_mm2(c.surface, from, t[i + 1]);
      EXPECT_NEAR(area / expected, 1.0, 1e-9) << c.name << ", organ " << i;
    }
  }
}

TEST(PlaceOrgans, AHundredThousandOrgansMeetTheirAreasToo) {
  const SurfaceOfRevolution surface = surfaces()[3].surface;
  constexpr std::size_t kCount = 100'000;
  const std::vector<double> areas(kCount, surface.area_mm2() / kCount);
  std::vector<double> t(kCount);
  ASSERT_EQ(place_organs(surface, areas, SpiralDirection::kFromApex, t), kCount);
  for (std::size_t i = 0; i + 1 < kCount; i += 997) {
    EXPECT_NEAR(band_area_mm2(surface, t[i], t[i + 1]) / areas[i], 1.0, 1e-9) << i;
  }
}

TEST(PlaceOrgans, EqualAreasOnADiskAreVogelsSpiral) {
  const SurfaceOfRevolution disk({{0.0, 0.0}, {1.0, 0.0}}, 1);
  const std::vector<double> areas(200, disk.area_mm2() / 200);
  std::vector<double> t(200);
  std::vector<Vec2> vogel(200);
  place_organs(disk, areas, SpiralDirection::kFromApex, t);
  place_spiral({.spacing_mm = std::sqrt(1.0 / 200)}, vogel);
  for (std::size_t i = 0; i < t.size(); ++i) {
    EXPECT_NEAR(disk.radius_mm(t[i]), length(vogel[i]), 1e-12);
  }
}

TEST(PlaceOrgans, FromTheBaseIsTheMirrorImageOfFromTheApex) {
  const SurfaceOfRevolution surface = surfaces()[1].surface;
  const std::vector<double> areas(50, surface.area_mm2() / 50);
  std::vector<double> down(50);
  std::vector<double> up(50);
  place_organs(surface, areas, SpiralDirection::kFromApex, down);
  place_organs(surface, areas, SpiralDirection::kFromBase, up);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_NEAR(up[i], down[49 - i], 1e-12);
  }
}

TEST(PlaceOrgans, StopsWhereTheSurfaceEnds) {
  const SurfaceOfRevolution disk({{0.0, 0.0}, {1.0, 0.0}}, 1);
  const std::vector<double> areas(10, disk.area_mm2() / 7.5);
  std::vector<double> t(10);
  EXPECT_EQ(place_organs(disk, areas, SpiralDirection::kFromApex, t), 7u);
}

TEST(PlaceOrgans, AreaAsAFunctionOfPositionMeetsEquation3) {
  for (const Case& c : surfaces()) {
    const FunctionGraph area({{0.0, 0.002}, {0.4, 0.05}, {0.7, 0.01}, {1.0, 0.02}});
    const std::vector<double> t = place_organs(c.surface, area, SpiralDirection::kFromApex, 100'000);
    ASSERT_GT(t.size(), 100u) << c.name;
    for (std::size_t i = 0; i + 1 < t.size(); i += 7) {
      constexpr int kSteps = 2000;  // midpoint rule
      double organs = 0.0;
      for (int k = 0; k < kSteps; ++k) {
        const double x = t[i] + (t[i + 1] - t[i]) * (k + 0.5) / kSteps;
        organs += math::kTurnRad * c.surface.radius_mm(x) * c.surface.speed_mm(x) / area(c.surface.s_from_t(x)) *
                  (t[i + 1] - t[i]) / kSteps;
      }
      EXPECT_NEAR(organs, 1.0, 1e-6) << c.name << ", organ " << i;
    }
  }
}

}  // namespace
}  // namespace anthesis
