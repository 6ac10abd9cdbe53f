#include "anthesis/geometry/predicates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <random>

namespace anthesis {
namespace {

using Rational = boost::multiprecision::cpp_rational;

int rational_orient2d(Vec2 a, Vec2 b, Vec2 c) {
  const Rational determinant = (Rational(b.x) - Rational(a.x)) * (Rational(c.y) - Rational(a.y)) -
                               (Rational(b.y) - Rational(a.y)) * (Rational(c.x) - Rational(a.x));
  return determinant.sign();
}

int rational_orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  // By the other rows than the code under test: differences to d.
  std::array<std::array<Rational, 3>, 3> m;
  const std::array<Vec3, 3> rows = {a, b, c};
  for (std::size_t i = 0; i < 3; ++i) {
    m[i] = {Rational(rows[i].x) - Rational(d.x), Rational(rows[i].y) - Rational(d.y),
            Rational(rows[i].z) - Rational(d.z)};
  }
  const Rational determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return -determinant.sign();
}

/// A few units in the last place up or down.
double nudged(double value, std::mt19937_64& random) {
  const int steps = static_cast<int>(random() % 5) - 2;
  for (int i = 0; i < std::abs(steps); ++i) {
    value = std::nextafter(value, steps > 0 ? 1e300 : -1e300);
  }
  return value;
}

double within_limit(double value) {
  return std::clamp(value, -kPredicateLimit, kPredicateLimit);
}

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : random_(seed) {}

  double unit() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
  double single() { return static_cast<float>(unit()); }
  double small_whole() { return static_cast<double>(random_() % 7) - 3.0; }
  /// Of any size that the predicates take, zero among them.
  double any() {
    const int kind = static_cast<int>(random_() % 8);
    return kind == 0   ? 0.0
           : kind == 1 ? unit() * 1e100
           : kind == 2 ? 0x1p-1074 * static_cast<double>(random_() % 1000)
                       : std::ldexp(unit(), static_cast<int>(random_() % 1380) - 1050);
  }
  double nudge(double value) { return nudged(value, random_); }

 private:
  std::mt19937_64 random_;
};

TEST(Orient2d, IsOneForATurnToTheLeft) {
  EXPECT_EQ(orient2d({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orient2d({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(orient2d({0, 0}, {0.1, 0.1}, {0.3, 0.3}), 0);
}

TEST(Orient3d, IsOneOnTheSideFromWhichTheTriangleRunsCounterClockwise) {
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}), -1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {7, -5, 0}), 0);
}

TEST(Orient3d, SeesOneUnitInTheLastPlace) {
  const Vec3 a{0.1, 0.2, 0.3};
  const Vec3 b{12.1, 0.2, 0.3};
  const Vec3 c{0.1, 24.2, 0.3};
  const Vec3 d{7.7, 3.3, 0.3};
  EXPECT_EQ(orient3d(a, b, c, d), 0);
  EXPECT_EQ(orient3d(a, b, c, {d.x, d.y, std::nextafter(0.3, 1.0)}), 1);
  EXPECT_EQ(orient3d(a, b, c, {d.x, d.y, std::nextafter(0.3, 0.0)}), -1);
}

TEST(Orient2d, AgreesWithRationalNumbers) {
  Numbers numbers(1);
  int zeros = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto next = [&]() -> double {
      switch (i % 4) {
        case 0:
          return numbers.unit();
        case 1:
          return numbers.single();
        case 2:
          return numbers.small_whole();
        default:
          return numbers.any();
      }
    };
    const Vec2 a{next(), next()};
    const Vec2 b{next(), next()};
    Vec2 c{next(), next()};
    if (i % 8 >= 4) {  // on the line, but for the rounding
      const double t = numbers.unit();
      c = {within_limit(numbers.nudge(a.x + t * (b.x - a.x))), within_limit(numbers.nudge(a.y + t * (b.y - a.y)))};
    }
    const int expected = rational_orient2d(a, b, c);
    zeros += expected == 0 ? 1 : 0;
    ASSERT_EQ(orient2d(a, b, c), expected) << i;
    ASSERT_EQ(orient2d(b, c, a), expected) << i;
    ASSERT_EQ(orient2d(b, a, c), -expected) << i;
  }
  EXPECT_GT(zeros, 100);
}

TEST(Orient3d, AgreesWithRationalNumbers) {
  Numbers numbers(2);
  int zeros = 0;
  for (int i = 0; i < 8000; ++i) {
    const auto next = [&]() -> double {
      switch (i % 4) {
        case 0:
          return numbers.unit();
        case 1:
          return numbers.single();
        case 2:
          return numbers.small_whole();
        default:
          return numbers.any();
      }
    };
    const auto point = [&] { return Vec3{next(), next(), next()}; };
    const Vec3 a = point();
    const Vec3 b = point();
    const Vec3 c = point();
    Vec3 d = point();
    if (i % 8 >= 4) {  // in the plane, but for the rounding
      const double s = numbers.unit();
      const double t = numbers.unit();
      const Vec3 p = a + s * (b - a) + t * (c - a);
      d = {within_limit(numbers.nudge(p.x)), within_limit(numbers.nudge(p.y)), within_limit(numbers.nudge(p.z))};
    }
    const int expected = rational_orient3d(a, b, c, d);
    zeros += expected == 0 ? 1 : 0;
    ASSERT_EQ(orient3d(a, b, c, d), expected) << i;
    ASSERT_EQ(orient3d(b, c, a, d), expected) << i;
    ASSERT_EQ(orient3d(d, c, b, a), expected) << i;
    ASSERT_EQ(orient3d(b, a, c, d), -expected) << i;
    ASSERT_EQ(PlaneSide(a, b, c)(d), expected) << i;
  }
  EXPECT_GT(zeros, 100);
}

// A grid of points half a unit in the last place from each other, near a plane through large coordinates: the picture
// in which ordinary arithmetic shows a ragged border (Kettner et al. 2008).
TEST(Orient3d, HasAStraightBorderWhereOrdinaryArithmeticIsRagged) {
  const Vec3 a{12.0, 12.0, 12.0};
  const Vec3 b{24.0, 24.0, 12.0};
  const Vec3 c{12.0, 12.0, 24.0};
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const Vec3 d{0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53, 0.3};
      ASSERT_EQ(orient3d(a, b, c, d), i == j ? 0 : d.x == d.y ? 0 : d.x > d.y ? 1 : -1) << i << ' ' << j;
    }
  }
}

TEST(Orient3d, IsRightAtBothEndsOfItsRange) {
  const double large = kPredicateLimit;
  const double small = 0x1p-1074;
  EXPECT_EQ(orient3d({-large, -large, 0}, {large, -large, 0}, {-large, large, 0}, {0, 0, small}), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {small, 0, 0}, {0, small, 0}, {0, 0, small}), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {0, small, 0}, {small, 0, 0}, {large, -large, small}), -1);
  EXPECT_EQ(orient3d({large, 0, 0}, {0, large, 0}, {0, 0, large}, {large, small, -small}), 0);
  EXPECT_EQ(orient3d({large, 0, 0}, {0, large, 0}, {0, 0, large}, {large, 2 * small, -small}), 1);
}

TEST(CrossingPieces, AreNoneInASimpleLine) {
  const std::vector<Vec2> square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  EXPECT_FALSE(crossing_pieces(square, false));
  EXPECT_FALSE(crossing_pieces(square, true));
  EXPECT_FALSE(crossing_pieces(std::vector<Vec2>{{0, 0}, {1, 0}, {2, 0}}, false));  // straight on
  EXPECT_FALSE(crossing_pieces(std::vector<Vec2>{{0, 0}}, false));
  EXPECT_FALSE(crossing_pieces(std::vector<Vec2>{}, false));
}

TEST(CrossingPieces, AreNamedByTheirFirstPoints) {
  using Pair = std::array<std::size_t, 2>;
  EXPECT_EQ(crossing_pieces(std::vector<Vec2>{{0, 0}, {2, 2}, {2, 0}, {0, 2}}, false), (Pair{0, 2}));
  EXPECT_EQ(crossing_pieces(std::vector<Vec2>{{0, 0}, {2, 0}, {2, 2}, {1, 0}}, false), (Pair{0, 2}));  // only touches
  EXPECT_EQ(crossing_pieces(std::vector<Vec2>{{0, 0}, {2, 0}, {1, 0}}, false), (Pair{0, 1}));          // runs back
  const std::vector<Vec2> hook{{0, 0}, {0, 2}, {2, 2}, {2, 1}, {-1, 1}};
  EXPECT_EQ(crossing_pieces(hook, false), (Pair{0, 3}));
  // Only the piece that closes it crosses.
  const std::vector<Vec2> zigzag{{0, 0}, {1, 2}, {2, 0}, {3, 2}, {4, 1}};
  EXPECT_FALSE(crossing_pieces(zigzag, false));
  EXPECT_EQ(crossing_pieces(zigzag, true), (Pair{1, 4}));
}

}  // namespace
}  // namespace anthesis
