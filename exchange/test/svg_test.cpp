#include "anthesis/exchange/svg.h"

#include <gmock/gmock.h>

#include <limits>

#include "tiny_species.h"

namespace anthesis {
namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++found;
  }
  return found;
}

TEST(PlanSvg, DrawsADiscForEachOrganAndALegendThatCountsThem) {
  const Development development = test::grow_tiny();
  const Expected<Plan> plan = plan_of(development, 1.0);
  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->discs.size(), development.organs().size());
  const std::string svg = plan_svg(*plan);
  EXPECT_EQ(count(svg, "<circle"), development.organs().size() + 2);  // two kinds in the legend
  EXPECT_THAT(svg, testing::HasSubstr(">petal: "));
  EXPECT_THAT(svg, testing::HasSubstr(" mm</text>"));
}

TEST(PlanSvg, NumbersAndLinksAreDrawnIfAskedFor) {
  Plan plan;
  plan.discs = {{.centre_mm = {0.0, 0.0}, .id = 41}, {.centre_mm = {3.0, 0.0}, .id = 42, .age = 1.0}};
  plan.links = {{0, 1}, {0, 9}};  // the second names no disc
  plan.numbers = true;
  plan.colour = PlanColour::kAge;
  const std::string svg = plan_svg(plan);
  EXPECT_THAT(svg, testing::HasSubstr(">41</text>"));
  EXPECT_THAT(svg, testing::HasSubstr(">42</text>"));
  EXPECT_EQ(count(svg, "<path"), 1u);
  EXPECT_THAT(svg, testing::HasSubstr("#3aa655"));  // young is green
  EXPECT_THAT(svg, testing::HasSubstr("#c8372d"));  // old is red
}

TEST(PlanSvg, LeavesOutWhatIsNotFiniteAndEscapesWords) {
  Plan plan;
  plan.title = "a < b & \"c\"\x01";
  plan.discs = {{.centre_mm = {std::numeric_limits<double>::quiet_NaN(), 0.0}}, {.centre_mm = {1.0, 1.0}}};
  const std::string svg = plan_svg(plan);
  EXPECT_EQ(count(svg, "<circle"), 1u);
  EXPECT_THAT(svg, testing::HasSubstr("a &lt; b &amp; &quot;c&quot; </title>"));
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr("nan")));
}

TEST(StepPlotSvg, HasItsStepsAxesAndFibonacciGuides) {
  StepPlot plot;
  plot.x_label = "half angle (degrees)";
  plot.y_label = "ray florets";
  plot.points = {{20.0, 34.0}, {50.0, 21.0}, {80.0, 13.0}};
  plot.guides = fibonacci_guides(40.0);
  EXPECT_EQ(plot.guides, (std::vector<double>{1, 2, 3, 5, 8, 13, 21, 34}));
  const std::string svg = step_plot_svg(plot);
  EXPECT_EQ(count(svg, "stroke-dasharray"), 8u);
  EXPECT_THAT(svg, testing::HasSubstr(">half angle (degrees)</text>"));
  EXPECT_THAT(svg, testing::HasSubstr(">34</text>"));
  EXPECT_EQ(count(svg, "<circle"), 3u);
}

TEST(StepPlotSvg, AnEmptyPlotIsStillADrawing) {
  const std::string svg = step_plot_svg({});
  EXPECT_THAT(svg, testing::StartsWith("<?xml"));
  EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
}

}  // namespace
}  // namespace anthesis
