#include "anthesis/geometry/bspline.h"

#include <gtest/gtest.h>

#include "anthesis/base/random.h"

namespace anthesis {
namespace {

std::vector<Vec3> random_points(int count) {
  Rng rng(3, static_cast<std::uint64_t>(count), RandomPurpose::kTest);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    points.push_back({rng.normal(), rng.normal(), rng.normal()});
  }
  return points;
}

TEST(ClampedBasis, IsAPartitionOfUnityThatReproducesLinearFunctions) {
  for (int degree = 1; degree <= 7; ++degree) {
    for (const int n : {degree + 1, degree + 2, degree + 6}) {
      for (int i = 0; i <= 40; ++i) {
        const double t = i / 40.0;
        const BasisFunctions basis = clamped_basis(n, degree, t);
        double sum = 0.0;
        double linear = 0.0;
        for (int k = 0; k < basis.count; ++k) {
          ASSERT_GE(basis.weight[k], 0.0);
          sum += basis.weight[k];
          // Greville's abscissae, the control points of the identity: means of `degree` consecutive knots.
          double greville = 0.0;
          for (int j = 1; j <= degree; ++j) {
            greville += std::clamp(basis.first + k + j - degree, 0, n - degree) / static_cast<double>(n - degree);
          }
          linear += basis.weight[k] * greville / degree;
        }
        EXPECT_NEAR(sum, 1.0, 1e-14);
        EXPECT_NEAR(linear, t, 1e-14) << "degree " << degree << ", " << n << " points";
      }
    }
  }
}

TEST(BSplineCurve, StartsAndEndsAtItsControlPointsAlongThem) {
  const BSplineCurve<Vec3> curve{3, random_points(8)};
  EXPECT_EQ(curve.at(0.0), curve.controls.front());
  EXPECT_EQ(curve.at(1.0), curve.controls.back());
  const Vec3 start = curve.derivative(0.0);
  EXPECT_NEAR(length(cross(start, curve.controls[1] - curve.controls[0])), 0.0, 1e-12);
}

TEST(BSplineCurve, WithoutInteriorKnotsIsABezierCurve) {
  const BSplineCurve<Vec3> curve{4, random_points(5)};
  for (const double t : {0.13, 0.5, 0.77}) {
    std::vector<Vec3> points = curve.controls;  // de Casteljau
    while (points.size() > 1) {
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        points[i] = lerp(points[i], points[i + 1], t);
      }
      points.pop_back();
    }
    EXPECT_NEAR(length(curve.at(t) - points[0]), 0.0, 1e-14);
  }
}

TEST(BSplineCurve, DerivativeIsTheLimitOfDifferences) {
  for (int degree = 1; degree <= 5; ++degree) {
    const BSplineCurve<Vec3> curve{degree, random_points(9)};
    for (const double t : {0.05, 0.31, 0.62, 0.93}) {
      const double h = 1e-6;
      const Vec3 difference = (curve.at(t + h) - curve.at(t - h)) / (2 * h);
      EXPECT_NEAR(length(curve.derivative(t) - difference), 0.0, 1e-6) << "degree " << degree << " t " << t;
    }
  }
}

TEST(BSplineCurve, GivenKnotsThatAreEquallySpacedChangeNothing) {
  for (int degree = 1; degree <= 5; ++degree) {
    const BSplineCurve<Vec3> uniform{degree, random_points(9)};
    BSplineCurve<Vec3> given = uniform;
    given.inner_knots = uniform.knots();
    given.inner_knots.erase(given.inner_knots.begin());
    given.inner_knots.pop_back();
    for (const double t : {0.0, 0.05, 0.31, 0.62, 0.93, 1.0}) {
      EXPECT_NEAR(length(given.at(t) - uniform.at(t)), 0.0, 1e-14);
      EXPECT_NEAR(length(given.derivative(t) - uniform.derivative(t)), 0.0, 1e-12);
    }
    EXPECT_EQ(given.knots(), uniform.knots());
  }
}

TEST(BSplineCurve, DerivativeOverUnevenKnotsIsTheLimitOfDifferences) {
  const BSplineCurve<Vec3> curve{3, random_points(9), {0.1, 0.4, 0.4, 0.7, 0.75}};
  EXPECT_EQ(curve.knots(), (std::vector<double>{0.0, 0.1, 0.4, 0.7, 0.75, 1.0}));
  for (const double t : {0.05, 0.31, 0.62, 0.72, 0.93}) {
    const double h = 1e-6;
    const Vec3 difference = (curve.at(t + h) - curve.at(t - h)) / (2 * h);
    EXPECT_NEAR(length(curve.derivative(t) - difference), 0.0, 1e-6) << t;
  }
}

TEST(BezierChain, IsItsPiecesOneAfterTheOther) {
  const std::vector<Vec3> points = random_points(7);
  const BSplineCurve<Vec3> chain = bezier_chain(points, 3);
  for (int piece = 0; piece < 2; ++piece) {
    const BSplineCurve<Vec3> alone{3, {points.begin() + 3 * piece, points.begin() + 3 * piece + 4}};
    for (const double x : {0.0, 0.2, 0.5, 0.9}) {
      EXPECT_NEAR(length(chain.at(0.5 * (piece + x)) - alone.at(x)), 0.0, 1e-14);
      EXPECT_NEAR(length(chain.derivative(0.5 * (piece + x)) - 2.0 * alone.derivative(x)), 0.0, 1e-13);
    }
  }
  EXPECT_EQ(chain.at(1.0), points.back());
}

TEST(BSplineCurve, BezierControlsAreTheSameCurve) {
  for (const BSplineCurve<Vec3>& curve :
       {BSplineCurve<Vec3>{3, random_points(8)}, BSplineCurve<Vec3>{1, random_points(4)},
        BSplineCurve<Vec3>{4, random_points(9), {0.2, 0.6, 0.6, 0.6}}, bezier_chain(random_points(7), 2)}) {
    const std::vector<double> knots = curve.knots();
    const std::vector<Vec3> controls = curve.bezier_controls();
    const std::size_t each = static_cast<std::size_t>(curve.degree) + 1;
    ASSERT_EQ(controls.size(), (knots.size() - 1) * each);
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
      const auto from = controls.begin() + static_cast<std::ptrdiff_t>(k * each);
      const BSplineCurve<Vec3> piece{curve.degree, {from, from + curve.degree + 1}};
      for (const double x : {0.0, 0.3, 0.8}) {
        EXPECT_NEAR(length(piece.at(x) - curve.at(knots[k] + x * (knots[k + 1] - knots[k]))), 0.0, 1e-13);
      }
    }
  }
}

TEST(SurfaceAt, BoundaryIsTheCurveOfTheBoundaryControlPoints) {
  constexpr int kAcross = 5;
  constexpr int kAlong = 6;
  const std::vector<Vec3> controls = random_points(kAcross * kAlong);
  BSplineCurve<Vec3> margin{3, {}};
  for (int j = 0; j < kAlong; ++j) {
    margin.controls.push_back(controls[static_cast<std::size_t>(j) * kAcross]);
  }
  for (const double v : {0.0, 0.2, 0.66, 1.0}) {
    const Vec3 point = surface_at(std::span<const Vec3>(controls), clamped_basis(kAcross, 2, 0.0),
                                  clamped_basis(kAlong, 3, v), kAcross);
    EXPECT_NEAR(length(point - margin.at(v)), 0.0, 1e-15);
  }
}

}  // namespace
}  // namespace anthesis
