#include "near_batch.h"

#include <gtest/gtest.h>

#include "anthesis/base/random.h"
#include "anthesis/contact/continuous.h"

namespace anthesis {
namespace {

Vec3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

/// Anything from far apart to touching, at any place; some flat, with equal points, parallel or in one line.
std::array<Vec3, 4> random_points(Rng& rng) {
  std::array<Vec3, 4> points;
  const Vec3 centre = random_vector(rng, 100.0);
  const Vec3 along = random_vector(rng, 1.0);
  const std::uint64_t kind = rng.bits() % 8;
  for (Vec3& p : points) {
    p = centre + (kind == 0 ? rng.uniform(-1.0, 1.0) * along : random_vector(rng, 1.0));
    p.z = kind == 1 ? centre.z : p.z;
  }
  if (kind == 2) {
    points[1 + rng.bits() % 3] = points[rng.bits() % 4];
  } else if (kind == 3) {
    points[3] = points[2] + rng.uniform(-1.0, 1.0) * (points[1] - points[0]);
  }
  return points;
}

void put(NearBatch& batch, std::size_t lane, int k, Vec3 p, Vec3 way) {
  batch.points[k][0][lane] = p.x;
  batch.points[k][1][lane] = p.y;
  batch.points[k][2][lane] = p.z;
  batch.ways[k][0][lane] = way.x;
  batch.ways[k][1][lane] = way.y;
  batch.ways[k][2][lane] = way.z;
}

TEST(NearBatch, WhatIsSoundIsWhatIsFoundOneByOneAndNearlyAllIs) {
  Rng rng(1, 0, RandomPurpose::kTest);
  for (const bool edges : {false, true}) {
    int sound = 0;
    int generic = 0;
    constexpr int kBatches = 20'000;
    for (int i = 0; i < kBatches; ++i) {
      NearBatch batch;
      std::array<std::array<Vec3, 4>, NearBatch::kLanes> all;
      for (std::size_t lane = 0; lane < all.size(); ++lane) {
        all[lane] = random_points(rng);
        for (int k = 0; k < 4; ++k) {
          put(batch, lane, k, all[lane][k], {});
        }
      }
      edges ? find_nearest_edges(batch) : find_nearest_vertex_triangle(batch);
      for (std::size_t lane = 0; lane < all.size(); ++lane) {
        const Nearest nearest = edges ? nearest_edge_edge(all[lane]) : nearest_vertex_triangle(all[lane]);
        ++generic;
        if ((batch.sound >> lane & 1) == 0) {
          continue;
        }
        ++sound;
        // The distance is that of the nearest points, and the weights are of points of both.
        ASSERT_NEAR(batch.distance[lane], nearest.distance, 1e-9 * nearest.distance + 1e-12);
        Vec3 difference;
        for (int k = 0; k < 4; ++k) {
          const double weight = batch.weights[k][lane];
          ASSERT_TRUE(k < (edges ? 2 : 1) ? weight >= 0.0 && weight <= 1.0 : weight <= 0.0 && weight >= -1.0);
          difference += weight * (all[lane][k] - all[lane][3]);
        }
        ASSERT_NEAR(length(difference), batch.distance[lane], 1e-14);
        ASSERT_NEAR(batch.weights[0][lane] + batch.weights[1][lane] + batch.weights[2][lane] + batch.weights[3][lane],
                    0.0, 1e-15);
      }
    }
    EXPECT_GT(sound, 0.8 * generic);
  }
}

TEST(NearBatch, WhatStaysApartDoesSoAtEveryShareOfWaysAndRides) {
  Rng rng(2, 0, RandomPurpose::kTest);
  for (const bool edges : {false, true}) {
    const int firsts = edges ? 2 : 1;
    int apart = 0;
    for (int i = 0; i < 5'000; ++i) {
      NearBatch batch;
      std::array<std::array<Vec3, 4>, NearBatch::kLanes> all;
      std::array<std::array<Vec3, 4>, NearBatch::kLanes> ways;
      batch.rides = {random_vector(rng, 0.2), random_vector(rng, 0.2)};
      for (std::size_t lane = 0; lane < all.size(); ++lane) {
        all[lane] = random_points(rng);
        for (int k = 0; k < 4; ++k) {
          ways[lane][k] = random_vector(rng, 0.3);
          put(batch, lane, k, all[lane][k], ways[lane][k]);
          batch.reaches[k][lane] = 0.05;
        }
      }
      edges ? find_nearest_edges(batch) : find_nearest_vertex_triangle(batch);
      for (std::size_t lane = 0; lane < all.size(); ++lane) {
        if ((batch.sound & batch.apart) >> lane & 1) {
          ++apart;
          const auto share = [&] { return std::clamp(rng.uniform(-0.5, 1.5), 0.0, 1.0); };
          const std::array<double, 2> ridden = {share(), share()};
          std::array<Vec3, 4> places = all[lane];
          for (int k = 0; k < 4; ++k) {
            const int side = k < firsts ? 0 : 1;
            places[k] += share() * ways[lane][k] + ridden[side] * batch.rides[side];
          }
          ASSERT_GT((edges ? nearest_edge_edge(places) : nearest_vertex_triangle(places)).distance, 0.1);
        }
      }
    }
    EXPECT_GT(apart, 2'000);
  }
}

TEST(NearBatch, ACornerThatHasNoPartInItWeighsNothing) {
  // The vertex hangs over the middle of each side of the triangle in turn.
  const std::array<Vec3, 3> corners = {Vec3{0.1, 0.2, 0.3}, Vec3{1.3, 0.1, 0.2}, Vec3{0.4, 1.7, 0.1}};
  for (int side = 0; side < 3; ++side) {
    const Vec3 a = corners[side];
    const Vec3 b = corners[(side + 1) % 3];
    const Vec3 middle = lerp(a, b, 0.37);
    NearBatch batch;
    for (std::size_t lane = 0; lane < NearBatch::kLanes; ++lane) {
      put(batch, lane, 0, middle + 0.5 * (middle - corners[(side + 2) % 3]) + Vec3{0, 0, 0.1 * double(lane)}, {});
      for (int k = 0; k < 3; ++k) {
        put(batch, lane, 1 + k, corners[k], {});
      }
    }
    find_nearest_vertex_triangle(batch);
    EXPECT_EQ(batch.sound, 0xffu);
    for (std::size_t lane = 0; lane < NearBatch::kLanes; ++lane) {
      EXPECT_EQ(batch.weights[1 + (side + 2) % 3][lane], 0.0);
    }
  }
}

}  // namespace
}  // namespace anthesis
