#include "anthesis/exchange/meristem_figures.h"

#include <gtest/gtest.h>

namespace anthesis {
namespace {

std::size_t count(const std::string& text, std::string_view what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) {
    ++n;
  }
  return n;
}

TEST(MeristemFigures, AreWholeDrawingsWithABeadForEachPrimordium) {
  for (const MeristemFigure figure :
       {MeristemFigure::kModes, MeristemFigure::kSelfSimilar, MeristemFigure::kHierarchy}) {
    const auto svg = meristem_figure_svg(figure);
    ASSERT_TRUE(svg);
    EXPECT_EQ(svg->rfind("</svg>\n"), svg->size() - 7);
    EXPECT_EQ(count(*svg, "<g"), count(*svg, "</g>"));
    EXPECT_GT(count(*svg, "<circle"), 300u);
    EXPECT_EQ(svg->find("nan"), std::string::npos);
    EXPECT_EQ(*svg, *meristem_figure_svg(figure));
  }
}

}  // namespace
}  // namespace anthesis
