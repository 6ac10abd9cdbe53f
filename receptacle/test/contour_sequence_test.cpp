#include "anthesis/receptacle/contour_sequence.h"

#include <gmock/gmock.h>

#include <cmath>

#include "anthesis/base/parallel.h"
#include "tiny_head.h"

namespace anthesis {
namespace {

/// Lengths of the profile between neighbours of one frame.
std::vector<double> spacings(const GrownProfile& profile, std::span<const ContourPoint> frame) {
  std::vector<double> result;
  for (std::size_t i = 0; i + 1 < frame.size(); ++i) {
    result.push_back(profile.length_to(frame[i + 1].s) - profile.length_to(frame[i].s));
  }
  return result;
}

TEST(SampleContours, FillersStandEvenlyBetweenLandmarks) {
  const GrowingReceptacle head(test::tiny_head());
  const std::vector<double> times = {0.0, 0.4, 1.0};
  const ContourSequence sequence = sample_contours(head, times);
  ASSERT_EQ(sequence.frames(), 3u);
  ASSERT_EQ(sequence.points.size(), 3 * sequence.points_per_frame());
  for (std::size_t f = 0; f < times.size(); ++f) {
    const std::span<const ContourPoint> frame = sequence.frame(f);
    const std::vector<double> gaps = spacings(head.at(times[f]), frame);
    std::size_t landmark = head.landmarks() + 1;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      EXPECT_EQ(frame[i].position, head.at(times[f]).point(frame[i].s));
      if (sequence.landmarks[i]) {
        EXPECT_NEAR(frame[i].s, head.landmark(times[f], landmark), 1e-15);
        landmark -= landmark > 0 ? 1 : 0;
      } else {
        EXPECT_NEAR(gaps[i], gaps[i - 1], 1e-10);
      }
    }
    EXPECT_EQ(frame.front().s, 0.0);
    EXPECT_EQ(frame.back().s, 1.0);
    EXPECT_EQ(sequence.ring[f], head.at(times[f]).point(head.ring(times[f])));
  }
}

TEST(SampleContours, TheLongestStretchHasSixPartsAndTheShortestTwo) {
  const ContourSequence sequence = sample_contours(GrowingReceptacle(test::tiny_head()), std::vector<double>{1.0});
  std::vector<std::size_t> parts;
  for (std::size_t i = 1, count = 1; i < sequence.landmarks.size(); ++i, ++count) {
    if (sequence.landmarks[i]) {
      parts.push_back(count);
      count = 0;
    }
  }
  // At time 1 the landmarks are at 0, 0.1, 0.4, 0.8, 1: stretches 0.1, 0.3, 0.4, 0.2 of the length.
  EXPECT_THAT(parts, testing::ElementsAre(2u, 4u, 6u, 3u));
}

TEST(SampleContours, PublishedFillersAreFoundByStepsOfATenThousandth) {
  const GrowingReceptacle head(test::tiny_head(), SectionLookup::kAsPublished);
  const std::vector<double> times = {0.3, 1.0};
  const ContourSequence sequence = sample_contours(head, times);
  const ContourSequence exact = sample_contours(GrowingReceptacle(test::tiny_head()), times);
  ASSERT_EQ(sequence.landmarks, exact.landmarks);
  for (std::size_t i = 1; i < sequence.points.size(); ++i) {
    const double step = (sequence.points[i].s - sequence.points[i - 1].s) / 0.0001;
    if (!sequence.landmarks[i % sequence.points_per_frame()]) {
      EXPECT_NEAR(step, std::round(step), 1e-6);
    }
    EXPECT_NEAR(sequence.points[i].s, exact.points[i].s, 8e-4);
  }
}

TEST(SampleContours, TheSameForAnyNumberOfThreads) {
  const GrowingReceptacle head(test::tiny_head());
  std::vector<double> times;
  for (int i = 0; i <= 64; ++i) {
    times.push_back(i / 64.0);
  }
  const auto sample = [&](int threads) {
    const ThreadLimit limit(threads);
    return sample_contours(head, times);
  };
  const ContourSequence one = sample(1);
  const ContourSequence four = sample(4);
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    ASSERT_EQ(one.points[i].position, four.points[i].position);
  }
}

TEST(ContourTimes, AConstantPaceGivesEqualStepsAndTheEnd) {
  const auto times = contour_times([](double) { return 0.5; }, 0.25);
  ASSERT_TRUE(times.has_value());
  EXPECT_EQ(*times, (std::vector<double>{0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0}));
}

TEST(ContourTimes, APaceThatStopsIsAnError) {
  const auto stopped = contour_times([](double time) { return 0.5 - time; }, 1.0);
  ASSERT_FALSE(stopped.has_value());
  EXPECT_EQ(to_string(stopped.error()), "pace must be > 0, got 0");
  const auto endless = contour_times([](double) { return 1e-9; });
  ASSERT_FALSE(endless.has_value());
  EXPECT_EQ(endless.error().code, ErrorCode::kTooLarge);
  EXPECT_FALSE(contour_times([](double) { return 1.0; }, 0.0).has_value());
}

}  // namespace
}  // namespace anthesis
