#include "anthesis/corolla/pigment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace anthesis {
namespace {

Pigment plain(Colour colour) {
  Pigment pigment;
  pigment.colour = {{0.0, colour}};
  pigment.mottle = 0.0;
  return pigment;
}

TEST(ParseColour, ReadsWhatToHexWrites) {
  for (const char* text : {"#000000", "#ffffff", "#f7b500", "#0a0b0c", "#804020"}) {
    const Expected<Colour> colour = parse_colour(text);
    ASSERT_TRUE(colour.has_value()) << text;
    EXPECT_EQ(to_hex(*colour), text);
  }
  EXPECT_EQ(to_hex(*parse_colour("#AbCdEf")), "#abcdef");
}

TEST(ParseColour, IsLinearLight) {
  const Colour grey = *parse_colour("#bcbcbc");  // 188 of 255 in sRGB is half of the light
  EXPECT_NEAR(grey.r, 0.5, 0.005);
  EXPECT_NEAR(linear_from_srgb(srgb_from_linear(0.2)), 0.2, 1e-12);
}

TEST(ParseColour, RefusesAnythingElseAndShowsIt) {
  for (const char* text : {"", "#fff", "ffffff", "#ggffff", "#ffffff ", "red", "#-1ffff"}) {
    const Expected<Colour> colour = parse_colour(text);
    ASSERT_FALSE(colour.has_value()) << text;
    EXPECT_EQ(colour.error().code, ErrorCode::kParse);
    EXPECT_NE(colour.error().message.find(text), std::string::npos);
  }
}

TEST(ColourAt, StopsAreMetExactlyAndColoursBetweenLieBetween) {
  Pigment pigment = plain({});
  pigment.colour = {{0.2, {0.8, 0.1, 0.0}}, {0.6, {0.9, 0.6, 0.1}}, {0.9, {1.0, 0.9, 0.2}}};
  const auto at = [&](double v) { return colour_at(pigment, {}, {0.5, v}, true); };
  EXPECT_NEAR(at(0.0).g, 0.1, 1e-12);
  EXPECT_NEAR(at(0.2).g, 0.1, 1e-12);
  EXPECT_NEAR(at(0.6).g, 0.6, 1e-12);
  EXPECT_NEAR(at(1.0).g, 0.9, 1e-12);
  double before = at(0.2).g;
  for (double v = 0.21; v < 0.9; v += 0.01) {
    EXPECT_GE(at(v).g, before - 1e-12);
    before = at(v).g;
  }
}

TEST(ColourAt, UndersideIsMixedHalfAndHalfIntoTheLowerSideOnly) {
  Pigment pigment = plain({0.64, 0.36, 0.0});
  pigment.underside = Colour{0.0, 0.36, 0.16};
  EXPECT_EQ(colour_at(pigment, {}, {0.3, 0.3}, true).b, 0.0);
  const Colour below = colour_at(pigment, {}, {0.3, 0.3}, false);
  EXPECT_NEAR(std::sqrt(below.r), 0.4, 1e-12);
  EXPECT_NEAR(std::sqrt(below.b), 0.2, 1e-12);
  EXPECT_NEAR(below.g, 0.36, 1e-12);
}

TEST(ColourAt, MarginColoursTheEdgesAndLeavesTheMiddle) {
  Pigment pigment = plain({0.5, 0.5, 0.5});
  pigment.margin = Colour{0.9, 0.1, 0.1};
  pigment.margin_width = 0.2;
  for (const double u : {0.0, 1.0}) {
    EXPECT_NEAR(colour_at(pigment, {}, {u, 0.5}, true).r, 0.9, 1e-12);
  }
  EXPECT_NEAR(colour_at(pigment, {}, {0.11, 0.5}, true).r, 0.5, 1e-12);  // 0.2 of the half width is u = 0.1
  EXPECT_NE(colour_at(pigment, {}, {0.09, 0.5}, true).r, 0.5);
}

TEST(ColourAt, ShowsAsManyVeinsAsAskedAndNoneAtTheTip) {
  Pigment pigment = plain({0.9, 0.6, 0.1});
  pigment.veins = 9;
  pigment.vein_depth = 0.5;
  int veins = 0;
  bool inside = false;
  for (int i = 0; i <= 4000; ++i) {
    const bool dark = colour_at(pigment, {}, {i / 4000.0, 0.2}, true).g < 0.6 * 0.95;
    veins += dark && !inside;
    inside = dark;
  }
  EXPECT_EQ(veins, 9);
  double tip = 0.0;
  for (int i = 0; i <= 4000; ++i) {
    tip = std::max(tip, 0.6 - colour_at(pigment, {}, {i / 4000.0, 1.0}, true).g);
  }
  EXPECT_LT(tip, 0.03);
}

TEST(ColourAt, MottleKeepsTheMeanAndDiffersBetweenOrgans) {
  Pigment pigment = plain({0.4, 0.4, 0.4});
  pigment.mottle = 0.2;
  double sum = 0.0;
  double low = 1.0;
  double high = 0.0;
  int differing = 0;
  for (int organ = 0; organ < 20; ++organ) {
    for (int i = 0; i < 400; ++i) {
      const Vec2 uv = {(i % 20 + 0.3) / 20.0, (i / 20 + 0.3) / 20.0};
      const double here = colour_at(pigment, {0.0, 1.0, static_cast<std::uint32_t>(organ)}, uv, true).r;
      const double there = colour_at(pigment, {0.0, 1.0, static_cast<std::uint32_t>(organ + 100)}, uv, true).r;
      sum += here;
      low = std::min(low, here);
      high = std::max(high, here);
      differing += here != there;
    }
  }
  EXPECT_NEAR(sum / 8000.0, 0.4, 0.01);
  EXPECT_GE(low, 0.4 * 0.8);
  EXPECT_LE(high, 0.4 * 1.2);
  EXPECT_GT(high - low, 0.08);
  EXPECT_GT(differing, 7000);
}

TEST(Vary, StaysInTheRangesAndIsAFunctionOfSeedAndOrgan) {
  Pigment pigment = plain({0.5, 0.4, 0.3});
  pigment.hue_deg = {-6.0, 10.0};
  pigment.value = {0.8, 1.1};
  double lowest = 10.0;
  double highest = -10.0;
  for (std::uint64_t organ = 1; organ <= 500; ++organ) {
    const PigmentVariation variation = vary(pigment, 7, organ);
    const double hue_deg = variation.hue_rad * 180.0 / 3.14159265358979;
    EXPECT_GE(hue_deg, -6.0);
    EXPECT_LE(hue_deg, 10.0);
    EXPECT_GE(variation.value, 0.8);
    EXPECT_LE(variation.value, 1.1);
    lowest = std::min(lowest, hue_deg);
    highest = std::max(highest, hue_deg);
    EXPECT_EQ(variation.value, vary(pigment, 7, organ).value);
  }
  EXPECT_LT(lowest, -5.0);
  EXPECT_GT(highest, 9.0);
  EXPECT_NE(vary(pigment, 7, 1).value, vary(pigment, 8, 1).value);
}

TEST(ColourAt, HueTurnsRedTowardsYellowAndKeepsGrey) {
  const double tenth_turn = 0.2;
  const Colour red = colour_at(plain({0.8, 0.1, 0.1}), {tenth_turn, 1.0, 0}, {0.5, 0.5}, true);
  EXPECT_GT(red.g, 0.1);
  EXPECT_GT(red.g, red.b);
  const Colour grey = colour_at(plain({0.5, 0.5, 0.5}), {tenth_turn, 1.0, 0}, {0.5, 0.5}, true);
  EXPECT_NEAR(grey.r, 0.5, 1e-12);
  EXPECT_NEAR(grey.b, 0.5, 1e-12);
}

TEST(ColourAt, IsAlwaysALegalColour) {
  Pigment pigment = plain({0.95, 0.9, 0.01});
  pigment.mottle = 1.0;
  pigment.veins = 64;
  pigment.vein_depth = 1.0;
  pigment.margin = Colour{1.0, 1.0, 1.0};
  for (int i = 0; i < 2000; ++i) {
    const PigmentVariation variation = {(i % 7 - 3) * 0.5, 0.2 + 0.01 * (i % 200), static_cast<std::uint32_t>(i)};
    const Colour c = colour_at(pigment, variation, {-0.1 + 0.0006 * i, 1.1 - 0.0006 * i}, i % 2 == 0);
    for (const double channel : {c.r, c.g, c.b}) {
      ASSERT_GE(channel, 0.0);
      ASSERT_LE(channel, 1.0);
    }
  }
}

}  // namespace
}  // namespace anthesis
