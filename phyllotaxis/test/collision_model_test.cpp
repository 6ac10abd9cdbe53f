#include "anthesis/phyllotaxis/collision_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "anthesis/base/math.h"
#include "anthesis/base/random.h"

namespace anthesis {
namespace {

SurfaceOfRevolution disc(double radius_mm) {
  return {{{0.0, 0.0}, {radius_mm, 0.0}}, 1};
}

SurfaceOfRevolution cylinder(double radius_mm, double length_mm) {
  return {{{radius_mm, length_mm}, {radius_mm, 0.0}}, 1};
}

/// Within 3e-4 of the radius: two quarters of a circle as cubic Bezier curves, from pole to pole.
SurfaceOfRevolution sphere(double radius_mm) {
  const double r = radius_mm;
  const double k = 0.5522847498 * r;
  return SurfaceOfRevolution(bezier_chain<Vec2>({{0, r}, {k, r}, {r, k}, {r, 0}, {r, -k}, {k, -r}, {0, -r}}, 3));
}

std::vector<CollisionOrgan> organs_of(const CollisionParams& params) {
  const Expected<CollisionPattern> pattern = place_by_collision(params, 10'000'000);
  EXPECT_TRUE(pattern.has_value()) << (pattern ? "" : to_string(pattern.error()));
  return pattern ? pattern->organs : std::vector<CollisionOrgan>{};
}

/// The definition, read off F92 section 2.4 and computed from nothing but points of the surface: it knows all earlier
/// organs and no polynomial.
class Definition {
 public:
  Definition(const CollisionParams& params, const std::vector<CollisionOrgan>& organs)
      : params_(params), organs_(organs) {
    for (const CollisionOrgan& organ : organs) {
      centres_.push_back(params.surface.frame(organ.t, organ.azimuth_rad).position_mm);
    }
    if (const auto* by_place = std::get_if<RadiusAlongProfile>(&params.radius_mm)) {
      by_place_ = &by_place->radius_mm;
      for (int i = 0; i < 1000; ++i) {
        const double s = i / 1000.0;
        steepest_ = std::max(steepest_, 1000.0 * std::abs((*by_place_)(s) - (*by_place_)(s + 1e-3)));
      }
      steepest_ = 1.5 * steepest_ / params.surface.length_mm();
    }
  }

  /// Distance to spare of organ n at the place s, from the nearest of those before it; negative: a collision.
  double clearance(std::size_t n, double s, std::size_t* nearest = nullptr) const {
    return clearance_at(n, params_.surface.t_from_s(s), s, nearest);
  }
  double clearance_at(std::size_t n, double t, double s, std::size_t* nearest = nullptr) const {
    const Vec3 place = params_.surface.frame(t, organs_[n].azimuth_rad).position_mm;
    const double radius_mm = by_place_ != nullptr ? (*by_place_)(s) : organs_[n].radius_mm;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      const double spare = length(place - centres_[i]) - params_.contact_factor * (organs_[i].radius_mm + radius_mm);
      if (spare < least) {
        least = spare;
        if (nearest != nullptr) {
          *nearest = i;
        }
      }
    }
    return least;
  }

  /// Where the search for organ n begins, as a share s of the profile: at the base or at its fall limit.
  double start(std::size_t n) const {
    bool limited = params_.fall_limit == FallLimit::kAlways && n > 0;
    if (params_.fall_limit == FallLimit::kWhereRadiiDecrease && by_place_ == nullptr) {
      for (std::size_t i = 0; i < n; ++i) {
        limited = limited || organs_[i].radius_mm > organs_[n].radius_mm;
      }
    }
    if (!limited) {
      return 1.0;
    }
    const double radius_mm = by_place_ != nullptr ? organs_[n - 1].radius_mm : organs_[n].radius_mm;
    return std::min(organs_[n - 1].s + params_.fall_radii * radius_mm / params_.surface.length_mm(), 1.0);
  }

  /// No free place for organ n between its start and `end`. Distances change by no more than the way along the profile,
  /// so a collision of depth d clears the way by d: the walk skips nothing wider than 1e-6 of the profile.
  bool all_forbidden(std::size_t n, double end) const {
    const double length_mm = params_.surface.length_mm();
    const double steepest = 1.0 + params_.contact_factor * steepest_;
    for (double s = start(n); s > end;) {
      const double spare = clearance(n, s);
      if (spare > 1e-9) {
        ADD_FAILURE() << "organ " << n << " at s = " << organs_[n].s << " was free at " << s << " by " << spare;
        return false;
      }
      s -= std::max(-spare / steepest / length_mm, 1e-6);
    }
    return true;
  }

  /// All that the model promises of organ n.
  bool holds(std::size_t n) const {
    const CollisionOrgan& organ = organs_[n];
    EXPECT_NEAR(organ.s, params_.surface.s_from_t(organ.t), 1e-12);
    std::size_t nearest = 0;
    const double spare = clearance_at(n, organ.t, organ.s, &nearest);
    EXPECT_GE(spare, -1e-9) << "organ " << n << " collides with " << nearest;
    const bool at_start = std::abs(organ.s - start(n)) * params_.surface.length_mm() < 1e-9;
    if (!at_start) {
      EXPECT_LE(spare, 1e-9) << "organ " << n << " touches nothing";
      EXPECT_EQ(organ.contacts[0], nearest) << "organ " << n;
    }
    if (by_place_ != nullptr) {
      EXPECT_NEAR(organ.radius_mm, (*by_place_)(organ.s), 1e-10);
    }
    return spare >= -1e-9 && (at_start || spare <= 1e-9) && all_forbidden(n, organ.s + 1e-6);
  }

 private:
  const CollisionParams& params_;
  const std::vector<CollisionOrgan>& organs_;
  std::vector<Vec3> centres_;
  const FunctionGraph* by_place_ = nullptr;
  double steepest_ = 0.0;
};

/// Folded, looped, pinched: any curve beside the axis will do.
SurfaceOfRevolution random_surface(std::uint64_t seed) {
  Rng rng(seed, 1, RandomPurpose::kTest);
  const int degree = 1 + static_cast<int>(rng.bits() % 5);
  const int pieces = 1 + static_cast<int>(rng.bits() % 3);
  std::vector<Vec2> controls;
  const auto random_points = [&](int count) {
    for (int i = 0; i < count; ++i) {
      controls.push_back({rng.uniform(0.0, 3.0), rng.uniform(-2.0, 2.0)});
    }
  };
  if (seed % 2 == 0) {
    random_points(pieces * degree + 1);
    controls.front().x = seed % 4 == 0 ? 0.0 : controls.front().x;
    return SurfaceOfRevolution(bezier_chain(std::move(controls), degree));
  }
  random_points(degree + pieces + 1);
  return {std::move(controls), degree};
}

CollisionRadii random_radii(std::uint64_t seed, double radius_mm) {
  Rng rng(seed, 2, RandomPurpose::kTest);
  std::vector<double> radii(500, radius_mm);
  switch (seed % 5) {
    case 0:
      break;
    case 1:
      for (double& r : radii) {
        r *= rng.uniform(0.4, 1.2);
      }
      break;
    case 2:
      for (std::size_t i = 0; i < radii.size(); ++i) {
        radii[i] *= 1.5 - static_cast<double>(i) / 400.0;
      }
      break;
    case 3:
      for (std::size_t i = 0; i < radii.size(); ++i) {
        radii[i] *= 0.3 + static_cast<double>(i) / 300.0;
      }
      break;
    default:
      return RadiusAlongProfile{FunctionGraph({{0.0, radius_mm * rng.uniform(0.5, 2.0)},
                                               {0.3, radius_mm * rng.uniform(0.5, 2.0)},
                                               {0.5, radius_mm},
                                               {0.8, radius_mm * rng.uniform(0.5, 2.0)},
                                               {1.0, radius_mm * rng.uniform(0.5, 2.0)}})};
  }
  return radii;
}

TEST(PlaceByCollision, IsTheLeastFreePlaceOnRandomSurfaces) {
  std::size_t checked = 0;
  std::size_t lifted = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("surface " + std::to_string(seed));
    CollisionParams params{.surface = random_surface(seed)};
    params.radius_mm = random_radii(seed, std::sqrt(0.5 * params.surface.area_mm2() / (500.0 * math::kPi)));
    params.contact_factor = seed % 3 == 0 ? 0.8 : 1.0;
    params.fall_limit = seed % 7 == 0   ? FallLimit::kAlways
                        : seed % 2 == 0 ? FallLimit::kNever
                                        : FallLimit::kWhereRadiiDecrease;
    params.fall_radii = 1.5;
    std::vector<CollisionOrgan> organs = organs_of(params);
    organs.resize(std::min<std::size_t>(organs.size(), 500));
    const Definition definition(params, organs);
    for (std::size_t n = 0; n < organs.size(); ++n) {
      ASSERT_TRUE(definition.holds(n));
      lifted += organs[n].contacts[0] != kNoOrgan ? 1 : 0;
    }
    checked += organs.size();
  }
  EXPECT_GT(checked, 8000u);
  EXPECT_GT(lifted, 7000u);
}

/// A search from the base, past everything the model knows to be forbidden, finds the same places.
TEST(PlaceByCollision, StartingAboveWhatIsForbiddenMissesNothing) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("surface " + std::to_string(seed));
    CollisionParams params{.surface = seed == 0   ? disc(3.0)
                                      : seed == 1 ? sphere(3.0)
                                      : seed == 2 ? cylinder(0.2, 100.0)
                                                  : random_surface(seed)};
    const double radius_mm = std::sqrt(0.5 * params.surface.area_mm2() / (2000.0 * math::kPi));
    params.radius_mm = radius_mm;
    if (seed % 4 == 3) {
      params.radius_mm =
          RadiusAlongProfile{FunctionGraph({{0.0, 0.4 * radius_mm}, {0.5, 1.8 * radius_mm}, {1.0, 0.8 * radius_mm}})};
    } else if (seed >= 4 && seed % 2 == 0) {
      params.radius_mm = RadiusByIndex{
          [=](std::size_t k) { return radius_mm * (0.6 + 0.6 * Rng(seed, k, RandomPurpose::kTest).uniform()); }};
    }
    params.fall_limit = FallLimit::kNever;
    const std::vector<CollisionOrgan> fast = organs_of(params);
    params.fall_limit = FallLimit::kAlways;
    params.fall_radii = 1e12;  // down to the base: nothing is taken for granted
    const std::vector<CollisionOrgan> slow = organs_of(params);
    ASSERT_EQ(fast.size(), slow.size());
    EXPECT_GT(fast.size(), 1500u);
    for (std::size_t n = 0; n < fast.size(); ++n) {
      ASSERT_NEAR(fast[n].s * params.surface.length_mm(), slow[n].s * params.surface.length_mm(), 1e-9) << n;
      ASSERT_EQ(fast[n].contacts, slow[n].contacts) << n;
    }
  }
}

/// F92 section 2.3: the first group forms a ring at the base, until one collides. The ring's number is a Fibonacci
/// number (canalization): the first F for which the F-th organ lies nearer to the first than a contact.
TEST(PlaceByCollision, BaseRingOfADiscHasAFibonacciNumber) {
  for (const auto& [radius_mm, ring] : {std::pair{0.05, 34u}, std::pair{0.04, 55u}}) {
    const Expected<CollisionPattern> pattern =
        place_by_collision({.surface = disc(1.0), .radius_mm = radius_mm}, 10'000);
    ASSERT_TRUE(pattern.has_value());
    EXPECT_EQ(pattern->base_ring, ring);
    for (std::size_t n = 0; n < ring; ++n) {
      EXPECT_EQ(pattern->organs[n].t, 1.0);
      EXPECT_EQ(pattern->organs[n].contacts[0], kNoOrgan);
    }
    EXPECT_LT(pattern->organs[ring].t, 1.0);
    EXPECT_EQ(pattern->organs[ring].contacts[0], 0u);
  }
}

TEST(PlaceByCollision, ParastichiesOfACylinderAreFibonacciNumbers) {
  const std::vector<CollisionOrgan> organs = organs_of({.surface = cylinder(1.0, 6.0), .radius_mm = 0.08});
  std::set<std::uint32_t> offsets;
  for (std::size_t n = organs.size() / 2; n < organs.size(); ++n) {
    offsets.insert(static_cast<std::uint32_t>(n) - organs[n].contacts[0]);
  }
  for (const std::uint32_t offset : offsets) {
    EXPECT_TRUE(offset == 8 || offset == 13 || offset == 21 || offset == 34) << offset;
  }
}

/// 137.5 degrees are 55/144 of a turn: 144 columns, between which large patterns leave the surface bare.
TEST(PlaceByCollision, RoundedGoldenAngleCollapsesToColumns) {
  CollisionParams params{.surface = disc(1.0), .radius_mm = 0.005};
  const std::vector<CollisionOrgan> exact = organs_of(params);
  params.divergence_rad = math::radians(137.5);
  const std::vector<CollisionOrgan> rounded = organs_of(params);
  EXPECT_LT(2 * rounded.size(), exact.size());
  std::set<long> columns;
  for (const CollisionOrgan& organ : rounded) {
    columns.insert(std::lround(organ.azimuth_rad / math::kTurnRad * 1e6) % 1'000'000);
  }
  EXPECT_EQ(columns.size(), 144u);
}

TEST(PlaceByCollision, ContactFactorLetsSpheresIntersectByThatMuch) {
  CollisionParams params{.surface = sphere(1.0), .radius_mm = 0.1};
  params.contact_factor = 0.75;
  const std::vector<CollisionOrgan> organs = organs_of(params);
  double closest = 1.0;
  for (std::size_t i = 0; i < organs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      closest = std::min(closest, length(params.surface.frame(organs[i].t, organs[i].azimuth_rad).position_mm -
                                         params.surface.frame(organs[j].t, organs[j].azimuth_rad).position_mm));
    }
  }
  EXPECT_NEAR(closest, 0.75 * 0.2, 1e-12);
}

/// F92 section 2.4: small organs would slip into the gaps between large ones near the base.
TEST(PlaceByCollision, FallLimitKeepsSmallOrgansOutOfGapsBelow) {
  CollisionParams params{.surface = disc(1.0)};
  params.radius_mm =
      RadiusByIndex{[](std::size_t k) { return std::max(0.06 - 0.0001 * static_cast<double>(k), 0.01); }};
  const auto deepest_fall_radii = [&](FallLimit limit) {
    params.fall_limit = limit;
    const std::vector<CollisionOrgan> organs = organs_of(params);
    double fall = 0.0;
    for (std::size_t n = 1; n < organs.size(); ++n) {
      fall = std::max(fall, (organs[n].s - organs[n - 1].s) / organs[n].radius_mm);
    }
    return fall;
  };
  EXPECT_LE(deepest_fall_radii(FallLimit::kWhereRadiiDecrease), 1.0 + 1e-9);
  EXPECT_GT(deepest_fall_radii(FallLimit::kNever), 20.0);
}

TEST(PlaceByCollision, AzimuthsAreProductsAndASequenceEndsThePattern) {
  const CollisionParams params{.surface = disc(1.0), .radius_mm = std::vector<double>(50, 0.02)};
  const std::vector<CollisionOrgan> organs = organs_of(params);
  ASSERT_EQ(organs.size(), 50u);
  for (std::size_t n = 0; n < organs.size(); ++n) {
    EXPECT_EQ(organs[n].azimuth_rad, spiral_azimuth_rad(n, kGoldenAngleRad));
    EXPECT_EQ(organs[n].radius_mm, 0.02);
  }
  EXPECT_EQ(organs[0].t, 1.0);
  EXPECT_TRUE(organs_of({.surface = disc(1.0), .radius_mm = std::vector<double>{}}).empty());
}

/// A profile in one piece and the same cut in two are the same surface.
TEST(PlaceByCollision, DoesNotDependOnHowTheProfileIsCut) {
  const std::vector<Vec2> c{{0, 2}, {1.6, 2}, {0.4, 1}, {1.5, 0}};
  const Vec2 a = lerp(c[0], c[1], 0.5), b = lerp(c[1], c[2], 0.5), d = lerp(c[2], c[3], 0.5);
  const Vec2 ab = lerp(a, b, 0.5), bd = lerp(b, d, 0.5), m = lerp(ab, bd, 0.5);
  const std::vector<CollisionOrgan> one = organs_of({.surface = {c, 3}, .radius_mm = 0.05});
  const std::vector<CollisionOrgan> two = organs_of(
      {.surface = SurfaceOfRevolution(bezier_chain<Vec2>({c[0], a, ab, m, bd, d, c[3]}, 3)), .radius_mm = 0.05});
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t n = 0; n < one.size(); ++n) {
    EXPECT_NEAR(one[n].s, two[n].s, 1e-10);
  }
}

TEST(PlaceByCollision, NamesTheFieldAndTheValueOfBadInput) {
  const auto error_of = [](const CollisionParams& params) {
    const Expected<CollisionPattern> pattern = place_by_collision(params, 1000);
    return pattern ? std::string("none") : to_string(pattern.error());
  };
  CollisionParams params{.surface = disc(1.0)};
  params.radius_mm = 0.0;
  EXPECT_EQ(error_of(params), "radius_mm must be finite and > 0, got 0");
  params.radius_mm = std::vector<double>{0.1, 0.1, std::numeric_limits<double>::infinity()};
  EXPECT_EQ(error_of(params), "radius_mm[2] must be finite and > 0, got inf");
  params.radius_mm = RadiusByIndex{[](std::size_t k) { return 0.3 - 0.1 * static_cast<double>(k); }};
  EXPECT_EQ(error_of(params).substr(0, 38), "radius_mm[3] must be finite and > 0, g");
  params.radius_mm = RadiusByIndex{};
  EXPECT_EQ(error_of(params), "radius_mm must be a function, got none");
  params.radius_mm = RadiusAlongProfile{FunctionGraph({{0.0, 0.1}, {1.0, -0.1}})};
  EXPECT_EQ(error_of(params).substr(0, 48), "radius_mm must be > 0 along the whole profile, g");
  params.radius_mm = 0.1;
  params.contact_factor = -1.0;
  EXPECT_EQ(error_of(params), "contact_factor must be finite and > 0, got -1");
  params.contact_factor = 1.0;
  params.divergence_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_of(params), "divergence_deg must be finite, got nan");
  params.divergence_rad = 1.0;
  params.fall_radii = -0.5;
  EXPECT_EQ(error_of(params), "fall_radii must be finite and >= 0, got -0.5");
}

TEST(PlaceByCollision, StopsAtTheLimitAndWhenAsked) {
  const CollisionParams params{.surface = disc(1.0), .radius_mm = 0.05};
  const std::size_t all = organs_of(params).size();
  EXPECT_TRUE(place_by_collision(params, all).has_value());
  const Expected<CollisionPattern> fewer = place_by_collision(params, all - 1);
  ASSERT_FALSE(fewer.has_value());
  EXPECT_EQ(fewer.error().code, ErrorCode::kTooLarge);
  const Expected<CollisionPattern> cancelled =
      place_by_collision(params, all, [](std::string_view, double) { return false; });
  ASSERT_FALSE(cancelled.has_value());
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
}

std::vector<PatternWarning> warnings_of(const CollisionParams& params) {
  const Expected<CollisionPattern> pattern = place_by_collision(params, 1'000'000);
  EXPECT_TRUE(pattern.has_value());
  return pattern ? judge_pattern(params, *pattern).warnings : std::vector<PatternWarning>{};
}

TEST(JudgePattern, FindsNothingWrongWithASphereADiscACylinderAndAGentleCone) {
  for (const double radius_mm : {0.2, 0.1, 0.05, 0.02, 0.01}) {
    for (const SurfaceOfRevolution& surface :
         {sphere(1.0), disc(1.0), cylinder(1.0, 3.0), SurfaceOfRevolution({{0.0, 0.3}, {1.0, 0.0}}, 1)}) {
      const std::vector<PatternWarning> warnings = warnings_of({.surface = surface, .radius_mm = radius_mm});
      for (const PatternWarning& w : warnings) {
        ADD_FAILURE() << flaw_name(w.flaw) << " " << w.measure << " at " << w.s_from << " to " << w.s_to << ", radius "
                      << radius_mm;
      }
    }
  }
}

TEST(JudgePattern, WarnsOfASharpWaistWhereItIs) {
  // A groove as wide as an organ, at the middle of the profile.
  const SurfaceOfRevolution surface({{1.0, 1.0}, {1.0, 0.06}, {0.75, 0.0}, {1.0, -0.06}, {1.0, -1.0}}, 1);
  const std::vector<PatternWarning> warnings = warnings_of({.surface = surface, .radius_mm = 0.03});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].flaw, PatternFlaw::kCurvature);
  EXPECT_GT(warnings[0].s_from, 0.3);
  EXPECT_LT(warnings[0].s_from, 0.5);
  EXPECT_GT(warnings[0].s_to, 0.5);
  EXPECT_LT(warnings[0].s_to, 0.7);
  EXPECT_GT(warnings[0].measure, warnings[0].threshold);
}

TEST(JudgePattern, WarnsOfATenfoldJumpOfRadiusWhereItIs) {
  CollisionParams params{.surface = cylinder(1.0, 3.0)};
  params.radius_mm = RadiusByIndex{[](std::size_t k) { return k < 400 ? 0.1 : 0.01; }};
  const Expected<CollisionPattern> pattern = place_by_collision(params, 1'000'000);
  ASSERT_TRUE(pattern.has_value());
  const double jump_s = pattern->organs[400].s;
  std::set<PatternFlaw> flaws;
  for (const PatternWarning& w : judge_pattern(params, *pattern).warnings) {
    flaws.insert(w.flaw);
    EXPECT_NEAR(w.s_from, jump_s, 0.2) << flaw_name(w.flaw);
    EXPECT_NEAR(w.s_to, jump_s, 0.2) << flaw_name(w.flaw);
  }
  EXPECT_TRUE(flaws.contains(PatternFlaw::kRadiusRatio));
}

TEST(JudgePattern, WarnsOfTheGapsThatARoundedGoldenAngleLeaves) {
  CollisionParams params{.surface = disc(1.0), .radius_mm = 0.01};
  params.divergence_rad = math::radians(137.5);
  const std::vector<PatternWarning> warnings = warnings_of(params);
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(warnings[0].flaw, PatternFlaw::kGap);
  EXPECT_GT(warnings.back().s_to, 0.9);
}

TEST(JudgePattern, CurvatureOfASphereIsOrganOverSphere) {
  const CollisionParams params{.surface = sphere(2.0), .radius_mm = 0.1};
  const Expected<CollisionPattern> pattern = place_by_collision(params, 100'000);
  ASSERT_TRUE(pattern.has_value());
  const CollisionValidity validity = judge_pattern(params, *pattern);
  for (std::size_t n = 0; n < pattern->organs.size(); ++n) {
    EXPECT_NEAR(validity.organs[n].curvature, 0.05, 0.004) << pattern->organs[n].s;
  }
}

}  // namespace
}  // namespace anthesis
