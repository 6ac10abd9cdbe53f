#include "anthesis/contact/growing_sheets.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/contact/detector.h"
#include "sheets.h"

namespace anthesis {
namespace {

constexpr std::uint32_t kColumns = 5;
constexpr std::uint32_t kRows = 8;
constexpr double kWidth_mm = 1.6;
constexpr double kLength_mm = 3.2;
constexpr double kThickness_mm = 0.1;

/// A petal whose two lowest rows are attached.
Sheet petal_sheet() {
  Sheet sheet = grid_sheet(kColumns, kRows);
  for (std::uint32_t v = 0; v < 2 * kColumns; ++v) {
    sheet.attached.push_back(v);
    sheet.attachment_stiffness.push_back(0.5);
  }
  return sheet;
}

Sheet free_sheet() {
  Sheet sheet = petal_sheet();
  sheet.attached.clear();
  sheet.attachment_stiffness.clear();
  return sheet;
}

using Places = std::vector<Vec3>;

/// A petal that stands on `base` and leans towards +y, turned about the z axis through the origin.
Places petal(Vec3 base, double lean_deg, double turn_deg = 0.0, double size = 1.0) {
  const auto [sine, cosine] = math::sin_cos(math::radians(lean_deg));
  const Quaternion turn = rotation_about({0, 0, 1}, math::radians(turn_deg));
  Places places;
  for (std::uint32_t v = 0; v < kColumns * kRows; ++v) {
    const double across = size * kWidth_mm * (static_cast<double>(v % kColumns) / (kColumns - 1) - 0.5);
    const double along = size * kLength_mm * static_cast<double>(v / kColumns) / (kRows - 1);
    places.push_back(rotate(turn, base + Vec3{across, along * sine, along * cosine}));
  }
  return places;
}

Places joined(std::initializer_list<Places> parts) {
  Places all;
  for (const Places& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

std::uint64_t crossings_of(const GrowingSheets& sheets) {
  return sheets.audit()->count;
}

Places positions_of(const GrowingSheets& sheets) {
  return {sheets.positions_mm().begin(), sheets.positions_mm().end()};
}

double farthest(std::span<const Vec3> a, std::span<const Vec3> b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, length(a[i] - b[i]));
  }
  return most;
}

double distance_between_bodies(const GrowingSheets& sheets) {
  std::vector<ContactBody> bodies;
  for (std::size_t b = 0; b < sheets.body_count(); ++b) {
    bodies.push_back({sheets.body(b).sheet, sheets.first_vertex(b), 1.0, {}, true, false, true});
  }
  std::vector<Contact> contacts;
  Detector(sheets.sheets()).find_near(sheets.positions_mm(), bodies, contacts);
  double least = std::numeric_limits<double>::infinity();
  for (const Contact& contact : contacts) {
    least = std::min(least, contact.gap_mm);
  }
  return least;
}

/// Whether the places, taken as the bodies', cross.
bool would_cross(const GrowingSheets& sheets, const Places& places) {
  std::vector<Triangle> triangles;
  for (std::size_t b = 0; b < sheets.body_count(); ++b) {
    const std::uint32_t first = sheets.first_vertex(b);
    for (const Triangle& t : sheets.sheets()[sheets.body(b).sheet].triangles) {
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  return find_crossings(places, triangles)->count > 0;
}

/// Two petals face to face that lean through each other's place.
Places leaning_pair(double lean_deg) {
  return joined({petal({0.07, -0.4, 0}, lean_deg), petal({0, -0.4, 0}, lean_deg, 180.0)});
}

GrowingSheets pair_of_petals(const GrowingOptions& options = {}) {
  GrowingSheets sheets({petal_sheet()}, options);
  const Places start = leaning_pair(0.0);
  const std::size_t count = start.size() / 2;
  EXPECT_EQ(sheets.enter({0, kThickness_mm}, std::span(start).first(count), {}).scale, 1.0);
  EXPECT_EQ(sheets.enter({0, kThickness_mm}, std::span(start).last(count), {}).scale, 1.0);
  return sheets;
}

constexpr int kSteps = 24;
double lean_at(int step) {
  return 30.0 * step / kSteps;
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(GrowingSheets, PetalsThatLeanThroughEachOtherEndLeaningOnEachOther) {
  GrowingSheets sheets = pair_of_petals();
  for (int step = 1; step <= kSteps; ++step) {
    ASSERT_TRUE(sheets.advance(leaning_pair(lean_at(step))));
    ASSERT_EQ(crossings_of(sheets), 0u) << "step " << step;
  }
  EXPECT_TRUE(would_cross(sheets, leaning_pair(lean_at(kSteps))));  // or this test shows nothing
  EXPECT_NEAR(distance_between_bodies(sheets), kThickness_mm, 0.25 * kThickness_mm);
}

TEST(GrowingSheets, EvenALeapIsFreeOfCrossings) {
  // However little is done to keep them apart.
  for (const GrowingOptions& options :
       {GrowingOptions{}, GrowingOptions{.sweeps = 1, .piece = 1.0, .settling_passes = 0}}) {
    GrowingSheets sheets = pair_of_petals(options);
    const auto leapt = sheets.advance(leaning_pair(85.0));
    ASSERT_TRUE(leapt);
    EXPECT_EQ(crossings_of(sheets), 0u);
    EXPECT_TRUE(would_cross(sheets, leaning_pair(85.0)));
    ASSERT_TRUE(sheets.advance(leaning_pair(-40.0)));
    EXPECT_EQ(crossings_of(sheets), 0u);
  }
}

/// How far lengths and angles are from those of the targets: relative, and radians.
struct Strain {
  double length = 0.0;
  double angle_rad = 0.0;
};

Strain strain_of(const Sheet& sheet, std::span<const Vec3> places, std::span<const Vec3> targets) {
  Strain strain;
  for (const auto& [a, b] : sheet.edges) {
    const double rest = length(targets[b] - targets[a]);
    strain.length = std::max(strain.length, std::abs(length(places[b] - places[a]) / rest - 1.0));
  }
  for (const auto& [a, b, c, d] : sheet.hinges) {
    const double now = hinge_angle_rad(places[a], places[b], places[c], places[d]);
    const double rest = hinge_angle_rad(targets[a], targets[b], targets[c], targets[d]);
    strain.angle_rad = std::max(strain.angle_rad,
                                std::abs(math::radians(180.0) - std::abs(math::radians(180.0) - std::abs(now - rest))));
  }
  return strain;
}

TEST(GrowingSheets, APetalGivesWayToAPlateAndComesBackWhenItLeaves) {
  // The plate stands upright beside the petal's upper half.
  const auto plate = [](double y) { return Places{{-3, y, 1.9}, {3, y, 1.9}, {-3, y, 6}, {3, y, 6}}; };
  GrowingSheets sheets({petal_sheet(), grid_sheet(2, 2)}, {.sweeps = 100, .settling_passes = 300, .residual_mm = 1e-9});
  const Places upright = petal({}, 0.0);
  ASSERT_EQ(sheets.enter({1, kThickness_mm, true}, plate(-0.5), {}).scale, 1.0);
  ASSERT_EQ(sheets.enter({0, kThickness_mm}, upright, {}).scale, 1.0);
  const auto petal_now = [&] { return sheets.positions_mm().subspan(4); };
  for (int step = 1; step <= 15; ++step) {
    ASSERT_TRUE(sheets.advance(joined({plate(-0.5 + 0.1 * step), upright})));
    ASSERT_EQ(crossings_of(sheets), 0u) << "step " << step;
  }
  EXPECT_NEAR(sheets.positions_mm()[0].y, 1.0, 1e-9);  // nothing holds the plate up
  for (const Vec3 p : petal_now()) {
    if (p.z > 1.9) {
      EXPECT_GT(p.y, 1.0 + 0.5 * kThickness_mm);
    }
  }
  EXPECT_GT(strain_of(sheets.sheets()[0], petal_now(), upright).angle_rad, 0.05);
  EXPECT_LT(farthest(petal_now().first(2 * kColumns), upright), kThickness_mm);  // the base is where it was
  for (int step = 1; step <= 15; ++step) {
    ASSERT_TRUE(sheets.advance(joined({plate(1.0 - 0.1 * step), upright})));
  }
  for (int more = 0; more < 20; ++more) {
    ASSERT_TRUE(sheets.advance(joined({plate(-0.5), upright})));
  }
  const Strain strain = strain_of(sheets.sheets()[0], petal_now(), upright);
  EXPECT_LT(strain.length, 1e-6);
  EXPECT_LT(strain.angle_rad, 1e-6);
}

TEST(GrowingSheets, WhatNothingTouchesFollowsItsTarget) {
  GrowingSheets sheets({petal_sheet()}, {});
  ASSERT_EQ(sheets.enter({0, kThickness_mm}, petal({}, 0.0), {}).scale, 1.0);
  ASSERT_EQ(sheets.enter({0, kThickness_mm}, petal({0, 2, 0}, 0.0), {}).scale, 1.0);
  double size = 1.0;
  for (int step = 1; step <= 40; ++step) {
    size *= 1.01;
    const Places targets = joined({petal({0, -0.02 * step, 0.05 * step}, 0.5 * step, 0.0, size),
                                   petal({0, 2, 0.05 * step}, 2.0 * step, 0.0, size)});
    const auto grown = sheets.advance(targets);
    ASSERT_TRUE(grown);
    ASSERT_LT(farthest(sheets.positions_mm(), targets), 1e-9) << "step " << step;
    EXPECT_EQ(grown->shortened, 0u);
  }
}

/// Five petals around the axis that lean inwards and sideways, each into the next one.
Places whorl(double lean_deg, bool mirrored = false) {
  Places all;
  for (int k = 0; k < 5; ++k) {
    const Quaternion turn = rotation_about({0, 0, 1}, math::radians(72.0 * k));
    for (Vec3 p : petal({0, -1.3, 0}, lean_deg)) {
      p.x += math::tan(math::radians(0.6 * lean_deg)) * p.z * (mirrored ? -1.0 : 1.0);
      all.push_back(rotate(turn, p));
    }
  }
  return all;
}

TEST(GrowingSheets, AWhorlOfFiveStaysFivefold) {
  GrowingSheets sheets({petal_sheet()}, {});
  const Places start = whorl(0.0);
  const std::size_t count = start.size() / 5;
  for (std::size_t k = 0; k < 5; ++k) {
    ASSERT_EQ(sheets.enter({0, kThickness_mm}, std::span(start).subspan(k * count, count), {}).scale, 1.0);
  }
  const Quaternion turn = rotation_about({0, 0, 1}, math::radians(72.0));
  std::uint64_t contacts = 0;
  for (int step = 1; step <= kSteps; ++step) {
    const auto grown = sheets.advance(whorl(lean_at(step)));
    ASSERT_TRUE(grown);
    contacts += grown->contacts;
    ASSERT_EQ(crossings_of(sheets), 0u);
    double asymmetry = 0.0;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const Vec3 here = sheets.positions_mm()[i];
      const Vec3 next = sheets.positions_mm()[(i + count) % start.size()];
      asymmetry = std::max(asymmetry, length(rotate(turn, here) - next));
    }
    ASSERT_LT(asymmetry, 1e-9) << "step " << step;
  }
  EXPECT_TRUE(would_cross(sheets, whorl(lean_at(kSteps))));
  EXPECT_GT(contacts, 1000u);
}

TEST(GrowingSheets, FreeBodiesPushEachOtherEqually) {
  // Two sheets drift through each other and nothing holds them: what they have in common goes where the targets go.
  GrowingSheets sheets({free_sheet()}, {});
  const auto flat = [](double z, double turn_deg) {
    Places places = petal({0.1, -0.5 * kLength_mm, 0}, 90.0, turn_deg);
    for (Vec3& p : places) {
      p.z += z;
    }
    return places;
  };
  const auto targets_at = [&](int step) { return joined({flat(0.01 * step, 0.0), flat(0.3 - 0.02 * step, 57.0)}); };
  const auto centroid = [](std::span<const Vec3> places) {
    Vec3 sum{};
    for (const Vec3 p : places) {
      sum += p;
    }
    return sum / static_cast<double>(places.size());
  };
  const Places start = targets_at(0);
  const std::size_t count = start.size() / 2;
  ASSERT_EQ(sheets.enter({0, kThickness_mm}, std::span(start).first(count), {}).scale, 1.0);
  ASSERT_EQ(sheets.enter({0, kThickness_mm}, std::span(start).last(count), {}).scale, 1.0);
  for (int step = 1; step <= 30; ++step) {
    const Places targets = targets_at(step);
    ASSERT_TRUE(sheets.advance(targets));
    ASSERT_EQ(crossings_of(sheets), 0u);
    EXPECT_LT(length(centroid(sheets.positions_mm()) - centroid(targets)), 0.25 * kThickness_mm) << "step " << step;
  }
  EXPECT_GT(centroid(sheets.positions_mm().last(count)).z, centroid(sheets.positions_mm().first(count)).z);
}

TEST(GrowingSheets, ASleeperThatIsPressedWakesUpAndGivesWay) {
  GrowingSheets sheets = pair_of_petals();
  const std::size_t count = sheets.positions_mm().size() / 2;
  const Places upright = leaning_pair(0.0);
  for (int step = 1; step <= kSteps; ++step) {
    Places targets = leaning_pair(lean_at(step));
    std::copy(upright.begin() + static_cast<std::ptrdiff_t>(count), upright.end(),
              targets.begin() + static_cast<std::ptrdiff_t>(count));
    ASSERT_TRUE(sheets.advance(targets));
    ASSERT_EQ(crossings_of(sheets), 0u);
  }
  EXPECT_GT(farthest(sheets.positions_mm().last(count), std::span(upright).last(count)), 2.0 * kThickness_mm);
}

TEST(GrowingSheets, AnAttachedOrganThatIsPushedOffKeepsItsBase) {
  GrowingSheets sheets = pair_of_petals();
  for (int step = 1; step <= kSteps; ++step) {
    ASSERT_TRUE(sheets.advance(leaning_pair(lean_at(step))));
  }
  const Places targets = leaning_pair(lean_at(kSteps));
  const std::size_t count = targets.size() / 2;
  for (const std::size_t first : {std::size_t{0}, count}) {
    EXPECT_LT(farthest(sheets.positions_mm().subspan(first, kColumns), std::span(targets).subspan(first, kColumns)),
              0.5 * kThickness_mm);
    EXPECT_GT(farthest(sheets.positions_mm().subspan(first, count), std::span(targets).subspan(first, count)),
              2.0 * kThickness_mm);
  }
}

TEST(GrowingSheets, AFixedBodyIsNotPushed) {
  GrowingSheets sheets({petal_sheet(), grid_sheet(2, 2)}, {});
  const Places wall = {{-3, 0.5, 0.4}, {3, 0.5, 0.4}, {-3, 0.5, 6}, {3, 0.5, 6}};
  ASSERT_EQ(sheets.enter({1, kThickness_mm, true}, wall, {}).scale, 1.0);
  ASSERT_EQ(sheets.enter({0, kThickness_mm}, petal({}, 0.0), {}).scale, 1.0);
  for (int step = 1; step <= kSteps; ++step) {
    ASSERT_TRUE(sheets.advance(joined({wall, petal({}, lean_at(step))})));
    ASSERT_EQ(crossings_of(sheets), 0u);
  }
  EXPECT_TRUE(would_cross(sheets, joined({wall, petal({}, lean_at(kSteps))})));
  for (std::size_t i = 0; i < wall.size(); ++i) {
    EXPECT_EQ(sheets.positions_mm()[i], wall[i]);
  }
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(GrowingSheets, AnOrganShrinksIntoACrowdedPlaceAndGrowsIntoTheRoomThereIs) {
  GrowingSheets sheets({petal_sheet(), grid_sheet(2, 2)}, {});
  // A ceiling over the middle of the petal.
  const Places ceiling = {{-3, -3, 1.0}, {3, -3, 1.0}, {-3, 3, 1.0}, {3, 3, 1.0}};
  ASSERT_EQ(sheets.enter({1, kThickness_mm, true}, ceiling, {}).scale, 1.0);
  const Places target = petal({}, 0.0);
  const GrowingSheets::Entry entry = sheets.enter({0, kThickness_mm}, target, {});
  EXPECT_EQ(entry.scale, 0.25);  // 3.2 mm shrink to 0.8 mm
  EXPECT_TRUE(entry.in_place.empty());
  EXPECT_FALSE(entry.crosses_itself);
  EXPECT_EQ(crossings_of(sheets), 0u);
  for (std::size_t i = 0; i < target.size(); ++i) {
    EXPECT_EQ(sheets.positions_mm()[4 + i], 0.25 * target[i]);
  }
  ASSERT_TRUE(sheets.advance(joined({ceiling, target})));
  EXPECT_EQ(crossings_of(sheets), 0u);
  double top_mm = 0.0;
  for (const Vec3 p : sheets.positions_mm().subspan(4)) {
    top_mm = std::max(top_mm, p.z);
  }
  EXPECT_GT(top_mm, 0.85);
  EXPECT_LT(top_mm, 1.0);
}

TEST(GrowingSheets, WithoutAnyRoomTheBodiesInPlaceAreNamed) {
  GrowingSheets sheets({petal_sheet(), grid_sheet(2, 2)}, {});
  const auto wall = [](double y) { return Places{{-9, y, -9}, {9, y, -9}, {-9, y, 9}, {9, y, 9}}; };
  ASSERT_EQ(sheets.enter({1, kThickness_mm}, wall(-5.0), {}).scale, 1.0);
  ASSERT_EQ(sheets.enter({1, kThickness_mm}, wall(0.001), {}).scale, 1.0);
  ASSERT_EQ(sheets.enter({1, kThickness_mm}, wall(0.0), {}).scale, 1.0);
  const Places before = positions_of(sheets);
  const GrowingSheets::Entry entry = sheets.enter({0, kThickness_mm}, petal({0, -0.01, 0}, 45.0), {});
  EXPECT_EQ(entry.scale, 0.0);
  EXPECT_THAT(entry.in_place, testing::ElementsAre(1, 2));
  EXPECT_FALSE(entry.crosses_itself);
  EXPECT_EQ(sheets.body_count(), 3u);  // and nothing has changed
  EXPECT_EQ(positions_of(sheets), before);
  EXPECT_TRUE(sheets.advance(before));
}

TEST(GrowingSheets, ATargetThatCrossesItselfIsReported) {
  GrowingSheets sheets({petal_sheet()}, {});
  Places folded = petal({}, 0.0);
  folded.back() = {-0.33, -0.2, 0.77};  // the tip's corner bent down through the blade
  folded[folded.size() - 2] = {-0.31, 0.2, 0.9};
  const GrowingSheets::Entry entry = sheets.enter({0, kThickness_mm}, folded, {});
  EXPECT_EQ(entry.scale, 0.0);
  EXPECT_TRUE(entry.crosses_itself);
  EXPECT_EQ(sheets.body_count(), 0u);
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(GrowingSheets, TheNumberOfThreadsChangesNoBit) {
  Places once;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    GrowingSheets sheets = pair_of_petals();
    for (int step = 1; step <= kSteps; ++step) {
      ASSERT_TRUE(sheets.advance(leaning_pair(lean_at(step))));
    }
    if (once.empty()) {
      once = positions_of(sheets);
    }
    EXPECT_EQ(positions_of(sheets), once) << threads;
  }
}

TEST(GrowingSheets, ASnapshotGoesOnElsewhereWithTheSameBits) {
  const GrowingOptions in_the_middle{.settling_passes = 0};  // nothing has come to rest between two steps
  for (const GrowingOptions& options : {GrowingOptions{}, in_the_middle}) {
    GrowingSheets sheets = pair_of_petals(options);
    const Places aside = petal({9, 0, 0}, 0.0);  // something asleep, too
    ASSERT_EQ(sheets.enter({0, kThickness_mm}, aside, {}).scale, 1.0);
    for (int step = 1; step <= kSteps; ++step) {
      GrowingSheets other({petal_sheet()}, options);
      other.restore(sheets.snapshot());
      ASSERT_EQ(other.body_count(), 3u);
      EXPECT_EQ(other.first_vertex(2), sheets.first_vertex(2));
      const Places targets = joined({leaning_pair(3.0 * lean_at(step)), aside});
      const auto one = sheets.advance(targets);
      const auto two = other.advance(targets);
      ASSERT_TRUE(one);
      ASSERT_TRUE(two);
      ASSERT_EQ(positions_of(other), positions_of(sheets)) << "step " << step;
      EXPECT_EQ(two->passes, one->passes);
      EXPECT_EQ(two->contacts, one->contacts);
      EXPECT_EQ(two->shortened, one->shortened);
      if (step == kSteps / 2) {
        sheets = std::move(other);
      }
    }
  }
}

TEST(GrowingSheets, ABranchOffTheWayLeavesNoTrace) {
  const GrowingOptions options{.settling_passes = 200};
  GrowingSheets straight = pair_of_petals(options);
  GrowingSheets winding = pair_of_petals(options);
  const std::size_t count = straight.positions_mm().size() / 2;
  const Places away = petal({0, -0.4, 0}, -60.0, 180.0);
  const Places upright = petal({0, -0.4, 0}, 0.0, 180.0);
  for (int step = 1; step <= kSteps; ++step) {
    const Places here = petal({0.07, -0.4, 0}, lean_at(step));
    ASSERT_TRUE(straight.advance(joined({here, upright})));
    // In the branch the second petal lies down and falls asleep where it is not.
    GrowingSheets::Snapshot before = winding.snapshot();
    ASSERT_TRUE(winding.advance(joined({petal({0.07, -0.4, 0}, lean_at(step) - 0.4), away})));
    EXPECT_LT(farthest(winding.positions_mm().last(count), away), 0.5);
    winding.restore(std::move(before));
    ASSERT_TRUE(winding.advance(joined({here, upright})));
    ASSERT_EQ(positions_of(winding), positions_of(straight)) << "step " << step;
  }
}

TEST(GrowingSheets, StopsWhenAskedAndIsStillFreeOfCrossings) {
  for (const int reports : {0, 1, 3}) {
    GrowingSheets sheets = pair_of_petals();
    int seen = 0;
    double last = -1.0;
    const auto stopped = sheets.advance(leaning_pair(60.0), [&](std::string_view, double fraction) {
      EXPECT_GE(fraction, last);
      EXPECT_LE(fraction, 1.0);
      last = fraction;
      return seen++ < reports;
    });
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
    EXPECT_EQ(seen, reports + 1);
    EXPECT_EQ(crossings_of(sheets), 0u);
    EXPECT_TRUE(sheets.advance(leaning_pair(60.0)));  // and goes on where it was
    EXPECT_EQ(crossings_of(sheets), 0u);
  }
}

}  // namespace
}  // namespace anthesis
