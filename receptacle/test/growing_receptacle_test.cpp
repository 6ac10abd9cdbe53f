#include "anthesis/receptacle/growing_receptacle.h"

#include <gmock/gmock.h>

#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/geometry/arc_length.h"
#include "tiny_head.h"

namespace anthesis {
namespace {

std::string message(const DigitisedHead& head) {
  const std::optional<Error> error = check(head);
  return error ? to_string(*error) : "no error";
}

TEST(GrowingReceptacle, RunsFromTheFirstSectionToTheLast) {
  const DigitisedHead head = test::tiny_head();
  const GrowingReceptacle receptacle(head);
  for (const bool last : {false, true}) {
    const BSplineCurve<Vec2>& curve = head.sections[last ? 2 : 0].profile;
    const ArcLength arc(curve);
    for (int i = 0; i <= 100; ++i) {
      const double s = 0.01 * i;
      const Vec2 drawn = curve.at(arc.t_from_s(s));
      EXPECT_LT(length(receptacle.point(last ? 1.0 : 0.0, s) - drawn), 1e-10) << s;
    }
    EXPECT_NEAR(receptacle.length(last ? 1.0 : 0.0), arc.total_mm(), 1e-9);
  }
  EXPECT_EQ(receptacle.ring(0.0), 0.8);
  EXPECT_EQ(receptacle.ring(1.0), 0.0);
  // Three sections and no inner knot: Bernstein polynomials of degree 2.
  EXPECT_NEAR(receptacle.ring(0.25), 0.5625 * 0.8 + 0.375 * 0.4, 1e-15);
}

TEST(GrowingReceptacle, ScaledCopiesOfOneSectionBlendToScaledCopies) {
  DigitisedHead head = test::tiny_head();
  const BSplineCurve<Vec2> shape = head.sections[2].profile;
  for (std::size_t k = 0; k < 3; ++k) {
    head.sections[k].profile = shape;
    for (Vec2& control : head.sections[k].profile.controls) {
      control = static_cast<double>(k + 1) * control;
    }
  }
  head.scale = 10.0;
  const GrowingReceptacle receptacle(head);
  const ArcLength arc(shape);
  for (const double time : {0.0, 0.3, 0.77, 1.0}) {
    const double size = 10.0 * (1.0 + 2.0 * time);  // 1, 2, 3 are on a line, which Bernstein polynomials keep
    EXPECT_NEAR(receptacle.length(time), size * arc.total_mm(), 1e-9 * size);
    EXPECT_LT(length(receptacle.point(time, 0.4) - size * shape.at(arc.t_from_s(0.4))), 1e-9 * size);
    EXPECT_NEAR(receptacle.at(time).length_to(0.4), 0.4 * receptacle.length(time), 1e-9 * size);  // s is its share
  }
}

TEST(GrowingReceptacle, LengthIsThatOfAFineChordSum) {
  const GrowingReceptacle receptacle(test::tiny_head());
  for (const double time : {0.1, 0.5, 0.9}) {
    const GrownProfile profile = receptacle.at(time);
    double sum = 0.0;
    constexpr int kChords = 100'000;
    for (int i = 0; i < kChords; ++i) {
      sum += length(profile.point((i + 1.0) / kChords) - profile.point(static_cast<double>(i) / kChords));
    }
    EXPECT_NEAR(receptacle.length(time), sum, 1e-7);
    EXPECT_NEAR(profile.length(), sum, 1e-7);
  }
}

TEST(GrowingReceptacle, StraightFlankOfTracedPointsIsACone) {
  DigitisedHead head = test::tiny_head();
  for (std::size_t k = 0; k < 3; ++k) {
    const double size = static_cast<double>(k + 1);
    head.sections[k].profile = traced_profile({{0.0, 4.0 * size}, {1.5 * size, 2.0 * size}, {3.0 * size, 0.0}});
  }
  for (const SectionLookup lookup : {SectionLookup::kExact, SectionLookup::kAsPublished}) {
    const GrowingReceptacle receptacle(head, lookup);
    const double tolerance = lookup == SectionLookup::kExact ? 1e-10 : 1e-2;  // 0.1 % of the last chord is missing
    EXPECT_NEAR(receptacle.length(0.5), 10.0, tolerance);
    EXPECT_NEAR(receptacle.radius(0.5, 0.25), 1.5, tolerance);
    EXPECT_NEAR(receptacle.point(0.5, 0.25).y, 6.0, tolerance);
  }
}

TEST(GrownProfile, LengthAlongItAndItsInverseAgree) {
  for (const SectionLookup lookup : {SectionLookup::kExact, SectionLookup::kAsPublished}) {
    const GrownProfile profile = GrowingReceptacle(test::tiny_head(), lookup).at(0.6);
    for (int i = 0; i <= 50; ++i) {
      const double s = 0.02 * i;
      EXPECT_NEAR(profile.s_at_length(profile.length_to(s)), s, 1e-12);
    }
    EXPECT_EQ(profile.s_at_length(-1.0), 0.0);
    EXPECT_EQ(profile.s_at_length(1e9), 1.0);
  }
}

TEST(GrowingReceptacle, OneMomentIsWhatTheFunctionsOfTimeSay) {
  for (const SectionLookup lookup : {SectionLookup::kExact, SectionLookup::kAsPublished}) {
    const GrowingReceptacle receptacle(test::tiny_head(), lookup);
    const GrownProfile profile = receptacle.at(0.35);
    for (const double s : {0.0, 0.123, 0.5, 0.99, 1.0}) {
      EXPECT_LT(length(profile.point(s) - receptacle.point(0.35, s)), 1e-13);
    }
  }
}

TEST(GrowingReceptacle, MaterialLinesRunFromTheApexToTheBaseAndInvert) {
  const GrowingReceptacle receptacle(test::tiny_head());
  for (const double time : {0.0, 0.2, 0.5, 0.8, 1.0}) {
    EXPECT_EQ(receptacle.s_from_material(time, 0.0), 0.0);
    EXPECT_NEAR(receptacle.s_from_material(time, 1.0), 1.0, 1e-15);
    double before = -1.0;
    for (int i = 0; i <= 200; ++i) {
      const double u = i / 200.0;
      const double s = receptacle.s_from_material(time, u);
      EXPECT_GT(s, before);
      EXPECT_NEAR(receptacle.material_from_s(time, s), u, 1e-12);
      before = s;
    }
  }
}

TEST(GrowingReceptacle, TissueWithoutLandmarksStretchesEvenly) {
  DigitisedHead head = test::tiny_head();
  for (DigitisedSection& section : head.sections) {
    section.landmarks.clear();
  }
  const GrowingReceptacle receptacle(head);
  EXPECT_NEAR(receptacle.s_from_material(0.4, 0.3), 0.3, 1e-15);
  EXPECT_NEAR(receptacle.material_from_s(0.4, 0.3), 0.3, 1e-15);
}

TEST(GrowingReceptacle, LandmarksThatAYoungSectionLacksKeepTheirRatioToTheNextOutside) {
  const GrowingReceptacle receptacle(test::tiny_head());
  ASSERT_EQ(receptacle.landmarks(), 3u);
  EXPECT_EQ(receptacle.landmark(0.0, 0), 1.0);
  EXPECT_EQ(receptacle.landmark(0.0, 1), 0.8);
  EXPECT_NEAR(receptacle.landmark(0.0, 2), 0.8 * 0.5 / 0.75, 1e-15);
  EXPECT_NEAR(receptacle.landmark(0.0, 3), 0.8 * 0.5 / 0.75 * 0.1 / 0.4, 1e-15);
  EXPECT_EQ(receptacle.landmark(1.0, 3), 0.1);
  EXPECT_EQ(receptacle.landmark(0.0, 4), 0.0);
}

/// The published search: 1, 0.999, 0.998 ... down to the first whose line is not outside s.
TEST(GrowingReceptacle, PublishedMaterialCoordinateIsTheFirstOfAThousandInside) {
  const GrowingReceptacle receptacle(test::tiny_head(), SectionLookup::kAsPublished);
  for (const double time : {0.1, 0.7}) {
    for (int i = 1; i <= 300; ++i) {
      const double s = i / 300.0;
      double u = 1.0;
      while (u > 0.0 && receptacle.s_from_material(time, u) > s) {
        u -= 0.001;
      }
      EXPECT_NEAR(receptacle.material_from_s(time, s), u, 1e-15) << s;
    }
  }
  EXPECT_EQ(receptacle.material_from_s(0.5, 0.0), 0.0);  // the published search falls off the end here
}

TEST(GrowingReceptacle, GivenKnotsShiftTheSectionsInTime) {
  DigitisedHead head = test::tiny_head();
  head.sections.push_back(head.sections.back());
  head.sections.back().ring = 0.0;
  EXPECT_EQ(message(head), "no error");
  const GrowingReceptacle even(head);
  head.knots = {0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0};
  const GrowingReceptacle the_same(head);
  EXPECT_EQ(even.ring(0.3), the_same.ring(0.3));
  head.knots[3] = 0.2;
  const GrowingReceptacle earlier(head);
  EXPECT_LT(earlier.ring(0.3), even.ring(0.3));
}

TEST(CheckDigitisedHead, SaysWhichSectionIsWrong) {
  EXPECT_EQ(message(test::tiny_head()), "no error");
  DigitisedHead head = test::tiny_head();
  head.sections.pop_back();
  EXPECT_EQ(message(head), "sections must be 3 to 100, got 2");
  head = test::tiny_head();
  head.sections[2].landmarks[1] = 0.9;
  EXPECT_EQ(message(head), "sections[2].landmarks[1] must descend within (0, 1], got 0.9");
  head = test::tiny_head();
  head.sections[1].landmarks.clear();
  EXPECT_EQ(message(head), "sections[1].landmarks must be no fewer than the section before has, got 0");
  head = test::tiny_head();
  head.sections[1].ring = std::nan("");
  EXPECT_THAT(message(head), testing::HasSubstr("sections[1].ring must be"));
  head = test::tiny_head();
  head.sections[1].profile.controls[1].x = -1.0;
  EXPECT_THAT(message(head), testing::HasSubstr("sections[1].profile"));
  head = test::tiny_head();
  head.sections[1].profile = traced_profile({{0.0, 4.0}, {3.0, 1.0}, {3.0, 3.0}, {1.0, 0.0}});
  EXPECT_THAT(message(head), testing::HasSubstr("sections[1].profile must not touch or cross itself, got the place"));
  head = test::tiny_head();
  head.knots = {0.0, 0.0, 0.0, 1.0};
  EXPECT_EQ(message(head), "knots must be three more than the 3 sections, got 4");
  head = test::tiny_head();
  head.scale = 0.0;
  EXPECT_THAT(message(head), testing::HasSubstr("scale must be > 0"));
}

}  // namespace
}  // namespace anthesis
