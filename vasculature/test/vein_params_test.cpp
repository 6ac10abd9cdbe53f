#include "anthesis/vasculature/vein_params.h"

#include <gtest/gtest.h>

namespace anthesis {
namespace {

TEST(TimeCourse, IsABrokenLineWithSteps) {
  const TimeCourse course{{{0.2, 1.0}, {0.4, 2.0}, {0.4, 5.0}, {0.8, 7.0}}};
  EXPECT_DOUBLE_EQ(course.at(0.0), 1.0);
  EXPECT_DOUBLE_EQ(course.at(0.3), 1.5);
  EXPECT_NEAR(course.at(0.4 - 1e-12), 2.0, 1e-10);
  EXPECT_DOUBLE_EQ(course.at(0.4), 5.0);
  EXPECT_DOUBLE_EQ(course.at(0.6), 6.0);
  EXPECT_DOUBLE_EQ(course.at(1.0), 7.0);
}

TEST(VeinParams, OfTheSpeciesAreSound) {
  for (const VeinSource source : {VeinSource::kPaper, VeinSource::kAsPublished}) {
    for (const VeinParams& params : {bellis_veins(source), sunflower_veins(source), gerbera_veins(source)}) {
      const std::optional<Error> error = check(params);
      EXPECT_FALSE(error.has_value()) << to_string(*error);
    }
  }
}

TEST(VeinParams, ErrorsNameTheField) {
  VeinParams params;
  params.initials[1].jitter.probability = 1.5;
  std::optional<Error> error = check(params);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->where, "initials[1].jitter.probability");

  params = {};
  params.ground_resistivity.points = {{0.5, 1.0}, {0.4, 1.0}};
  error = check(params);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->where, "ground_resistivity[1]");

  params = {};
  params.depth_course.points.clear();
  error = check(params);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->where, "depth_course");

  params = {};
  params.depth_course.points = {{0.5, 1.0}, {0.25, 1.0}};
  error = check(params);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(to_string(*error),
            "depth_course[1] must have a time in [0, 1] that is not before the last one's, got 0.25");

  params = {};
  params.initials[1].depth_mm = 1.0;
  params.initials[1].depth_range = {1.0, 20.0};
  params.depth_course.points = {{0.0, 0.0}, {1.0, 20.0}};  // 400 mm in steps of 0.02
  error = check(params);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(to_string(*error),
            "initials[1].depth_mm must be at most 10000 steps with depth_range and depth_course, got 20000");

  params = {};
  params.merge_distance_mm = 0.4 * params.step_mm;  // a strand could jump over what it is to join
  error = check(params);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(to_string(*error), "merge_distance_mm must be at least half of step_mm, 0.01, got 0.008");
}

}  // namespace
}  // namespace anthesis
