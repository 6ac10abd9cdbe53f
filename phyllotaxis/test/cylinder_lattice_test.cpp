#include "anthesis/phyllotaxis/cylinder_lattice.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

double turns_to_nearest(double turns) {
  return turns - std::floor(turns + 0.5);
}

/// Distance between organ 0 and organ k by the definition of the lattice.
double distance_to(const TouchingLattice& lattice, int k) {
  const double x = turns_to_nearest(k * (lattice.divergence_rad / math::kTurnRad));
  return std::hypot(x, k * lattice.rise);
}

/// Least distance from organ 0 to any other, itself around the cylinder included.
double least_distance(const TouchingLattice& lattice) {
  double least = 1.0;
  for (int k = 1; k * lattice.rise <= 1.0; ++k) {
    least = std::min(least, distance_to(lattice, k));
  }
  return least;
}

TEST(VanIterson, EveryCircleTouchesItsTwoFamiliesAndClearsAllOthers) {
  const Expected<std::vector<LatticeArc>> arcs = van_iterson_diagram({.least_radius = 0.02, .arc_samples = 9});
  ASSERT_TRUE(arcs.has_value());
  EXPECT_GT(arcs->size(), 100u);
  for (const LatticeArc& arc : *arcs) {
    for (const TouchingLattice& lattice : arc.points) {
      const double diameter = 2.0 * lattice.radius;
      EXPECT_NEAR(distance_to(lattice, arc.m), diameter, 1e-12) << arc.m << " " << arc.n;
      EXPECT_NEAR(distance_to(lattice, arc.n), diameter, 1e-12) << arc.m << " " << arc.n;
      EXPECT_GE(least_distance(lattice), diameter - 1e-12) << arc.m << " " << arc.n;
    }
  }
}

TEST(VanIterson, AnArcIsPartOfACircleInThePlaneOfDivergenceAndRise) {
  // |v_m| = |v_n| reads (m d - p)^2 - (n d - q)^2 = (n^2 - m^2) h^2: a circle about a point of the axis h = 0.
  const Expected<std::vector<LatticeArc>> arcs = van_iterson_diagram({.least_radius = 0.05, .arc_samples = 17});
  for (const LatticeArc& arc : *arcs) {
    if (arc.m == arc.n) {
      continue;  // a straight line
    }
    const auto squares = [&](const TouchingLattice& lattice) {
      const double d = lattice.divergence_rad / math::kTurnRad;
      return Vec2{d, d * d + lattice.rise * lattice.rise};
    };
    const Vec2 a = squares(arc.points.front());
    const Vec2 b = squares(arc.points.back());
    const double twice_centre = (b.y - a.y) / (b.x - a.x);
    for (const TouchingLattice& lattice : arc.points) {
      const Vec2 p = squares(lattice);
      EXPECT_NEAR(p.y - twice_centre * p.x, a.y - twice_centre * a.x, 1e-12);
    }
  }
}

TEST(VanIterson, HexagonalLatticesHaveRationalDivergence) {
  EXPECT_EQ(hexagonal_lattice(1, 1).divergence_turns, (Fraction{1, 2}));
  EXPECT_EQ(hexagonal_lattice(1, 2).divergence_turns, (Fraction{5, 14}));
  EXPECT_EQ(hexagonal_lattice(2, 3).divergence_turns, (Fraction{15, 38}));
  EXPECT_EQ(hexagonal_lattice(3, 5).divergence_turns, (Fraction{37, 98}));
  EXPECT_EQ(hexagonal_lattice(1, 3).divergence_turns, (Fraction{7, 26}));
  EXPECT_EQ(hexagonal_lattice(1, 2).norm, 7);
  EXPECT_EQ(hexagonal_lattice(2, 3).norm, 19);
}

TEST(VanIterson, ThreeFamiliesTouchWhereArcsMeet) {
  for (int n = 1; n <= 30; ++n) {
    for (int m = 1; m <= n; ++m) {
      if (std::gcd(m, n) != 1) {
        continue;
      }
      const HexagonalLattice hexagonal = hexagonal_lattice(m, n);
      const double norm = static_cast<double>(hexagonal.norm);
      const TouchingLattice lattice{math::kTurnRad * hexagonal.divergence_turns.value(), std::sqrt(3.0) / (2.0 * norm),
                                    0.5 / std::sqrt(norm), true};
      for (const int family : {m, n, m + n}) {
        EXPECT_NEAR(distance_to(lattice, family), 2.0 * lattice.radius, 1e-13) << m << " " << n;
      }
      // The narrow end of (m, n) is the wide end of both arcs that begin there.
      for (const std::array<int, 2> pair : {std::array{m, n}, std::array{n, m + n}, std::array{m, m + n}}) {
        const TouchingLattice end = touching_lattice(pair[0], pair[1], lattice.radius);
        EXPECT_NEAR(end.divergence_rad, lattice.divergence_rad, 1e-12) << pair[0] << " " << pair[1];
        EXPECT_NEAR(end.rise, lattice.rise, 1e-12);
      }
    }
  }
}

TEST(VanIterson, OpposedFamiliesHaveTheirDivergenceBetweenFareyNeighbours) {
  EXPECT_EQ(opposed_interval(1, 1), (std::array<Fraction, 2>{Fraction{0, 1}, Fraction{1, 1}}));
  EXPECT_EQ(opposed_interval(3, 5), (std::array<Fraction, 2>{Fraction{1, 3}, Fraction{2, 5}}));
  const Expected<std::vector<LatticeArc>> arcs = van_iterson_diagram({.least_radius = 0.02, .arc_samples = 20});
  for (const LatticeArc& arc : *arcs) {
    const auto [low, high] = opposed_interval(arc.m, arc.n);
    EXPECT_EQ(high.numerator * low.denominator - low.numerator * high.denominator, 1);
    for (std::size_t i = 0; i < arc.points.size(); ++i) {
      const double turns = arc.points[i].divergence_rad / math::kTurnRad;
      const bool between = turns > low.value() - 1e-12 && turns < high.value() + 1e-12;
      EXPECT_EQ(arc.points[i].opposed, between) << arc.m << " " << arc.n;
      EXPECT_EQ(arc.points[i].opposed, i >= arc.first_opposed);
    }
  }
}

TEST(VanIterson, SuccessiveFibonacciArcsAreOpposedThroughoutAndOthersAreNot) {
  const Expected<std::vector<LatticeArc>> arcs = van_iterson_diagram({.least_radius = 0.03, .arc_samples = 9});
  for (const LatticeArc& arc : *arcs) {
    // After a bifurcation of (m, n) the pair (n, m + n) is opposed at once, the pair (m, m + n) only further down.
    EXPECT_EQ(arc.first_opposed == 0, 2 * arc.m >= arc.n) << arc.m << " " << arc.n;
  }
}

TEST(FibonacciLatticeTest, FollowsTheSequenceAndStaysNearTheGoldenAngle) {
  EXPECT_EQ(fibonacci_lattice(0.4).n, 1);
  EXPECT_EQ(fibonacci_lattice(0.2).n, 2);
  const FibonacciLattice fine = fibonacci_lattice(0.01);
  EXPECT_EQ(fine.m, 34);
  EXPECT_EQ(fine.n, 55);
  EXPECT_NEAR(fine.lattice.divergence_rad, kGoldenAngleRad, math::radians(0.1));
  EXPECT_NEAR(fibonacci_lattice(1e-4).lattice.divergence_rad, kGoldenAngleRad, 1e-6);
}

TEST(ContactParastichiesTest, GoldenAngleShowsFibonacciNumbersAtEveryRise) {
  int before = 1;
  for (double rise = 0.5; rise > 1e-6; rise *= 0.9) {
    const ContactParastichies contact = contact_parastichies({.rise = rise});
    const std::array<int, 2> pair = contact.pair();
    int a = 1;
    int b = 1;
    while (b < pair[1]) {
      a = std::exchange(b, a + b);
    }
    EXPECT_EQ(pair[1], b);
    EXPECT_THAT(pair[0], testing::AnyOf(a, b - a, b)) << rise;  // not opposed: (3, 8)
    EXPECT_GE(pair[1], before);
    before = pair[1];
  }
}

TEST(ContactParastichiesTest, ReadsTheTouchingFamiliesOfALattice) {
  for (const std::array<int, 2> pair : {std::array{1, 1}, std::array{2, 3}, std::array{4, 7}, std::array{13, 21}}) {
    const auto [narrow, wide] = touching_radii(pair[0], pair[1]);
    const TouchingLattice lattice = touching_lattice(pair[0], pair[1], 0.5 * (narrow + wide));
    for (const double side : {1.0, -1.0}) {
      const ContactParastichies contact =
          contact_parastichies({.divergence_rad = side * lattice.divergence_rad, .rise = lattice.rise});
      EXPECT_EQ(contact.pair(), pair);
      EXPECT_TRUE(contact.opposed());
      EXPECT_NEAR(contact.families[0].distance, 2.0 * lattice.radius, 1e-12);
    }
  }
}

TEST(ContactParastichiesTest, WhorlsMultiplyThePair) {
  const TouchingLattice lattice = touching_lattice(1, 2, 0.21);
  const ContactParastichies contact =
      contact_parastichies({.divergence_rad = lattice.divergence_rad / 3.0, .rise = lattice.rise / 3.0, .jugacy = 3});
  EXPECT_EQ(contact.pair(), (std::array{3, 6}));
  EXPECT_NEAR(contact.families[0].distance, 2.0 * 0.21 / 3.0, 1e-13);
  // Decussate: whorls of two, each at right angles to the last.
  EXPECT_EQ(contact_parastichies({.divergence_rad = math::kPi / 2.0, .rise = 0.2, .jugacy = 2}).pair(),
            (std::array{2, 2}));
}

TEST(MeasurePattern, CountsWhatTheLatticeIsMadeOf) {
  const TouchingLattice lattice = touching_lattice(5, 8, 0.06);
  std::vector<Vec2> places;
  for (int k = 0; k < 200; ++k) {
    places.push_back({-k * (lattice.divergence_rad / math::kTurnRad), k * lattice.rise});
  }
  const PatternMeasure measure = measure_pattern(places, 50, 150);
  EXPECT_EQ(measure.m, 5);
  EXPECT_EQ(measure.n, 8);
  EXPECT_EQ(measure.agreement, 1.0);
  EXPECT_NEAR(measure.distance, 0.12, 1e-12);
  EXPECT_NEAR(measure.divergence_rad, math::kTurnRad - lattice.divergence_rad, 1e-12);
  EXPECT_LT(measure.deviation_rad, 1e-12);
}

TEST(CheckCylinderLattice, NamesTheFieldThatIsWrong) {
  EXPECT_EQ(check(CylinderLattice{.rise = 0.0})->where, "rise");
  EXPECT_EQ(check(CylinderLattice{.divergence_rad = std::numeric_limits<double>::infinity()})->where, "divergence_rad");
  EXPECT_EQ(check(CylinderLattice{.jugacy = 0})->where, "jugacy");
  EXPECT_EQ(check_parastichy_pair(3, 2)->where, "n");
  EXPECT_EQ(check_parastichy_pair(2, 4)->message, "must have no common divisor with m, 2, got 4");
  EXPECT_FALSE(check_parastichy_pair(1, 1));
  EXPECT_EQ(van_iterson_diagram({.least_radius = 0.0}).error().where, "least_radius");
  EXPECT_EQ(van_iterson_diagram({.arc_samples = 1}).error().where, "arc_samples");
}

}  // namespace
}  // namespace anthesis
