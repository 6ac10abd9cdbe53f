#include "anthesis/contact/crossings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "anthesis/base/parallel.h"

namespace anthesis {
namespace {

using Corners = std::array<Vec3, 3>;
using Pair = std::array<std::uint32_t, 2>;

/// Triangles that share nothing but the places of their corners.
struct Soup {
  std::vector<Vec3> positions_mm;
  std::vector<Triangle> triangles;

  explicit Soup(const std::vector<Corners>& list) {
    for (const Corners& corners : list) {
      const auto first = static_cast<std::uint32_t>(positions_mm.size());
      triangles.push_back({first, first + 1, first + 2});
      positions_mm.insert(positions_mm.end(), corners.begin(), corners.end());
    }
  }
};

CrossingReport crossings_of(const std::vector<Corners>& list, std::size_t max_listed = 1000) {
  const Soup soup(list);
  return find_crossings(soup.positions_mm, soup.triangles, max_listed).value();
}

std::vector<Pair> pairs_of(const CrossingReport& report) {
  std::vector<Pair> pairs;
  for (const Crossing& crossing : report.crossings) {
    pairs.push_back({crossing.first, crossing.second});
  }
  return pairs;
}

/// Whether two triangles cross, in whatever order their corners and they themselves are given.
bool cross_in_any_order(Corners one, Corners other) {
  const std::uint64_t expected = crossings_of({one, other}).count;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      EXPECT_EQ(crossings_of({one, other}).count, expected);
      EXPECT_EQ(crossings_of({other, one}).count, expected);
      std::rotate(other.begin(), other.begin() + 1, other.end());
      if (j == 2) {
        std::swap(other[0], other[1]);
      }
    }
    std::rotate(one.begin(), one.begin() + 1, one.end());
    if (i == 2) {
      std::swap(one[0], one[1]);
    }
  }
  return expected != 0;
}

double ulp_above(double value) {
  return std::nextafter(value, 1e300);
}

constexpr Corners kFloor = {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};

TEST(FindCrossings, FindsATriangleThatPiercesAnotherAndSaysWhere) {
  const CrossingReport report = crossings_of({kFloor, {Vec3{1, 1, -1}, Vec3{1, 1, 1}, Vec3{9, 9, 1}}});
  ASSERT_EQ(report.count, 1u);
  EXPECT_EQ(pairs_of(report), (std::vector<Pair>{{0, 1}}));
  const Vec3 place = report.crossings[0].place_mm;
  EXPECT_NEAR(place.z, 0.0, 1e-12);
  EXPECT_NEAR(place.x, place.y, 1e-12);
  EXPECT_GE(place.x, 1.0 - 1e-12);
  EXPECT_LE(place.x, 2.0 + 1e-12);
  EXPECT_EQ(report.degenerate, 0u);
}

TEST(FindCrossings, TakesTouchingForCrossingToTheLastBit) {
  // A corner on the face, an edge across an edge, a corner on an edge, corner on corner's far side.
  const auto tip_at = [](Vec3 tip) { return Corners{tip, tip + Vec3{1, 0, 3}, tip + Vec3{0, 1, 3}}; };
  EXPECT_TRUE(cross_in_any_order(kFloor, tip_at({1, 1, 0})));
  EXPECT_TRUE(cross_in_any_order(kFloor, tip_at({2, 2, 0})));
  EXPECT_TRUE(cross_in_any_order(kFloor, {Vec3{2, -1, 0}, Vec3{2, 1, 0}, Vec3{2, 0, 5}}));
  EXPECT_TRUE(cross_in_any_order(kFloor, {Vec3{2, 0, -1}, Vec3{2, 0, 1}, Vec3{2, -5, 0}}));
  const double hair = std::numeric_limits<double>::denorm_min();
  EXPECT_FALSE(cross_in_any_order(kFloor, tip_at({1, 1, hair})));
  EXPECT_TRUE(cross_in_any_order(kFloor, tip_at({1, 1, -hair})));
  EXPECT_FALSE(cross_in_any_order(kFloor, tip_at({2, ulp_above(2.0), 0})));
  EXPECT_FALSE(cross_in_any_order(kFloor, {Vec3{2, -hair, -1}, Vec3{2, -hair, 1}, Vec3{2, -5, 0}}));
}

TEST(FindCrossings, LeavesLayersAloneThatAreOneUnitInTheLastPlaceApart) {
  Corners above = kFloor;
  for (Vec3& corner : above) {
    corner.z = std::numeric_limits<double>::denorm_min();
  }
  EXPECT_FALSE(cross_in_any_order(kFloor, above));
  above[0].z = 0.0;  // now the first corners are one vertex, and all else is apart
  EXPECT_FALSE(cross_in_any_order(kFloor, above));
}

TEST(FindCrossings, SeesOverlapInACommonPlane) {
  EXPECT_TRUE(cross_in_any_order(kFloor, {Vec3{1, 1, 0}, Vec3{5, 5, 0}, Vec3{1, 5, 0}}));       // partly
  EXPECT_TRUE(cross_in_any_order(kFloor, {Vec3{1, 1, 0}, Vec3{1.5, 1, 0}, Vec3{1, 1.5, 0}}));   // within
  EXPECT_TRUE(cross_in_any_order(kFloor, {Vec3{2, -1, 0}, Vec3{3, -1, 0}, Vec3{2, 9, 0}}));     // no corner within
  EXPECT_TRUE(cross_in_any_order(kFloor, {Vec3{1, 0, 0}, Vec3{3, 0, 0}, Vec3{2, -1, 0}}));      // along an edge
  EXPECT_FALSE(cross_in_any_order(kFloor, {Vec3{3, 3, 0}, Vec3{5, 3, 0}, Vec3{3, 5, 0}}));      // beside
  EXPECT_FALSE(cross_in_any_order(kFloor, {Vec3{5, -1, 0}, Vec3{-1, 5.5, 0}, Vec3{9, 9, 0}}));  // boxes overlap
}

TEST(FindCrossings, KnowsNeighboursInAFanFromThoseThatCross) {
  const Vec3 v{0, 0, 0};
  const Corners leaf = {v, Vec3{2, 0, 0}, Vec3{2, 2, 0}};
  EXPECT_FALSE(cross_in_any_order(leaf, {v, Vec3{-1, 1, 0}, Vec3{-2, -1, 0}}));   // flat, apart
  EXPECT_FALSE(cross_in_any_order(leaf, {v, Vec3{1, 1, 5}, Vec3{-2, -1, 3}}));    // above
  EXPECT_FALSE(cross_in_any_order(leaf, {v, Vec3{-1, 0, -1}, Vec3{-1, 0, 1}}));   // behind, through the plane
  EXPECT_TRUE(cross_in_any_order(leaf, {v, Vec3{1, 0.5, 1}, Vec3{1, 0.5, -1}}));  // through
  EXPECT_TRUE(cross_in_any_order(leaf, {v, Vec3{9, 4, 1}, Vec3{9, 4, -1}}));      // leaves through the far edge
  EXPECT_TRUE(cross_in_any_order(leaf, {v, Vec3{1, 0.5, 0}, Vec3{1, 0, 5}}));     // a corner on the face
  EXPECT_TRUE(cross_in_any_order(leaf, {v, Vec3{1, 0, 0}, Vec3{0, 0, 5}}));       // along a part of an edge
  EXPECT_TRUE(cross_in_any_order(leaf, {v, Vec3{3, 0, 0}, Vec3{3, -1, 0}}));      // the same, flat
  EXPECT_TRUE(cross_in_any_order(leaf, {v, Vec3{2, 1, 0}, Vec3{1, 2, 0}}));       // flat, overlapping
}

TEST(FindCrossings, TakesAnEdgeFoldedFlatForACrossingAndAnySharperFoldForNone) {
  const Corners left = {Vec3{0, 0, 0}, Vec3{0, 2, 0}, Vec3{-1, 1, 0}};
  EXPECT_FALSE(cross_in_any_order(left, {Vec3{0, 0, 0}, Vec3{0, 2, 0}, Vec3{1, 1, 0}}));
  EXPECT_TRUE(cross_in_any_order(left, {Vec3{0, 0, 0}, Vec3{0, 2, 0}, Vec3{-3, 1, 0}}));
  EXPECT_FALSE(cross_in_any_order(left, {Vec3{0, 0, 0}, Vec3{0, 2, 0}, Vec3{-3, 1, 1e-300}}));
}

TEST(FindCrossings, TakesEqualTrianglesForACrossing) {
  EXPECT_TRUE(cross_in_any_order(kFloor, kFloor));
  EXPECT_EQ(crossings_of({kFloor, kFloor, kFloor}).count, 3u);
}

TEST(FindCrossings, WeldsEqualPlacesAndNegativeZeroToZero) {
  Corners right = {Vec3{0, 0, -0.0}, Vec3{4, -0.0, 0}, Vec3{2, -1, 0}};
  EXPECT_FALSE(cross_in_any_order(kFloor, right));
  right[0].x = 1e-300;  // no longer the same vertex, but still on the other's edge
  EXPECT_TRUE(cross_in_any_order(kFloor, right));
}

TEST(FindCrossings, TakesDegenerateTrianglesForTheSegmentsAndPointsTheyAre) {
  const Vec3 p{1, 1, 0};
  const Corners point = {p, p, p};
  const Corners needle = {Vec3{1, 1, -1}, Vec3{1, 1, 1}, Vec3{1, 1, 0.25}};
  EXPECT_EQ(crossings_of({kFloor, point, needle}).degenerate, 2u);
  EXPECT_TRUE(cross_in_any_order(kFloor, point));
  EXPECT_TRUE(cross_in_any_order(kFloor, needle));
  EXPECT_TRUE(cross_in_any_order(needle, point));
  EXPECT_FALSE(cross_in_any_order(kFloor, {p + Vec3{0, 0, 1}, p + Vec3{0, 0, 1}, p + Vec3{0, 0, 1}}));
  EXPECT_FALSE(cross_in_any_order(kFloor, {Vec3{1, 1, 2}, Vec3{1, 1, 1}, Vec3{1, 1, 3}}));
  EXPECT_TRUE(cross_in_any_order(needle, {Vec3{0, 1, 0}, Vec3{2, 1, 0}, Vec3{2, 1, 0}}));
  EXPECT_FALSE(cross_in_any_order(needle, {Vec3{0, 1, 2}, Vec3{2, 1, 2}, Vec3{2, 1, 2}}));
  EXPECT_TRUE(cross_in_any_order(needle, {Vec3{1, 1, 0.5}, Vec3{1, 1, 7}, Vec3{1, 1, 9}}));
  EXPECT_FALSE(cross_in_any_order(needle, {Vec3{1, 1, 1.5}, Vec3{1, 1, 7}, Vec3{1, 1, 9}}));
  // With a common vertex: from it along the face, away from it, along one line in both senses.
  EXPECT_TRUE(cross_in_any_order(kFloor, {Vec3{0, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 0, 0}}));
  EXPECT_FALSE(cross_in_any_order(kFloor, {Vec3{0, 0, 0}, Vec3{1, 1, 1}, Vec3{0, 0, 0}}));
  EXPECT_FALSE(cross_in_any_order(kFloor, {Vec3{0, 0, 0}, Vec3{0, 0, 0}, Vec3{0, 0, 0}}));
  EXPECT_TRUE(cross_in_any_order(needle, {Vec3{1, 1, 1}, Vec3{1, 1, 0.5}, Vec3{1, 1, 0.5}}));
  EXPECT_FALSE(cross_in_any_order(needle, {Vec3{1, 1, 1}, Vec3{1, 1, 2}, Vec3{1, 1, 2}}));
  // A triangle that a vertex on its edge has flattened lies along its neighbour's edge and does not cross it.
  EXPECT_FALSE(cross_in_any_order(kFloor, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{1, 0, 0}}));
  EXPECT_FALSE(cross_in_any_order(kFloor, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{9, 0, 0}}));
}

TEST(FindCrossings, CountsAllAndListsTheFirstInOrder) {
  // Ten floors and ten walls: a hundred pairs.
  std::vector<Corners> list;
  for (int i = 0; i < 10; ++i) {
    const double z = 0.1 * i;
    const double x = 0.1 + 0.03 * i;
    list.push_back({Vec3{0, 0, z}, Vec3{4, 0, z}, Vec3{0, 4, z}});
    list.push_back({Vec3{x, 0.1, -9}, Vec3{x, 3, -9}, Vec3{x, 1, 30}});
  }
  const CrossingReport all = crossings_of(list);
  EXPECT_EQ(all.count, 100u);
  EXPECT_EQ(all.crossings.size(), 100u);
  EXPECT_TRUE(std::ranges::is_sorted(pairs_of(all)));
  const CrossingReport some = crossings_of(list, 7);
  EXPECT_EQ(some.count, 100u);
  const std::vector<Pair> expected = pairs_of(all);
  EXPECT_EQ(pairs_of(some), std::vector<Pair>(expected.begin(), expected.begin() + 7));
  EXPECT_EQ(crossings_of(list, 0).count, 100u);
}

TEST(FindCrossings, HasNothingToSayOfNothing) {
  EXPECT_EQ(crossings_of({}).count, 0u);
  EXPECT_EQ(crossings_of({kFloor}).count, 0u);
}

TEST(FindCrossings, RefusesWhatItCannotDecide) {
  Soup soup({kFloor});
  soup.positions_mm[1].y = std::numeric_limits<double>::quiet_NaN();
  Expected<CrossingReport> report = find_crossings(soup.positions_mm, soup.triangles);
  ASSERT_FALSE(report);
  EXPECT_EQ(to_string(report.error()), "positions_mm[1] must be within -1e100 to 1e100, got nan");
  soup.positions_mm[1].y = -2e100;
  EXPECT_FALSE(find_crossings(soup.positions_mm, soup.triangles));
  soup.positions_mm[1].y = -1e100;
  EXPECT_TRUE(find_crossings(soup.positions_mm, soup.triangles));
  soup.triangles[0][2] = 3;
  report = find_crossings(soup.positions_mm, soup.triangles);
  ASSERT_FALSE(report);
  EXPECT_EQ(to_string(report.error()), "triangles[0] must be below the number of vertices, 3, got 3");
}

TEST(FindCrossings, StopsWhenAsked) {
  std::vector<Corners> list(20000, kFloor);
  for (std::size_t i = 0; i < list.size(); ++i) {
    for (Vec3& corner : list[i]) {
      corner.z += static_cast<double>(i);
    }
  }
  const Soup soup(list);
  const Expected<CrossingReport> report =
      find_crossings(soup.positions_mm, soup.triangles, 10, [](std::string_view, double) { return false; });
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kCancelled);
}

// ---- Another way to the same answer: the common part of two triangles, cut out in rational numbers.

using Rational = boost::multiprecision::cpp_rational;

struct Point {
  Rational x, y, z;
  friend bool operator==(const Point&, const Point&) = default;
  friend Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
};

Rational dot(const Point& a, const Point& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Point negative(const Point& a) {
  return {-a.x, -a.y, -a.z};
}

/// The part of a convex polygon where direction . (x - from) >= 0. Segments and points are polygons too.
std::vector<Point> clipped(const std::vector<Point>& polygon, const Point& from, const Point& direction) {
  std::vector<Point> result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& p = polygon[i];
    const Point& q = polygon[(i + 1) % polygon.size()];
    const Rational at_p = dot(direction, p - from);
    const Rational at_q = dot(direction, q - from);
    if (at_p >= 0) {
      result.push_back(p);
    }
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) {
      const Rational t = at_p / (at_p - at_q);
      const Point pq = q - p;
      result.push_back({p.x + t * pq.x, p.y + t * pq.y, p.z + t * pq.z});
    }
  }
  return result;
}

std::vector<Point> rational(const Corners& corners) {
  std::vector<Point> points;
  for (const Vec3 c : corners) {
    points.push_back({Rational(c.x), Rational(c.y), Rational(c.z)});
  }
  return points;
}

const Point kZero{0, 0, 0};

/// Corners of the common part of two triangles.
std::vector<Point> common_part(std::vector<Point> one, std::vector<Point> other) {
  Point normal = cross(other[1] - other[0], other[2] - other[0]);
  if (normal == kZero) {
    std::swap(one, other);
    normal = cross(other[1] - other[0], other[2] - other[0]);
  }
  std::vector<Point> part = one;
  const auto keep_between = [&part](const Point& from, const Point& direction) {
    part = clipped(part, from, direction);
    part = clipped(part, from, negative(direction));
  };
  if (!(normal == kZero)) {
    keep_between(other[0], normal);
    for (std::size_t k = 0; k < 3; ++k) {
      part = clipped(part, other[k], cross(normal, other[(k + 1) % 3] - other[k]));
    }
    return part;
  }
  // A segment: within its three coordinates' ranges, and on its line.
  const std::array<Point, 3> axes = {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}};
  for (const Point& axis : axes) {
    const auto [low, high] = std::minmax_element(
        other.begin(), other.end(), [&axis](const Point& a, const Point& b) { return dot(axis, a) < dot(axis, b); });
    part = clipped(part, *low, axis);
    part = clipped(part, *high, negative(axis));
    for (std::size_t k = 1; k < 3; ++k) {
      keep_between(other[0], cross(axis, other[k] - other[0]));
    }
  }
  return part;
}

bool rational_cross(const Corners& one, const Corners& other) {
  std::vector<Vec3> common;
  for (const Vec3 p : one) {
    if (std::ranges::find(other, p) != other.end() && std::ranges::find(common, p) == common.end()) {
      common.push_back(p);
    }
  }
  if (common.size() == 3) {
    return true;
  }
  const std::vector<Point> part = common_part(rational(one), rational(other));
  if (common.empty()) {
    return !part.empty();
  }
  const Point v = rational({common[0], common[0], common[0]})[0];
  const Point w = rational({common.back(), common.back(), common.back()})[0];
  return std::ranges::any_of(part, [&](const Point& p) {
    const bool on_common_edge =
        cross(p - v, w - v) == kZero && dot(p - v, w - v) >= 0 && dot(p - w, v - w) >= 0 && (v != w || p == v);
    return !on_common_edge;
  });
}

void expect_same_pairs(const std::vector<Corners>& list, std::uint64_t& crossing, const std::string& what) {
  std::vector<Pair> expected;
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    for (std::uint32_t j = i + 1; j < list.size(); ++j) {
      if (rational_cross(list[i], list[j])) {
        expected.push_back({i, j});
      }
    }
  }
  const CrossingReport report = crossings_of(list, 1'000'000);
  ASSERT_THAT(pairs_of(report), testing::ElementsAreArray(expected)) << what;
  crossing += expected.size();
}

TEST(FindCrossings, AgreesWithRationalNumbersOnGridsFullOfSpecialCases) {
  std::mt19937_64 random(7);
  std::uint64_t crossing = 0;
  for (int soup = 0; soup < 60; ++soup) {
    // Few places on few planes: most pairs touch, share vertices, are coplanar or degenerate.
    const std::uint64_t width = 2 + soup % 4;
    const std::uint64_t height = 1 + soup % 3;
    std::vector<Corners> list(20);
    for (Corners& corners : list) {
      for (Vec3& c : corners) {
        c = {static_cast<double>(random() % width), static_cast<double>(random() % width),
             static_cast<double>(random() % height)};
      }
    }
    expect_same_pairs(list, crossing, "soup " + std::to_string(soup));
  }
  EXPECT_GT(crossing, 1000u);
}

TEST(FindCrossings, AgreesWithRationalNumbersNextToTouching) {
  std::mt19937_64 random(8);
  const auto unit = [&random] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
  std::uint64_t crossing = 0;
  std::uint64_t pairs = 0;
  for (int soup = 0; soup < 60; ++soup) {
    std::vector<Corners> list;
    for (int i = 0; i < 8; ++i) {
      Corners corners;
      for (Vec3& c : corners) {
        c = {static_cast<float>(unit()), static_cast<float>(unit()), static_cast<float>(unit())};
      }
      // A second one whose corners lie on the first's face, on its edge and at its corner, but for the rounding.
      const double s = 0.5 + 0.5 * unit();
      const double t = (0.5 + 0.5 * unit()) * (1.0 - s);
      const Vec3 on_face = corners[0] + s * (corners[1] - corners[0]) + t * (corners[2] - corners[0]);
      const Vec3 on_edge = lerp(corners[0], corners[1], s);
      list.push_back(corners);
      list.push_back({on_face, on_edge + 2.0 * (on_edge - on_face), soup % 2 == 0 ? corners[2] : on_edge});
    }
    expect_same_pairs(list, crossing, "soup " + std::to_string(soup));
    pairs += list.size() * (list.size() - 1) / 2;
  }
  EXPECT_GT(crossing, pairs / 20);
  EXPECT_LT(crossing, pairs / 2);
}

// ---- Many petals at once

std::filesystem::path reference() {
  const char* given = std::getenv("ANTHESIS_REFERENCE");
  return given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT;
}

struct Scene {
  std::vector<Vec3> before_mm;
  std::vector<Vec3> after_mm;
  std::vector<Triangle> triangles;
};

Scene read_scene(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const auto read = [&file](auto* to, std::size_t count) {
    file.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(count * sizeof(*to)));
  };
  std::array<std::int32_t, 2> counts = {};
  read(counts.data(), 2);
  Scene scene;
  scene.before_mm.resize(static_cast<std::size_t>(counts[0]));
  scene.after_mm.resize(scene.before_mm.size());
  scene.triangles.resize(static_cast<std::size_t>(counts[1]));
  read(scene.before_mm.data(), scene.before_mm.size());
  read(scene.after_mm.data(), scene.after_mm.size());
  read(scene.triangles.data(), scene.triangles.size());
  EXPECT_TRUE(file.good()) << path;
  return scene;
}

TEST(FindCrossingsReference, PackedPetalsAreFreeBeforeTheyMoveThroughEachOtherAndNotAfter) {
  const std::filesystem::path folder = reference() / "contact-scenes";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "no reference data in " << reference() << "; set ANTHESIS_REFERENCE";
  }
  for (const char* name : {"art_16x19_a05.bin", "art_154x19_a05.bin", "art_154x19.bin"}) {
    const Scene scene = read_scene(folder / name);
    EXPECT_EQ(find_crossings(scene.before_mm, scene.triangles).value().count, 0u) << name;
    EXPECT_EQ(find_crossings(scene.before_mm, scene.triangles).value().degenerate, 0u) << name;
  }
  const Scene scene = read_scene(folder / "art_154x19.bin");
  std::vector<CrossingReport> reports;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    reports.push_back(find_crossings(scene.after_mm, scene.triangles).value());
  }
  EXPECT_GT(reports[0].count, 1000u);
  EXPECT_EQ(reports[0].count, reports[1].count);
  ASSERT_EQ(reports[0].crossings.size(), 1000u);
  for (std::size_t i = 0; i < reports[0].crossings.size(); ++i) {
    ASSERT_EQ(reports[0].crossings[i].first, reports[1].crossings[i].first);
    ASSERT_EQ(reports[0].crossings[i].second, reports[1].crossings[i].second);
    ASSERT_EQ(reports[0].crossings[i].place_mm, reports[1].crossings[i].place_mm);
  }
}

}  // namespace
}  // namespace anthesis
