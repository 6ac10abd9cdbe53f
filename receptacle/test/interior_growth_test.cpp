#include "anthesis/receptacle/interior_growth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/sha256.h"
#include "anthesis/geometry/predicates.h"

namespace anthesis {
namespace {

/// A head that grows from a flat dome through a cone to a cushion that hangs over its base.
SectionSequence dome_to_cushion(std::size_t frames) {
  constexpr std::size_t kContour = 40;
  constexpr std::size_t kBase = 12;
  SectionSequence sections;
  sections.points_per_frame = kContour + 1 + kBase;
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = static_cast<double>(f) / static_cast<double>(frames - 1);
    const double width = 0.05 + 0.95 * t * t;
    const double height = 0.02 + 0.9 * t;
    const double base = width * (1.0 - 0.6 * t * t);
    for (std::size_t k = 0; k <= kContour; ++k) {
      // Material points drift towards the rim as new tissue is made at the apex.
      const double u = static_cast<double>(k) / kContour;
      const double s = math::pow(u, 1.0 - 0.3 * t);
      const double angle = 0.5 * math::kPi * s;
      const double bulge = base + (width - base) * math::sin(math::kPi * std::min(1.4 * s, 1.0)) * 1.3;
      sections.points.push_back({k == 0 ? 0.0 : math::sin(angle) * std::max(bulge, base), height * math::cos(angle)});
      if (k == kContour) {
        sections.points.back() = {base, 0.0};
      }
    }
    for (std::size_t i = 1; i <= kBase; ++i) {
      sections.points.push_back({base * static_cast<double>(kBase - i) / kBase, 0.0});
    }
  }
  return sections;
}

InteriorGrowth grow(SectionSequence sections, const InteriorGrowthParams& params = {}) {
  Expected<InteriorGrowth> made = InteriorGrowth::make(std::move(sections), params);
  EXPECT_TRUE(made.has_value()) << (made ? "" : to_string(made.error()));
  return std::move(made.value());
}

/// A net laid into the first section, its meshes about as large as a vein's step, and turned to fit: quads of the grid
/// cut in two, corners inside by a margin or on the axis.
struct Net {
  std::vector<Vec2> points;
  std::vector<Triangle> triangles;
};

Net net_in(std::span<const Vec2> controls, std::size_t across) {
  double width = 0.0;
  for (const Vec2 p : controls) {
    width = std::max(width, p.x);
  }
  const auto inside = [&](Vec2 p) {
    bool odd = false;
    double clear = 1e9;
    for (std::size_t i = 0; i + 1 < controls.size(); ++i) {
      const Vec2 a = controls[i];
      const Vec2 b = controls[i + 1];
      if ((a.y > p.y) != (b.y > p.y) && (orient2d(a, b, p) > 0) == (b.y > a.y)) {
        odd = !odd;
      }
      const double t = std::clamp(dot(p - a, b - a) / std::max(dot(b - a, b - a), 1e-300), 0.0, 1.0);
      clear = std::min(clear, length(lerp(a, b, t) - p));
    }
    return odd && clear > 0.2 * width / static_cast<double>(across);
  };
  const double step = width / static_cast<double>(across);
  std::vector<std::vector<std::uint32_t>> at(across + 1, std::vector<std::uint32_t>(4 * across + 1, 0xffffffffU));
  Net net;
  for (std::size_t i = 0; i <= across; ++i) {
    for (std::size_t j = 0; j <= 4 * across; ++j) {
      const Vec2 p{step * static_cast<double>(i), step * static_cast<double>(j)};
      if (inside(p)) {
        at[i][j] = static_cast<std::uint32_t>(net.points.size());
        net.points.push_back(p);
      }
    }
  }
  for (std::size_t i = 0; i < across; ++i) {
    for (std::size_t j = 0; j < 4 * across; ++j) {
      const std::uint32_t corners[4] = {at[i][j], at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]};
      if (std::find(corners, corners + 4, 0xffffffffU) == corners + 4) {
        net.triangles.push_back({corners[0], corners[1], corners[2]});
        net.triangles.push_back({corners[0], corners[2], corners[3]});
      }
    }
  }
  return net;
}

std::size_t turned_over(const Net& net) {
  return static_cast<std::size_t>(std::count_if(net.triangles.begin(), net.triangles.end(), [&](const Triangle& t) {
    return orient2d(net.points[t[0]], net.points[t[1]], net.points[t[2]]) <= 0;
  }));
}

/// Carries a net through the whole development.
void expect_never_turned_over(InteriorGrowth& growth, Net net) {
  ASSERT_GT(net.triangles.size(), 100U);
  ASSERT_EQ(turned_over(net), 0U);
  std::size_t back = 0;
  for (std::size_t f = 0; f + 1 < growth.frames(); ++f) {
    ASSERT_FALSE(growth.advance(f).has_value());
    back += growth.carry(net.points);
    ASSERT_EQ(turned_over(net), 0U) << "at frame " << f + 1;
  }
  EXPECT_EQ(back, 0U);
}

std::filesystem::path reference() {
  const char* given = std::getenv("ANTHESIS_REFERENCE");
  return given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT;
}

/// A published `.cntrs` file; no frames if it is not there.
ContourSequence published_contours(const std::filesystem::path& path) {
  ContourSequence contours;
  std::ifstream file(path);
  std::size_t frames = 0;
  std::size_t points = 0;
  if (!(file >> frames >> points)) {
    return contours;
  }
  for (std::size_t i = 0; i < points; ++i) {
    int flag = 0;
    file >> flag;
    contours.landmarks.push_back(flag == 1);
  }
  contours.points.resize(frames * points);
  for (ContourPoint& point : contours.points) {
    file >> point.position.x >> point.position.y >> point.s;
  }
  contours.times.resize(frames);
  return contours;
}

TEST(InteriorGrowth, MovesNothingWhereTheContourStands) {
  SectionSequence sections = dome_to_cushion(5);
  const std::vector<Vec2> last(sections.points.end() - static_cast<std::ptrdiff_t>(sections.points_per_frame),
                               sections.points.end());
  sections.points = last;
  sections.points.insert(sections.points.end(), last.begin(), last.end());
  const InteriorGrowth growth = grow(sections);
  Net net = net_in(last, 20);
  net.points.insert(net.points.end(), last.begin(), last.end());
  const std::vector<Vec2> before = net.points;
  EXPECT_EQ(growth.carry(net.points), 0U);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT(length(net.points[i] - before[i]), 1e-12);
  }
}

TEST(InteriorGrowth, FollowsARiseOfTheWholeHead) {
  SectionSequence sections = dome_to_cushion(3);
  sections.points.resize(sections.points_per_frame);
  std::vector<Vec2> risen = sections.points;
  for (Vec2& p : risen) {
    p.y += 0.25;
  }
  sections.points.insert(sections.points.end(), risen.begin(), risen.end());
  const InteriorGrowth growth = grow(sections);
  Net net = net_in(sections.frame(0), 12);
  const std::vector<Vec2> before = net.points;
  EXPECT_EQ(growth.carry(net.points), 0U);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(net.points[i].x, before[i].x, 1e-12);
    EXPECT_NEAR(net.points[i].y, before[i].y + 0.25, 1e-12);
  }
}

TEST(InteriorGrowth, StretchesLikeTheBoundaryWhereRadiiVanishOnTheAxis) {
  SectionSequence sections = dome_to_cushion(3);
  sections.points.resize(sections.points_per_frame);
  std::vector<Vec2> stretched = sections.points;
  for (Vec2& p : stretched) {
    p = {1.5 * p.x, 0.9 * p.y};
  }
  sections.points.insert(sections.points.end(), stretched.begin(), stretched.end());
  const InteriorGrowth growth = grow(sections, {.mesh = {}, .axis = AxisCondition::kZero});
  Net net = net_in(sections.frame(0), 12);
  const std::vector<Vec2> before = net.points;
  EXPECT_EQ(growth.carry(net.points), 0U);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(net.points[i].x, 1.5 * before[i].x, 1e-12);
    EXPECT_NEAR(net.points[i].y, 0.9 * before[i].y, 1e-12);
  }
}

TEST(InteriorGrowth, TurnsNoTissueInsideOut) {
  for (const AxisCondition axis : {AxisCondition::kNatural, AxisCondition::kZero}) {
    InteriorGrowth growth = grow(dome_to_cushion(200), {.mesh = {}, .axis = axis});
    expect_never_turned_over(growth, net_in(growth.section(0), 24));
    EXPECT_LT(growth.triangulations(), 60U);
  }
}

class PublishedHead : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    contours_ = published_contours(reference() / GetParam());
    if (contours_.frames() == 0) {
      GTEST_SKIP() << "no reference data";
    }
  }
  bool is_sunflower() const { return std::string(GetParam()).find("sunflower") != std::string::npos; }
  ContourSequence contours_;
};
INSTANTIATE_TEST_SUITE_P(InteriorGrowth, PublishedHead,
                         testing::Values("heads/bellis/bellis.cntrs", "heads/sunflower/sunflower-regenerated.cntrs"),
                         [](const auto& one) {
                           return std::string(one.param).find("bellis") != std::string::npos ? "Bellis" : "Sunflower";
                         });

TEST_P(PublishedHead, HasTheFramesAndPointsOfTheModel) {
  EXPECT_EQ(contours_.frames(), 2214U);
  EXPECT_EQ(contours_.points_per_frame(), is_sunflower() ? 79U : 51U);
  EXPECT_EQ(with_base(contours_).points_per_frame, is_sunflower() ? 99U : 71U);
}

TEST_P(PublishedHead, TurnsNoTissueInsideOut) {
  InteriorGrowth growth = grow(with_base(contours_));
  expect_never_turned_over(growth, net_in(growth.section(0), is_sunflower() ? 48 : 16));
}

TEST(InteriorGrowth, KeepsTheAxisAndTheBoundaryWhereTheyAre) {
  InteriorGrowth growth = grow(dome_to_cushion(100));
  const std::size_t points = growth.section(0).size();
  std::vector<Vec2> axis{{0.0, 0.004}, {0.0, 0.01}, {0.0, 0.019}};
  std::vector<Vec2> boundary;
  for (std::size_t i = 0; i + 1 < points; ++i) {
    boundary.push_back(lerp(growth.section(0)[i], growth.section(0)[i + 1], 0.3));
  }
  for (std::size_t f = 0; f + 1 < growth.frames(); ++f) {
    ASSERT_FALSE(growth.advance(f).has_value());
    EXPECT_EQ(growth.carry(axis), 0U);
    EXPECT_EQ(growth.carry(boundary), 0U);
  }
  const std::span<const Vec2> last = growth.section(growth.frames() - 1);
  for (const Vec2 p : axis) {
    EXPECT_EQ(p.x, 0.0);
    EXPECT_GT(p.y, 0.0);
    EXPECT_LT(p.y, last[0].y);
  }
  EXPECT_LT(axis[0].y, axis[1].y);
  EXPECT_LT(axis[1].y, axis[2].y);
  for (std::size_t i = 0; i + 1 < points; ++i) {
    EXPECT_LT(length(boundary[i] - lerp(last[i], last[i + 1], 0.3)), 1e-9);
  }
}

TEST(InteriorGrowth, BringsBackWhatWouldLeaveAndCountsIt) {
  // The rim falls in over one frame: what stood in it is left outside.
  SectionSequence sections;
  sections.points_per_frame = 6;
  sections.points = {{0, 1}, {1, 1},     {1, 0}, {0.6, 0}, {0.3, 0}, {0, 0},  //
                     {0, 1}, {0.2, 0.3}, {1, 0}, {0.6, 0}, {0.3, 0}, {0, 0}};
  const InteriorGrowth growth = grow(sections);
  std::vector<Vec2> points{{0.05, 0.5}, {0.1, 0.97}, {1.5, 0.5}, {0.0, 1.2}};
  const Net net = net_in(sections.frame(0), 40);
  points.insert(points.end(), net.points.begin(), net.points.end());
  EXPECT_GE(growth.carry(points), 2U);
  for (const Vec2 p : points) {
    double nearest = 1.0;
    bool odd = false;
    for (std::size_t i = 6; i + 1 < 12; ++i) {
      const Vec2 a = sections.points[i];
      const Vec2 b = sections.points[i + 1];
      odd = odd != ((a.y > p.y) != (b.y > p.y) && (orient2d(a, b, p) > 0) == (b.y > a.y));
      const double t = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
      nearest = std::min(nearest, length(lerp(a, b, t) - p));
    }
    EXPECT_TRUE(odd || nearest < 1e-12) << p.x << " " << p.y;
  }
  EXPECT_EQ(points[3], (Vec2{0.0, 1.0}));
}

TEST(InteriorGrowth, CarriesPointsInSpaceWithinTheirHalfPlane) {
  InteriorGrowth growth = grow(dome_to_cushion(50));
  std::vector<Vec2> flat;
  std::vector<Vec3> space;
  for (int i = 0; i < 9; ++i) {
    const double azimuth = 0.7 * i;
    flat.push_back({0.004 * i, 0.01});
    space.push_back({0.004 * i * math::cos(azimuth), 0.004 * i * math::sin(azimuth), 0.01});
  }
  for (std::size_t f = 0; f + 1 < growth.frames(); ++f) {
    ASSERT_FALSE(growth.advance(f).has_value());
    growth.carry(flat);
    growth.carry(space);
  }
  for (int i = 0; i < 9; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    EXPECT_NEAR(space[k].x, flat[k].x * math::cos(0.7 * i), 1e-12);
    EXPECT_NEAR(space[k].y, flat[k].x * math::sin(0.7 * i), 1e-12);
    EXPECT_NEAR(space[k].z, flat[k].y, 1e-12);
  }
}

TEST(InteriorGrowth, MovesAPointTheSameWhoeverGoesWithItAndOnAnyNumberOfThreads) {
  const auto carried = [](int threads, std::size_t copies, std::size_t detour) {
    const ThreadLimit limit(threads);
    InteriorGrowth growth = grow(dome_to_cushion(60));
    EXPECT_FALSE(growth.advance(detour).has_value());
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < 100 * copies; ++i) {
      const double k = static_cast<double>(i % 100);
      points.push_back({0.0003 * k, 0.0002 * (100.0 - k) * 0.6});
    }
    for (std::size_t f = 0; f + 1 < growth.frames(); ++f) {
      EXPECT_FALSE(growth.advance(f).has_value());
      growth.carry(points);
    }
    points.resize(100);
    return points;
  };
  const std::vector<Vec2> alone = carried(1, 1, 0);
  EXPECT_EQ(carried(4, 60, 0), alone);
  EXPECT_EQ(carried(1, 1, 59), alone);
}

TEST(InteriorGrowth, CarriesForManyAtOnce) {
  const InteriorGrowth growth = grow(dome_to_cushion(60));
  std::vector<std::vector<Vec2>> points(64, {{0.01, 0.008}, {0.03, 0.004}});
  parallel_for(points.size(), [&](std::size_t i) { growth.carry(points[i]); });
  for (const std::vector<Vec2>& one : points) {
    EXPECT_EQ(one, points[0]);
    EXPECT_NE(one[0], (Vec2{0.01, 0.008}));
  }
}

TEST(InteriorGrowth, GivesTheSameWeightsForAnyNumberOfThreads) {
  const InteriorGrowth growth = grow(dome_to_cushion(70));
  const auto all = [&](int threads) {
    const ThreadLimit limit(threads);
    std::vector<double> weights;
    EXPECT_FALSE(growth.weights([&](const HarmonicFrame& frame) {
      weights.insert(weights.end(), frame.weights.begin(), frame.weights.end());
      return true;
    }));
    return weights;
  };
  EXPECT_EQ(all(1), all(4));
}

TEST(InteriorGrowth, HasTheSameBitsEverywhere) {
  InteriorGrowth growth = grow(dome_to_cushion(60));
  Net net = net_in(growth.section(0), 24);
  for (std::size_t f = 0; f + 1 < growth.frames(); ++f) {
    ASSERT_FALSE(growth.advance(f).has_value());
    growth.carry(net.points);
  }
  const auto* bytes = reinterpret_cast<const char*>(net.points.data());
  EXPECT_EQ(sha256({bytes, net.points.size() * sizeof(Vec2)}).substr(0, 16), "db8f6d0bd49faba3");
}

TEST(InteriorGrowth, ComesNearerToOnePlaceWithAFinerMesh) {
  const auto place = [](double max_edge) {
    InteriorGrowth growth = grow(dome_to_cushion(40), {.mesh = {.max_edge = max_edge}});
    std::vector<Vec2> points{{0.02, 0.008}, {0.01, 0.012}, {0.035, 0.004}};
    for (std::size_t f = 0; f + 1 < growth.frames(); ++f) {
      EXPECT_FALSE(growth.advance(f).has_value());
      growth.carry(points);
    }
    return points;
  };
  const auto distance = [](const std::vector<Vec2>& p, const std::vector<Vec2>& q) {
    double most = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      most = std::max(most, length(p[i] - q[i]));
    }
    return most;
  };
  const std::vector<Vec2> fine = place(0.02);
  const double coarse = distance(place(0.16), fine);
  EXPECT_LT(coarse, 0.02);
  EXPECT_LT(distance(place(0.04), fine), coarse);
}

TEST(InteriorGrowth, GivesTheWeightsOfEveryFrame) {
  const SectionSequence sections = dome_to_cushion(30);
  InteriorGrowth growth = grow(sections);
  std::size_t frames = 0;
  const std::optional<Error> error = growth.weights([&](const HarmonicFrame& frame) {
    EXPECT_EQ(frame.frame, frames++);
    EXPECT_FALSE(growth.advance(frame.frame).has_value());
    EXPECT_EQ(growth.mesh().points, frame.mesh.points);
    const std::size_t points = frame.mesh.points.size();
    EXPECT_EQ(frame.weights.size(), points * frame.controls.size());
    for (std::size_t v = 0; v < points; ++v) {
      double sum = 0.0;
      double height = 0.0;
      for (std::size_t c = 0; c < frame.controls.size(); ++c) {
        const double weight = frame.weights[c * points + v];
        EXPECT_GE(weight, 0.0);
        EXPECT_LE(weight, 1.0);
        sum += weight;
        height += weight * frame.controls[c].y;
      }
      EXPECT_NEAR(sum, 1.0, 1e-12);
      EXPECT_NEAR(height, frame.mesh.points[v].y, 1e-12);
    }
    return frames < 20;
  });
  EXPECT_FALSE(error.has_value());
  EXPECT_EQ(frames, 20U);
}

TEST_P(PublishedHead, HasWeightsThatAreSharesAndSumToOneInAllFrames) {
  std::size_t fields = 0;
  double worst = 0.0;
  const std::optional<Error> error = grow(with_base(contours_)).weights([&](const HarmonicFrame& frame) {
    fields += frame.controls.size();
    const std::size_t points = frame.mesh.points.size();
    for (std::size_t v = 0; v < points; v += 7) {
      double sum = 0.0;
      for (std::size_t c = 0; c < frame.controls.size(); ++c) {
        sum += frame.weights[c * points + v];
      }
      worst = std::max(worst, std::fabs(sum - 1.0));
    }
    const auto [least, most] = std::minmax_element(frame.weights.begin(), frame.weights.end());
    worst = std::max({worst, -*least, *most - 1.0});
    return true;
  });
  EXPECT_FALSE(error.has_value());
  EXPECT_EQ(fields, is_sunflower() ? 219186U : 157194U);  // as O24 counts them
  EXPECT_LT(worst, 1e-12);
}

TEST(InteriorGrowth, NamesTheFrameThatCannotBe) {
  SectionSequence sections = dome_to_cushion(4);
  std::swap(sections.points[2 * sections.points_per_frame + 3], sections.points[2 * sections.points_per_frame + 20]);
  InteriorGrowth growth = grow(sections);
  const std::optional<Error> error = growth.advance(3);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->where, "frame 2: section");
  EXPECT_EQ(growth.frame(), 0U);
  std::size_t written = 0;
  const std::optional<Error> again = growth.weights([&](const HarmonicFrame&) { return ++written < 100; });
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->where, "frame 2: section");
  EXPECT_EQ(written, 2U);  // those before it
  sections.points.pop_back();
  EXPECT_FALSE(InteriorGrowth::make(sections).has_value());
}

TEST(WithBase, ClosesTheContourByALevelBase) {
  ContourSequence contours;
  contours.times = {0.0, 1.0};
  contours.landmarks = {true, true};
  contours.points = {{{0, 1}, 0}, {{2, 0.5}, 1}, {{1e-13, 2}, 0}, {{4, 0.25}, 1}};
  const SectionSequence sections = with_base(contours, 2);
  ASSERT_EQ(sections.points_per_frame, 4U);
  EXPECT_EQ(sections.points, (std::vector<Vec2>{{0, 1},
                                                {2, 0.5},
                                                {1, 0.5},
                                                {0, 0.5},  //
                                                {0, 2},
                                                {4, 0.25},
                                                {2, 0.25},
                                                {0, 0.25}}));
}

}  // namespace
}  // namespace anthesis
