#include "anthesis/phyllotaxis/divergence_study.h"

#include <gmock/gmock.h>

#include <cmath>
#include <span>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"

namespace anthesis {
namespace {

double folded_deg(double angle_rad) {
  const double angle = math::degrees(angle_rad);
  return std::min(angle, 360.0 - angle);
}

std::span<const DivergenceResult> of_model(const DivergenceStudy& study, StudyModel model) {
  const std::size_t sizes = study.results.size() / kStudyModels;
  return std::span(study.results).subspan(static_cast<std::size_t>(model) * sizes, sizes);
}

DivergenceStudyParams small_study() {
  return {.sizes = DivergenceStudyParams::study_sizes(0.08, 0.3, 8)};
}

TEST(DivergenceStudyTest, AllModelsShowFibonacciPairsThatRiseAsOrgansShrink) {
  const Expected<DivergenceStudy> study = study_divergence(small_study());
  ASSERT_TRUE(study.has_value());
  for (const StudyModel model : {StudyModel::kContactPressure, StudyModel::kCollision, StudyModel::kInhibition}) {
    std::array<int, 2> before = {100, 100};
    for (const DivergenceResult& result : of_model(*study, model)) {
      EXPECT_EQ(result.model, model);
      ASSERT_TRUE(result.measured);
      const std::array<int, 2> pair = {result.pattern.m, result.pattern.n};
      EXPECT_THAT(pair, testing::AnyOf(std::array{2, 3}, std::array{3, 5}, std::array{5, 8}, std::array{8, 13}))
          << model_name(model) << " " << result.size;
      EXPECT_LE(pair, before);
      before = pair;
      EXPECT_NEAR(result.pattern.distance, result.size, 0.06 * result.size) << model_name(model);
      EXPECT_NEAR(folded_deg(result.pattern.divergence_rad), math::degrees(kGoldenAngleRad), 5.0);
    }
  }
}

TEST(DivergenceStudyTest, ContactPressureStandsOnVanItersonsFibonacciBranch) {
  const Expected<DivergenceStudy> study = study_divergence(small_study());
  for (const DivergenceResult& result : of_model(*study, StudyModel::kContactPressure)) {
    const FibonacciLattice branch = fibonacci_lattice(0.5 * result.size);
    EXPECT_EQ(result.pattern.m, branch.m);
    EXPECT_EQ(result.pattern.n, branch.n);
    EXPECT_NEAR(result.pattern.divergence_rad, branch.lattice.divergence_rad, 1e-9);
    EXPECT_NEAR(result.pattern.distance, result.size, 1e-10);
  }
}

TEST(DivergenceStudyTest, OnADiscOrgansThatShrinkWithTheirPlaceLieAsOnACylinder) {
  DivergenceStudyParams params = small_study();
  params.sizes = {0.08, 0.15};
  const Expected<DivergenceStudy> cylinder = study_divergence(params);
  params.profile_mm = {{0.0, 0.0}, {10.0, 0.0}};
  const Expected<DivergenceStudy> disc = study_divergence(params);
  ASSERT_TRUE(disc.has_value());
  for (std::size_t i = 0; i < disc->results.size(); ++i) {
    ASSERT_TRUE(disc->results[i].measured) << i;
    EXPECT_EQ(disc->results[i].pattern.n, cylinder->results[i].pattern.n) << i;
    EXPECT_NEAR(folded_deg(disc->results[i].pattern.divergence_rad),
                folded_deg(cylinder->results[i].pattern.divergence_rad), 2.0);
  }
}

TEST(DivergenceStudyTest, DoesNotDependOnTheNumberOfThreads) {
  DivergenceStudyParams params = small_study();
  params.sizes = {0.1, 0.2, 0.3};
  const Expected<DivergenceStudy> many = study_divergence(params);
  const ThreadLimit limit(1);
  const Expected<DivergenceStudy> one = study_divergence(params);
  for (std::size_t i = 0; i < one->results.size(); ++i) {
    EXPECT_EQ(one->results[i].pattern.divergence_rad, many->results[i].pattern.divergence_rad);
    EXPECT_EQ(one->results[i].pattern.distance, many->results[i].pattern.distance);
  }
}

TEST(DivergenceStudyTest, SaysWhatIsWrongAndStopsWhenAsked) {
  EXPECT_EQ(study_divergence({.sizes = {}}).error().where, "sizes");
  EXPECT_EQ(study_divergence({.sizes = {0.6}}).error().where, "sizes");
  EXPECT_EQ(study_divergence({.profile_mm = {{1.0, 0.0}}}).error().where, "profile_mm");
  EXPECT_EQ(study_divergence({.profile_mm = {{1.0, 1.0}, {0.0, 0.0}}}).error().where, "profile_mm");
  EXPECT_EQ(study_divergence({.first_divergence_rad = NAN}).error().where, "first_divergence_rad");
  EXPECT_EQ(study_divergence({.inhibition_exponent = 0}).error().where, "inhibition_exponent");
  EXPECT_EQ(study_divergence({.births_per_fold = 1.0}).error().where, "births_per_fold");
  EXPECT_EQ(study_divergence(small_study(), [](std::string_view, double) { return false; }).error().code,
            ErrorCode::kCancelled);
}

}  // namespace
}  // namespace anthesis
