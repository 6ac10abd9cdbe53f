#include "anthesis/exchange/section_figures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"

namespace anthesis {
namespace {

/// A half disc that becomes `growth` times as large from frame to frame.
SectionSequence growing_dome(std::size_t frames, double growth = 1.1) {
  SectionSequence sections;
  sections.points_per_frame = 25;
  double size = 1.0;
  for (std::size_t f = 0; f < frames; ++f, size *= growth) {
    for (int k = 0; k <= 20; ++k) {
      const double angle = 0.5 * math::kPi * k / 20.0;
      sections.points.push_back({k == 0 ? 0.0 : size * math::sin(angle), k == 20 ? 0.0 : size * math::cos(angle)});
    }
    for (int k = 3; k >= 0; --k) {
      sections.points.push_back({0.25 * k * size, 0.0});
    }
  }
  return sections;
}

std::size_t count(const std::string& text, std::string_view what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++found;
  }
  return found;
}

/// Every path of a fill: its closed loops' points.
std::vector<std::vector<Vec2>> loops_of(const std::string& svg, const std::string& fill) {
  std::vector<std::vector<Vec2>> loops;
  for (std::size_t at = svg.find("<path d=\""); at != std::string::npos; at = svg.find("<path d=\"", at + 1)) {
    const std::size_t end = svg.find('"', at + 9);
    if (svg.compare(end, fill.size() + 8, "\" fill=\"" + fill) != 0) {
      continue;
    }
    for (std::size_t i = at + 9; i < end;) {
      if (svg[i] == 'M') {
        loops.emplace_back();
      }
      if (svg[i] == 'Z') {
        ++i;
        continue;
      }
      Vec2 p;
      const auto x = std::from_chars(svg.data() + i + 1, svg.data() + end, p.x);
      const auto y = std::from_chars(x.ptr + 1, svg.data() + end, p.y);
      loops.back().push_back(p);
      i = static_cast<std::size_t>(y.ptr - svg.data());
    }
  }
  return loops;
}

double area(const std::vector<Vec2>& loop) {
  double twice = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    twice += cross(loop[i], loop[(i + 1) % loop.size()]);
  }
  return 0.5 * std::fabs(twice);
}

TEST(SectionWeightsSvg, HasAPanelForEachPointShownAndOneForAll) {
  const SectionSequence sections = growing_dome(2);
  const std::vector<std::uint32_t> shown{0, 10, 22};
  const Expected<std::string> svg =
      section_weights_svg(sections.frame(0), shown, {.title = "a < b", .caption = "made by hand", .unit_mm = 2.0});
  ASSERT_TRUE(svg.has_value()) << to_string(svg.error());
  EXPECT_EQ(svg->substr(0, 5), "<?xml");
  EXPECT_NE(svg->find("a &lt; b"), std::string::npos);
  EXPECT_NE(svg->find("made by hand"), std::string::npos);
  EXPECT_NE(svg->find(">25 control points<"), std::string::npos);
  for (const std::uint32_t c : shown) {
    EXPECT_EQ(count(*svg, ">control point " + std::to_string(c) + "<"), 1u);
  }
  EXPECT_EQ(count(*svg, "r=\"4\""), 3u);  // the point shown
  EXPECT_EQ(count(*svg, " mm<"), 1u);
  EXPECT_EQ(count(*svg, "nan"), 0u);
}

TEST(SectionWeightsSvg, BandsAreNestedAndHoldTheirPoint) {
  // From the boundary's point of view: of the field of control point 10, more than 0.1 is within more than 0.03.
  const SectionSequence sections = growing_dome(2);
  const std::vector<std::uint32_t> shown{10};
  const std::string svg = *section_weights_svg(sections.frame(0), shown, {.width_px = 2000.0, .with_mesh = false});
  std::vector<double> areas;
  for (std::size_t at = svg.find(" stroke=\"#ffffff\" stroke-opacity=\".75\""); at != std::string::npos;
       at = svg.find(" stroke=\"#ffffff\" stroke-opacity=\".75\"", at + 1)) {
    const std::string fill = svg.substr(at - 8, 7);
    double sum = 0.0;
    for (const std::vector<Vec2>& loop : loops_of(svg, fill)) {
      sum += area(loop);
    }
    areas.push_back(sum);
  }
  ASSERT_EQ(areas.size(), 7u);
  EXPECT_TRUE(std::is_sorted(areas.begin(), areas.end(), std::greater<>()));
  EXPECT_GT(areas.front(), 10.0 * areas[4]);
  EXPECT_GT(areas.back(), 0.0);
}

TEST(SectionDisplacementSvg, ShowsHowFarAHeadThatRisesAsAWholeMoves) {
  SectionSequence sections = growing_dome(2, 1.0);
  for (std::size_t i = sections.points_per_frame; i < sections.points.size(); ++i) {
    sections.points[i].y += 0.5;
  }
  const Expected<std::string> svg = section_displacement_svg(sections, 0, 1, {.unit_mm = 10.0});
  ASSERT_TRUE(svg.has_value()) << to_string(svg.error());
  EXPECT_NE(svg->find(">moved, mm<"), std::string::npos);
  EXPECT_NE(svg->find(">4<"), std::string::npos);  // bands of 1 mm below 5
  EXPECT_EQ(svg->find(">6<"), std::string::npos);
  EXPECT_NE(svg->find("frame 0 (solid) to 1 (dashed)"), std::string::npos);
  // Everywhere 5 mm: the region of the highest band is the whole section, one loop as large as the paper under it.
  const std::size_t last = svg->rfind(" stroke=\"#ffffff\" stroke-opacity=\".75\"");
  const std::vector<std::vector<Vec2>> loops = loops_of(*svg, svg->substr(last - 8, 7));
  ASSERT_EQ(loops.size(), 1u);
  const std::vector<std::vector<Vec2>> paper = loops_of(*svg, "#faf8ee");
  ASSERT_EQ(paper.size(), 1u);
  EXPECT_NEAR(area(loops[0]), area(paper[0]), 1e-3 * area(paper[0]));
}

TEST(SectionDisplacementSvg, DrawsAHeadThatStandsStill) {
  const Expected<std::string> svg = section_displacement_svg(growing_dome(2, 1.0), 0, 1);
  ASSERT_TRUE(svg.has_value());
  EXPECT_EQ(count(*svg, "nan"), 0u);
  EXPECT_NE(svg->find(">moved, units<"), std::string::npos);
}

TEST(SectionGrowthSvg, StretchesTheGridWithTheHead) {
  // An even growth, which the odd condition on the axis follows exactly: panels, each with its own scale, are alike.
  const SectionSequence sections = growing_dome(12);
  const std::vector<std::size_t> frames{0, 11};
  SectionFigureParams params;
  params.interior.axis = AxisCondition::kZero;
  const Expected<std::string> svg = section_growth_svg(sections, frames, 10, params);
  ASSERT_TRUE(svg.has_value()) << to_string(svg.error());
  const std::vector<std::vector<Vec2>> paper = loops_of(*svg, "#faf8ee");
  ASSERT_EQ(paper.size(), 2u);
  const std::string fill = "#5cb296";
  const std::vector<std::vector<Vec2>> meshes = loops_of(*svg, fill);
  ASSERT_GT(meshes.size(), 40u);
  ASSERT_EQ(meshes.size() % 2, 0u);
  const Vec2 apart = paper[1].back() - paper[0].back();
  for (std::size_t m = 0; m < meshes.size() / 2; ++m) {
    const std::vector<Vec2>& before = meshes[m];
    const std::vector<Vec2>& after = meshes[meshes.size() / 2 + m];
    for (std::size_t k = 0; k < before.size(); ++k) {
      EXPECT_NEAR(after[k].x, before[k].x + apart.x, 0.02);
      EXPECT_NEAR(after[k].y, before[k].y + apart.y, 0.02);
    }
  }
  EXPECT_EQ(count(*svg, " units<"), 2u);
}

TEST(SectionFigures, AreTheSameForAnyNumberOfThreads) {
  const SectionSequence sections = growing_dome(5);
  const std::vector<std::size_t> frames{0, 2, 4};
  const auto drawn = [&](int threads) {
    const ThreadLimit limit(threads);
    return *section_growth_svg(sections, frames, 40) + *section_displacement_svg(sections, 0, 4);
  };
  EXPECT_EQ(drawn(1), drawn(4));
}

TEST(SectionFigures, NameWhatIsWrong) {
  const SectionSequence sections = growing_dome(3);
  const std::vector<std::uint32_t> shown{25};
  const auto message = [](const Expected<std::string>& svg) { return svg ? "" : to_string(svg.error()); };
  EXPECT_EQ(message(section_weights_svg(sections.frame(0), shown)), "shown must be below 25, got 25");
  EXPECT_EQ(message(section_displacement_svg(sections, 1, 3)), "frames must ascend and be below 3, got 3");
  EXPECT_EQ(message(section_displacement_svg(sections, 1, 2, {.unit_mm = -1.0})),
            "unit_mm must be between 0 and 1e9, got -1");
  EXPECT_EQ(message(section_growth_svg(sections, std::vector<std::size_t>{1, 1})),
            "frames must be 1 to 60, ascend and be below 3");
  EXPECT_EQ(message(section_growth_svg(sections, std::vector<std::size_t>{0, 1}, 2)),
            "across must be between 4 and 200, got 2");
}

}  // namespace
}  // namespace anthesis
