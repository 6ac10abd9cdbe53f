#include "anthesis/exchange/divergence_study.h"

#include <gmock/gmock.h>

#include <limits>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++found;
  }
  return found;
}

DivergenceStudy tiny_study() {
  DivergenceStudy study;
  for (const StudyModel model : {StudyModel::kContactPressure, StudyModel::kCollision, StudyModel::kInhibition}) {
    DivergenceResult result;
    result.model = model;
    result.size = 0.25;
    result.rise = 0.0625;
    result.pattern = {.divergence_rad = math::radians(220.0),
                      .deviation_rad = 0.0,
                      .m = 2,
                      .n = 3,
                      .agreement = 1.0,
                      .distance = 0.24};
    result.measured = model != StudyModel::kCollision;
    study.results.push_back(result);
  }
  DivergenceResult small = study.results.back();  // so that the drawing has some width
  small.size = small.pattern.distance = 0.1;
  small.pattern.divergence_rad = kGoldenAngleRad;
  study.results.push_back(small);
  study.arcs = *van_iterson_diagram({.least_radius = 0.1});
  return study;
}

TEST(DivergenceStudyCsv, HasARowForWhatWasMeasuredAndMirrorsAnglesBelowHalfATurn) {
  const std::string csv = divergence_study_csv(tiny_study());
  EXPECT_THAT(csv, testing::HasSubstr("\nmodel,size,distance,rise,divergence_deg,deviation_deg,m,n,agreement\n"));
  EXPECT_THAT(csv, testing::HasSubstr("\ncontact pressure,0.25,0.24,0.0625,140,0,2,3,1\n"));
  EXPECT_THAT(csv, testing::HasSubstr("\ninhibition,"));
  EXPECT_THAT(csv, testing::Not(testing::HasSubstr("\ncollision,")));
}

TEST(DivergenceStudySvg, DrawsTheArcsTheModelsAndTheirNumbers) {
  const DivergenceStudy study = tiny_study();
  const std::string svg = divergence_study_svg(study, "a & b", "made here");
  EXPECT_THAT(svg, testing::StartsWith("<?xml"));
  EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
  EXPECT_THAT(svg, testing::HasSubstr("<title>a &amp; b</title>"));
  EXPECT_THAT(svg, testing::HasSubstr(">(3, 5)</text>"));
  // One in the legend; for each size one for the divergence and two for the pair.
  EXPECT_EQ(count(svg, "stroke=\"#E69F00\""), 4u);
  EXPECT_EQ(count(svg, "fill=\"#009E73\""), 7u);
  EXPECT_EQ(count(svg, "fill=\"#0072B2\""), 1u);  // not measured
}

TEST(DivergenceStudySvg, IsADrawingWithNothingToDraw) {
  DivergenceStudy study;
  DivergenceResult result;
  result.measured = true;
  result.pattern.divergence_rad = std::numeric_limits<double>::quiet_NaN();
  study.results.push_back(result);
  const std::string svg = divergence_study_svg(study, "", "");
  EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr("nan")));
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr("inf")));
}

}  // namespace
}  // namespace anthesis
