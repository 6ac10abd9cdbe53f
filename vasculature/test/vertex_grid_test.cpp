#include "vertex_grid.h"

#include <gtest/gtest.h>

#include "anthesis/base/math.h"
#include "anthesis/base/random.h"
#include "vein_visibility.h"

namespace anthesis::veins {
namespace {

struct Cloud {
  std::vector<Vec3> positions;
  std::vector<double> values;
  std::vector<std::uint32_t> indices;
};

Cloud cloud(std::size_t count, Vec3 size) {
  Cloud cloud;
  Rng rng(7, count, RandomPurpose::kTest);
  for (std::uint32_t i = 0; i < count; ++i) {
    cloud.positions.push_back({size.x * rng.uniform(), size.y * rng.uniform(), size.z * rng.uniform() * rng.uniform()});
    cloud.values.push_back(rng.uniform(0.0, 3.0));
    if (i % 5 != 0) {
      cloud.indices.push_back(i);
    }
  }
  return cloud;
}

double distance(const Cloud& cloud, std::uint32_t i, Vec3 p) {
  return length(cloud.positions[i] - p);
}

TEST(VertexGrid, FindsWhatALinearSearchFinds) {
  for (const Vec3 size : {Vec3{1.0, 1.0, 1.0}, Vec3{10.0, 0.0, 2.0}, Vec3{0.0, 0.0, 0.0}}) {
    const Cloud c = cloud(700, size);
    VertexGrid grid;
    grid.build(c.positions, c.values, c.indices, 0.01);
    Rng rng(8, 1, RandomPurpose::kTest);
    for (int query = 0; query < 100; ++query) {
      const Vec3 p = {rng.uniform(-0.5, 1.5) * size.x, rng.uniform(-0.5, 1.5) * size.y, rng.uniform(-0.5, 1.5)};
      std::uint32_t nearest = VertexGrid::kNone;
      std::uint32_t least = VertexGrid::kNone;
      std::vector<std::uint32_t> within;
      const auto score = [&](std::uint32_t i) { return 2.0 * distance(c, i, p) + c.values[i]; };
      for (const std::uint32_t i : c.indices) {
        nearest = nearest == VertexGrid::kNone || distance(c, i, p) < distance(c, nearest, p) ? i : nearest;
        least = least == VertexGrid::kNone || score(i) < score(least) ? i : least;
        if (distance(c, i, p) <= 0.3) {
          within.push_back(i);
        }
      }
      EXPECT_EQ(distance(c, grid.nearest(p), p), distance(c, nearest, p));
      std::vector<std::uint32_t> found;
      grid.within(p, 0.3, [&](std::uint32_t i, double) { found.push_back(i); });
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, within);
      std::uint32_t best = VertexGrid::kNone;
      grid.below(
          p, [](double square, double value) { return 2.0 * std::sqrt(square) + value; },
          [&] { return best == VertexGrid::kNone ? 1e300 : score(best); },
          [&](std::uint32_t i) { best = best == VertexGrid::kNone || score(i) < score(best) ? i : best; });
      EXPECT_EQ(best, least);
    }
  }
}

std::vector<std::uint32_t> visible(Vec3 p, const std::vector<Vec3>& positions, double angle_rad) {
  std::vector<std::uint32_t> all(positions.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    all[i] = i;
  }
  std::vector<std::uint32_t> seen;
  visit_visible(p, positions, all, angle_rad, [&](std::uint32_t i, double) {
    seen.push_back(i);
    return true;
  });
  return seen;
}

TEST(Visibility, NearVerticesHideThoseBehindThem) {
  // In one line only the first is seen; one aside is seen too.
  EXPECT_EQ(visible({}, {{2, 0, 0}, {1, 0, 0}, {3, 0, 0}, {0, 2, 0}}, 0.2), (std::vector<std::uint32_t>{1, 3}));
}

TEST(Visibility, FartherVerticesNeedMoreRoom) {
  // Two directions 0.5 apart. Widths are 0.2 and 0.2 d: the cones touch at d = 4.
  const auto at = [](double d) { return Vec3{d * math::cos(0.5), d * math::sin(0.5), 0.0}; };
  EXPECT_EQ(visible({}, {{1, 0, 0}, at(3.9)}, 0.2).size(), 2u);
  EXPECT_EQ(visible({}, {{1, 0, 0}, at(4.1)}, 0.2).size(), 1u);
}

TEST(Visibility, AgreesWithItsDefinition) {
  const Cloud c = cloud(400, {1.0, 1.0, 1.0});
  const Vec3 p = {0.4, 0.5, 0.2};
  for (const double angle : {0.01, 0.1, 0.55, 1.5}) {
    std::vector<std::uint32_t> by_distance(c.positions.size());
    for (std::uint32_t i = 0; i < by_distance.size(); ++i) {
      by_distance[i] = i;
    }
    std::sort(by_distance.begin(), by_distance.end(),
              [&](std::uint32_t a, std::uint32_t b) { return distance(c, a, p) < distance(c, b, p); });
    const auto width = [&](std::uint32_t i) {
      return std::min(angle * distance(c, i, p) / distance(c, by_distance[0], p), math::kTurnRad);
    };
    std::vector<std::uint32_t> expected;
    for (const std::uint32_t i : by_distance) {
      const bool hidden = std::any_of(expected.begin(), expected.end(), [&](std::uint32_t j) {
        const Vec3 a = normalized(c.positions[i] - p);
        const Vec3 b = normalized(c.positions[j] - p);
        return math::atan2(length(cross(a, b)), dot(a, b)) < 0.5 * (width(i) + width(j));
      });
      if (!hidden) {
        expected.push_back(i);
      }
    }
    EXPECT_EQ(visible(p, c.positions, angle), expected) << angle;
    EXPECT_GT(expected.size(), 1u);
  }
}

}  // namespace
}  // namespace anthesis::veins
