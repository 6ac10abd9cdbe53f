#include "anthesis/receptacle/harmonic_section.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/geometry/predicates.h"

namespace anthesis {
namespace {

/// Corners joined by `parts` equal parts each; the last corner, on the axis, included.
std::vector<Vec2> polygon(std::span<const Vec2> corners, std::size_t parts) {
  std::vector<Vec2> points;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    for (std::size_t k = 0; k < parts; ++k) {
      points.push_back(lerp(corners[i], corners[i + 1], static_cast<double>(k) / static_cast<double>(parts)));
    }
  }
  points.push_back(corners.back());
  return points;
}

std::vector<Vec2> unit_square(std::size_t parts) {
  return polygon(std::vector<Vec2>{{0, 1}, {1, 1}, {1, 0}, {0, 0}}, parts);
}

/// A quarter of a ring between radius 1 and 2.
std::vector<Vec2> ring_sector(std::size_t parts) {
  std::vector<Vec2> points;
  const auto arc = [&](double radius, bool is_outwards) {
    for (std::size_t k = 0; k <= parts; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(parts);
      const double angle = 0.5 * math::kPi * (is_outwards ? share : 1.0 - share);
      points.push_back({k == (is_outwards ? 0 : parts) ? 0.0 : radius * math::sin(angle), radius * math::cos(angle)});
    }
  };
  arc(2.0, true);
  for (std::size_t k = 1; k < parts; ++k) {
    points.push_back({2.0 - static_cast<double>(k) / static_cast<double>(parts), 0.0});
  }
  arc(1.0, false);
  return points;
}

/// A head with an overhanging rim, drawn in to its base.
std::vector<Vec2> cushion() {
  std::vector<Vec2> points{{0, 0.8}};
  for (int k = 1; k <= 24; ++k) {
    const double angle = 0.11 * k;
    points.push_back({0.9 * math::sin(angle), 0.25 + 0.55 * math::cos(angle) * (math::cos(angle) > 0 ? 1.0 : 0.45)});
  }
  points.push_back({0.3, 0.0});
  points.push_back({0.15, 0.0});
  points.push_back({0.0, 0.0});
  return points;
}

HarmonicSection section(std::span<const Vec2> controls, double max_edge = 0.0625) {
  Expected<HarmonicSection> made = HarmonicSection::make(controls, {.max_edge = max_edge});
  EXPECT_TRUE(made.has_value()) << (made ? "" : to_string(made.error()));
  return std::move(made.value());
}

template <class Function>
double error_at_points(std::span<const Vec2> controls, double max_edge, const Function& function,
                       AxisCondition axis = AxisCondition::kNatural) {
  const HarmonicSection solved = section(controls, max_edge);
  std::vector<double> values;
  for (const Vec2 c : controls) {
    values.push_back(function(c));
  }
  const std::vector<double> found = solved.extend(values, axis);
  double squares = 0.0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    const double difference = found[v] - function(solved.mesh().points[v]);
    squares += difference * difference;
  }
  return std::sqrt(squares / static_cast<double>(found.size()));
}

double least_angle_rad(const SectionMesh& mesh) {
  double least = math::kPi;
  for (const Triangle& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 p = mesh.points[triangle[(k + 1) % 3]] - mesh.points[triangle[k]];
      const Vec2 q = mesh.points[triangle[(k + 2) % 3]] - mesh.points[triangle[k]];
      least = std::min(least, math::atan2(cross(p, q), dot(p, q)));
    }
  }
  return least;
}

double area(std::span<const Vec2> polygon_points) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon_points.size(); ++i) {
    twice += cross(polygon_points[(i + 1) % polygon_points.size()], polygon_points[i]);
  }
  return 0.5 * twice;
}

TEST(SectionPolygon, HoldsWhatLiesBetweenTheAxisAndItsOutline) {
  const std::vector<Vec2> ring = ring_sector(24);
  for (const double angle : {0.0, 0.3, 0.8, 1.5}) {
    const Vec2 direction{math::sin(angle), math::cos(angle)};
    EXPECT_FALSE(is_in_section(ring, 0.9 * direction)) << angle;
    EXPECT_TRUE(is_in_section(ring, 1.1 * direction)) << angle;
    EXPECT_TRUE(is_in_section(ring, 1.9 * direction)) << angle;
    EXPECT_FALSE(is_in_section(ring, 2.1 * direction)) << angle;
  }
}

TEST(TriangulateSection, FillsTheSectionWithWellShapedTriangles) {
  const std::vector<Vec2> spindle{{0, 1}, {0.3, 0.6}, {0.05, 0.5}, {0.3, 0.4}, {0, 0}};
  for (const std::vector<Vec2>& controls : {unit_square(4), ring_sector(6), cushion(), spindle}) {
    const Expected<SectionMesh> mesh = triangulate_section(controls);
    ASSERT_TRUE(mesh.has_value()) << to_string(mesh.error());
    double sum = 0.0;
    for (const Triangle& triangle : mesh->triangles) {
      const Vec2 a = mesh->points[triangle[0]];
      EXPECT_GT(orient2d(a, mesh->points[triangle[1]], mesh->points[triangle[2]]), 0);
      sum += 0.5 * cross(mesh->points[triangle[1]] - a, mesh->points[triangle[2]] - a);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 p = mesh->points[triangle[(k + 1) % 3]];
        const Vec2 q = mesh->points[triangle[(k + 2) % 3]];
        if (p.x == 0.0 && q.x == 0.0) {
          EXPECT_GT(dot(p - mesh->points[triangle[k]], q - mesh->points[triangle[k]]), 0.0) << "axis seen too wide";
        }
      }
    }
    EXPECT_NEAR(sum, area(controls), 1e-12);
    EXPECT_GT(math::degrees(least_angle_rad(*mesh)), 24.9);
    // Euler: one disc.
    const std::size_t boundary = mesh->contour_points() + mesh->axis_points;
    EXPECT_EQ(mesh->triangles.size(), 2 * mesh->points.size() - boundary - 2);
  }
}

TEST(TriangulateSection, GradesFromFineToCoarse) {
  std::vector<Vec2> controls = unit_square(1);
  controls.insert(controls.begin() + 2, {1.0, 0.9999});
  const Expected<SectionMesh> mesh = triangulate_section(controls);
  ASSERT_TRUE(mesh.has_value()) << to_string(mesh.error());
  EXPECT_GT(math::degrees(least_angle_rad(*mesh)), 24.9);
  EXPECT_LT(mesh->points.size(), 1000U);
}

TEST(TriangulateSection, TakesCoincidentControlPointsAsOne) {
  std::vector<Vec2> controls = unit_square(2);
  controls.insert(controls.begin() + 2, 6, Vec2{1.0, 1.0});
  const Expected<SectionMesh> mesh = triangulate_section(controls);
  ASSERT_TRUE(mesh.has_value()) << to_string(mesh.error());
  EXPECT_EQ(mesh->controls, (std::vector<std::uint32_t>{0, 1, 8, 9, 10, 11, 12}));
}

TEST(TriangulateSection, RefusesASectionThatCrossesItself) {
  const std::vector<Vec2> controls{{0, 1}, {1, 0.2}, {1, 0.8}, {0.1, 0.1}, {0, 0}};
  const Expected<SectionMesh> mesh = triangulate_section(controls);
  ASSERT_FALSE(mesh.has_value());
  EXPECT_EQ(mesh.error().message, "must not touch or cross itself, but its parts after control points 0 and 2 do");
  EXPECT_FALSE(triangulate_section(std::vector<Vec2>{{0, 1}, {1, 1}, {0, 0.5}, {1, 0}, {0, 0}}).has_value());
}

TEST(CheckSection, NamesThePointOffTheAxis) {
  const std::vector<Vec2> controls{{0.125, 1}, {1, 0}, {0, 0}};
  const std::optional<Error> error = check_section(controls);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(to_string(*error), "points[0] must lie on the axis, at radius 0, got 0.125");
}

TEST(HarmonicSection, ApproachesHarmonicFunctionsWithTheSquareOfTheEdge) {
  // Even in x, so without slope across the axis.
  const auto saddle = [](Vec2 p) { return p.x * p.x - p.y * p.y; };
  const auto wave = [](Vec2 p) { return math::exp(-p.y) * math::cos(p.x); };  // Re exp(i z)
  const auto source = [](Vec2 p) { return 0.5 * math::log(dot(p, p)); };
  for (const auto& [coarse, fine] : {std::pair(unit_square(8), unit_square(32)), {ring_sector(8), ring_sector(32)}}) {
    EXPECT_LT(error_at_points(fine, 1.0 / 32, saddle), error_at_points(coarse, 1.0 / 8, saddle) / 12.0);
    EXPECT_LT(error_at_points(fine, 1.0 / 32, wave), error_at_points(coarse, 1.0 / 8, wave) / 12.0);
    EXPECT_LT(error_at_points(fine, 1.0 / 32, saddle), 1e-3);
    EXPECT_LT(error_at_points(fine, 1.0 / 32, wave), 1e-3);
  }
  EXPECT_LT(error_at_points(ring_sector(32), 1.0 / 32, source),
            error_at_points(ring_sector(8), 1.0 / 8, source) / 12.0);
  // Odd in x, so 0 on the axis.
  const auto twist = [](Vec2 p) { return p.x * p.y + math::exp(-p.y) * math::sin(p.x); };
  EXPECT_LT(error_at_points(unit_square(32), 1.0 / 32, twist, AxisCondition::kZero),
            error_at_points(unit_square(8), 1.0 / 8, twist, AxisCondition::kZero) / 12.0);
}

TEST(HarmonicSection, ReproducesHeightsExactlyAndRadiiWhereTheyVanishOnTheAxis) {
  const std::vector<Vec2> controls = cushion();
  EXPECT_LT(error_at_points(controls, 0.0625, [](Vec2 p) { return 3.0 - 2.0 * p.y; }), 1e-14);
  EXPECT_LT(error_at_points(
                controls, 0.0625, [](Vec2 p) { return p.x; }, AxisCondition::kZero),
            1e-14);
  // The radius has a slope across the axis: with the natural condition no refinement gives it back.
  EXPECT_GT(error_at_points(controls, 0.0625, [](Vec2 p) { return p.x; }), 0.01);
}

TEST(HarmonicSection, NowhereInsideExceedsTheBoundary) {
  const std::vector<Vec2> controls = cushion();
  const HarmonicSection solved = section(controls);
  for (std::size_t peak = 0; peak < controls.size(); peak += 5) {
    std::vector<double> values(controls.size(), -1.0);
    for (std::size_t i = peak; i < controls.size(); i += 2) {
      values[i] = 1.0;
    }
    const std::vector<double> found = solved.extend(values);
    for (std::size_t v = solved.mesh().contour_points(); v < found.size(); ++v) {
      EXPECT_LT(std::fabs(found[v]), 1.0);
    }
  }
}

TEST(HarmonicWeights, AreSharesAndSumToOne) {
  for (const std::vector<Vec2>& controls : {unit_square(4), ring_sector(9), cushion()}) {
    const HarmonicSection solved = section(controls);
    const std::size_t points = solved.mesh().points.size();
    std::vector<double> sum(points, 0.0);
    std::vector<double> height(points, 0.0);
    solved.weights([&](std::size_t i, std::span<const double> row) {
      ASSERT_EQ(row.size(), points);
      for (std::size_t v = 0; v < points; ++v) {
        EXPECT_GE(row[v], 0.0);
        EXPECT_LE(row[v], 1.0);
        sum[v] += row[v];
        height[v] += row[v] * controls[i].y;
      }
      for (std::size_t v = 0; v < solved.mesh().contour_points(); ++v) {
        const SectionPlace& place = solved.mesh().places[v];
        const double expected = (place.from == i ? 1.0 - place.t : 0.0) + (place.to == i ? place.t : 0.0);
        EXPECT_EQ(row[v], place.t == 0.0 ? (place.from == i ? 1.0 : 0.0) : expected);
      }
    });
    for (std::size_t v = 0; v < points; ++v) {
      EXPECT_NEAR(sum[v], 1.0, 1e-12);
      EXPECT_NEAR(height[v], solved.mesh().points[v].y, 1e-12);
    }
  }
}

TEST(HarmonicWeights, AddUpToAnyExtension) {
  const std::vector<Vec2> controls = cushion();
  const HarmonicSection solved = section(controls);
  std::vector<double> values;
  for (std::size_t i = 0; i < controls.size(); ++i) {
    values.push_back(math::sin(static_cast<double>(i * i)));
  }
  std::vector<double> sum(solved.mesh().points.size(), 0.0);
  solved.weights([&](std::size_t i, std::span<const double> row) {
    for (std::size_t v = 0; v < row.size(); ++v) {
      sum[v] += values[i] * row[v];
    }
  });
  const std::vector<double> direct = solved.extend(values);
  for (std::size_t v = 0; v < sum.size(); ++v) {
    EXPECT_NEAR(sum[v], direct[v], 1e-13);
  }
}

TEST(HarmonicWeights, AreTheSameForAnyNumberOfThreads) {
  const HarmonicSection solved = section(ring_sector(30));
  const auto all = [&](int threads) {
    const ThreadLimit limit(threads);
    std::vector<double> weights;
    solved.weights(
        [&](std::size_t, std::span<const double> row) { weights.insert(weights.end(), row.begin(), row.end()); });
    return weights;
  };
  EXPECT_EQ(all(1), all(4));
}

}  // namespace
}  // namespace anthesis
