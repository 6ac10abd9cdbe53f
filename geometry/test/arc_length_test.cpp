#include "anthesis/geometry/arc_length.h"

#include <gtest/gtest.h>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

TEST(ArcLength, OfAParabolaIsItsClosedForm) {
  // y = x^2 over [0, 1] as a Bezier curve; length (2 sqrt 5 + asinh 2) / 4.
  const BSplineCurve<Vec2> parabola{2, {{0.0, 0.0}, {0.5, 0.0}, {1.0, 1.0}}};
  const ArcLength arc(parabola);
  EXPECT_NEAR(arc.total_mm(), (2.0 * std::sqrt(5.0) + std::asinh(2.0)) / 4.0, 1e-14);
  // The stretch up to x has length (2 x sqrt(1 + 4 x^2) + asinh 2 x) / 4.
  for (const double x : {0.1, 0.37, 0.9}) {
    EXPECT_NEAR(arc.length_at_mm(x), (2.0 * x * std::sqrt(1.0 + 4.0 * x * x) + std::asinh(2.0 * x)) / 4.0, 1e-14);
  }
}

TEST(ArcLength, EqualSharesAreEqualStretchesInSpaceToo) {
  const BSplineCurve<Vec3> curve{3, {{0, 0, 0}, {1, 3, 0}, {4, 0, 2}, {4, 4, 4}, {9, 4, 0}, {9, 0, 1}}};
  const ArcLength arc(curve);
  constexpr int kParts = 7;
  for (int part = 0; part < kParts; ++part) {
    const double from = arc.t_from_s(static_cast<double>(part) / kParts);
    const double to = arc.t_from_s(static_cast<double>(part + 1) / kParts);
    double chords = 0.0;
    constexpr int kSteps = 20'000;
    Vec3 before = curve.at(from);
    for (int i = 1; i <= kSteps; ++i) {
      const Vec3 point = curve.at(from + (to - from) * i / kSteps);
      chords += length(point - before);
      before = point;
    }
    EXPECT_NEAR(chords, arc.total_mm() / kParts, 1e-7);
  }
}

}  // namespace
}  // namespace anthesis
