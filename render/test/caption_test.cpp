#include "anthesis/render/caption.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace anthesis {
namespace {

Image grey(int width, int height, int channels = 3) {
  return {width, height, channels, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * channels, 128)};
}

/// The lit points of a text in an image of 200 rows, where a point is a pixel.
std::string lit(std::string_view text, int width) {
  Image image = grey(width, 200);
  write_caption(image, text);
  std::string rows;
  for (int y = 190; y < 197; ++y) {
    for (int x = 0; x < width; ++x) {
      rows += image.bytes[3 * (static_cast<std::size_t>(y) * width + x)] == 240 ? '#' : '.';
    }
    rows += '\n';
  }
  return rows;
}

TEST(Caption, IsWrittenInTheMiddleBelow) {
  EXPECT_EQ(lit("1=n", 20),
            "...#................\n"
            "..##................\n"
            "...#...#####.####...\n"
            "...#.........#...#..\n"
            "...#...#####.#...#..\n"
            "...#.........#...#..\n"
            "..###........#...#..\n");
}

TEST(Caption, ShowsTheEndOfALineThatIsTooLong) {
  EXPECT_EQ(lit("a long name of a number 0.5", 20), lit("0.5", 20));
}

TEST(Caption, PutsTheLastOfSeveralLinesLowest) {
  EXPECT_EQ(lit("1=0\n2=n", 20), lit("2=n", 20));
  Image two = grey(20, 200);
  write_caption(two, "1=0\n2=n");
  Image one = grey(20, 200);
  write_caption(one, "1=0");
  // Ten rows above; the tenth has the rim of the line below.
  const auto row = [](const Image& image, std::size_t y) { return image.bytes.begin() + 3 * 20 * y; };
  EXPECT_TRUE(std::equal(row(one, 190), row(one, 199), row(two, 180)));
}

TEST(Caption, HasAFormForEveryLetterAndDigit) {
  std::string seen;
  for (char c = 'A'; c <= 'z'; ++c) {
    if (c <= 'Z' || c >= 'a') {
      const std::string form = lit(std::string(1, c), 8);
      EXPECT_NE(form, lit("?", 8)) << c;
      EXPECT_EQ(seen.find(form), std::string::npos) << c << " looks like another";
      seen += form;
    }
  }
  for (const char c : std::string("0123456789_=-+.,:[]()/")) {
    EXPECT_NE(lit(std::string(1, c), 8), lit("?", 8)) << c;
  }
  EXPECT_EQ(lit("#", 8), lit("?", 8));
}

TEST(Caption, StaysWithinTheImage) {
  for (const int channels : {3, 4}) {
    Image image = grey(16, 12, channels);
    write_caption(image, std::string(300, 'm'));
    EXPECT_EQ(image.bytes.size(), static_cast<std::size_t>(16 * 12 * channels));
  }
  Image empty = grey(16, 12);
  write_caption(empty, "");
  EXPECT_EQ(empty.bytes, grey(16, 12).bytes);
}

}  // namespace
}  // namespace anthesis
