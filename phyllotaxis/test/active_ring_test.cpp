#include "anthesis/phyllotaxis/active_ring.h"

#include <gmock/gmock.h>

#include <cmath>

#include "full_scan.h"
#include "growing_dome.h"

namespace anthesis {
namespace {

using test::dome_params;
using test::GrowingDome;

double between(double a, double b) {
  const double apart = std::abs(a - b);
  return std::min(apart, math::kTurnRad - apart);
}

std::vector<RingPrimordium> grown(const ActiveRingParams& params) {
  auto primordia = grow_active_ring(GrowingDome(), params);
  EXPECT_TRUE(primordia.has_value()) << to_string(primordia.error());
  return primordia ? *primordia : std::vector<RingPrimordium>();
}

/// The model's distance on the ring at the birth of `one`, from it to a primordium at `azimuth` on material line u.
double distance(const RingPrimordium& one, double azimuth, double u) {
  const GrowingDome dome;
  const double time = one.born.time;
  const double across =
      0.5 * (dome.radius(time, one.born.s) + dome.radius(time, u)) * between(one.born.azimuth_rad, azimuth);
  return std::hypot(across, dome.length(time) * (one.born.s - u));
}

TEST(ActiveRing, SecondPrimordiumFacesTheFirstAsSoonAsHalfARoundIsLongEnough) {
  const std::vector<RingPrimordium> primordia = grown(dome_params());
  ASSERT_GT(primordia.size(), 100u);
  EXPECT_EQ(primordia[0].born.time, 0.0);
  EXPECT_EQ(primordia[0].born.azimuth_rad, math::kPi);
  EXPECT_NEAR(between(primordia[1].born.azimuth_rad, math::kPi), math::kPi, 1e-9);
  EXPECT_NEAR(distance(primordia[1], math::kPi, primordia[0].material), primordia[1].threshold, 1e-9);
  EXPECT_THAT(primordia[1].neighbours, testing::ElementsAre(0u, 0u));
}

/// Where a primordium appears the ring has just become free: it touches two others and overlaps none.
TEST(ActiveRing, PrimordiaTouchTheirNeighboursAtBirthAndOverlapNoOther) {
  const std::vector<RingPrimordium> primordia = grown(dome_params());
  for (std::size_t i = 2; i < primordia.size(); ++i) {
    const RingPrimordium& one = primordia[i];
    EXPECT_EQ(one.threshold, dome_params().threshold(one.born.time));
    for (const std::uint32_t neighbour : one.neighbours) {
      const RingPrimordium& other = primordia[neighbour];
      EXPECT_LE(other.stable.time, one.born.time);  // birth of a younger neighbour ends its movement
      EXPECT_NEAR(distance(one, other.stable.azimuth_rad, other.material), one.threshold, 1e-8) << i;
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (primordia[k].stable.time <= one.born.time) {
        EXPECT_GE(distance(one, primordia[k].stable.azimuth_rad, primordia[k].material), one.threshold - 1e-8);
      }
    }
  }
}

TEST(ActiveRing, PrimordiaAreBornOnTheRingInOrder) {
  const std::vector<RingPrimordium> primordia = grown(dome_params());
  double before = 0.0;
  for (const RingPrimordium& one : primordia) {
    EXPECT_GE(one.born.time, before);
    EXPECT_EQ(one.born.s, GrowingDome().ring(one.born.time));
    EXPECT_GT(one.born.s, dome_params().last_ring - 1e-12);
    EXPECT_EQ(one.stable.azimuth_rad, one.last.azimuth_rad);
    before = one.born.time;
  }
}

TEST(ActiveRing, AnswerDoesNotDependOnTheTimeStep) {
  ActiveRingParams params = dome_params();
  const std::vector<RingPrimordium> usual = grown(params);
  for (const double step : {0.1, 0.01, 0.0002}) {
    params.time_step = step;
    const std::vector<RingPrimordium> other = grown(params);
    ASSERT_EQ(other.size(), usual.size()) << step;
    for (std::size_t i = 0; i < usual.size(); ++i) {
      EXPECT_NEAR(other[i].born.time, usual[i].born.time, 1e-7) << i;
      EXPECT_LT(between(other[i].last.azimuth_rad, usual[i].last.azimuth_rad), 1e-5) << i;
    }
  }
}

TEST(ActiveRing, TurningTheFirstPrimordiumTurnsThePattern) {
  ActiveRingParams params = dome_params();
  const std::vector<RingPrimordium> usual = grown(params);
  params.first_azimuth_rad = 1.0;
  const std::vector<RingPrimordium> turned = grown(params);
  ASSERT_EQ(turned.size(), usual.size());
  for (std::size_t i = 0; i < usual.size(); ++i) {
    EXPECT_LT(
        between(std::fmod(turned[i].last.azimuth_rad + math::kPi - 1.0, math::kTurnRad), usual[i].last.azimuth_rad),
        1e-6);
  }
}

TEST(ActiveRing, WithoutRelaxationNothingMovesSideways) {
  ActiveRingParams params = dome_params();
  params.relaxation = 0.0;
  for (const RingPrimordium& one : grown(params)) {
    EXPECT_EQ(one.born.azimuth_rad, one.last.azimuth_rad);
  }
}

/// Sideways movement brings a young primordium nearer to the distance D from its older neighbour.
TEST(ActiveRing, RelaxationBringsPrimordiaNearerToTheThreshold) {
  ActiveRingParams params = dome_params();
  const auto misfit = [&](double relaxation) {
    params.relaxation = relaxation;
    double sum = 0.0;
    const std::vector<RingPrimordium> primordia = grown(params);
    for (std::size_t i = 2; i < 60; ++i) {
      const RingPrimordium& one = primordia[i];
      const RingPrimordium& older = primordia[std::min(one.neighbours[0], one.neighbours[1])];
      RingPrimordium then = one;
      then.born = one.stable;
      sum += std::abs(distance(then, older.last.azimuth_rad, older.material) / params.threshold(then.born.time) - 1.0);
    }
    return sum;
  };
  EXPECT_LT(misfit(45.0), 0.8 * misfit(0.0));
}

TEST(ActiveRing, AFrozenThresholdStaysWhatItWas) {
  ActiveRingParams params = dome_params();
  params.threshold_frozen_above = 10;
  const std::vector<RingPrimordium> primordia = grown(params);
  ASSERT_GT(primordia.size(), 12u);
  EXPECT_GT(primordia[9].threshold, primordia[10].threshold);
  for (std::size_t i = 11; i < primordia.size(); ++i) {
    EXPECT_EQ(primordia[i].threshold, primordia[10].threshold);
  }
}

/// Where the threshold jumps, gaps have a width at once and the ring may even be free all round.
TEST(ActiveRing, AThresholdThatJumpsFillsTheRing) {
  ActiveRingParams params = dome_params();
  params.relaxation = 0.0;
  params.threshold = [](double time) { return time < 0.5 ? 100.0 : 0.4; };
  const std::vector<RingPrimordium> primordia = grown(params);
  std::size_t at_once = 0;
  for (const RingPrimordium& one : primordia) {
    at_once += std::abs(one.born.time - 0.5) < 1e-6 ? 1 : 0;
  }
  const double round = math::kTurnRad * GrowingDome().radius(0.5, GrowingDome().ring(0.5));
  EXPECT_GE(static_cast<double>(at_once), std::floor(round / 0.4) - 1.0);
  EXPECT_LE(static_cast<double>(at_once), round / 0.4);
}

TEST(ActiveRing, KindsFollowTheLandmarks) {
  const GrowingDome dome;
  const ActiveRingParams params = dome_params();
  EXPECT_EQ(kind_of(dome, params, 0.5, 0.7), PrimordiumKind::kBract);
  EXPECT_EQ(kind_of(dome, params, 0.5, 0.6), PrimordiumKind::kTransFloret);
  EXPECT_EQ(kind_of(dome, params, 0.5, 0.3), PrimordiumKind::kFloret);
  EXPECT_EQ(kind_of(dome, ActiveRingParams{}, 0.5, 0.7), PrimordiumKind::kFloret);
  const std::vector<RingPrimordium> primordia = grown(params);
  EXPECT_EQ(primordia.front().last.kind, PrimordiumKind::kBract);
  EXPECT_EQ(primordia.back().last.kind, PrimordiumKind::kFloret);
}

TEST(PublishedActiveRing, JumpingOverForbiddenAnglesGivesTheFullScan) {
  ActiveRingParams params = dome_params();
  params.time_step = 0.004;  // several primordia a step
  params.angular_step_rad = 0.01;
  params.threshold_frozen_above = 60;
  const auto primordia = grow_active_ring_as_published(GrowingDome(), params);
  ASSERT_TRUE(primordia.has_value());
  const std::vector<test::ScannedPrimordium> scanned = test::full_scan(GrowingDome(), params);
  ASSERT_GT(scanned.size(), 90u);
  ASSERT_EQ(primordia->size(), scanned.size());
  for (std::size_t i = 0; i < scanned.size(); ++i) {
    EXPECT_EQ((*primordia)[i].born.step, scanned[i].born) << i;
    EXPECT_EQ((*primordia)[i].born.azimuth_rad, scanned[i].born_azimuth) << i;
    EXPECT_NEAR((*primordia)[i].last.azimuth_rad, scanned[i].azimuth, 1e-12) << i;
  }
}

TEST(PublishedActiveRing, ApproachesTheContinuousModelAsItsStepsShrink) {
  ActiveRingParams params = dome_params();
  const std::vector<RingPrimordium> exact = grown(params);
  const auto error = [&](double step) {
    params.time_step = step;
    params.angular_step_rad = step;
    const auto primordia = grow_active_ring_as_published(GrowingDome(), params);
    double worst = 0.0;
    for (std::size_t i = 0; i < 12; ++i) {
      worst = std::max(worst, std::abs((*primordia)[i].born.time - exact[i].born.time));
    }
    return worst;
  };
  const double coarse = error(0.002);
  EXPECT_LT(error(0.0002), 0.2 * coarse);
  EXPECT_LT(coarse, 0.02);
}

TEST(PublishedActiveRing, ClockSlowsDownNearTheApex) {
  const std::vector<double> clock = published_clock(GrowingDome(), 0.01);
  EXPECT_EQ(clock[0], 0.0);
  EXPECT_NEAR(clock[50], 0.5, 1e-12);
  EXPECT_EQ(clock.back(), 1.0);
  // The ring passes 0.01 at time 0.98889, so step 99, to 0.99, is the last whole one.
  EXPECT_NEAR(clock[100] - clock[99], 0.00993, 1e-12);
}

TEST(ActiveRing, SaysWhatIsWrong) {
  const GrowingDome dome;
  const auto message = [&](const ActiveRingParams& params, bool published = false) {
    const auto answer = published ? grow_active_ring_as_published(dome, params) : grow_active_ring(dome, params);
    return answer ? std::string("no error") : to_string(answer.error());
  };
  EXPECT_EQ(message({}), "threshold must be a function, got none");
  ActiveRingParams params = dome_params();
  params.time_step = 0.0;
  EXPECT_THAT(message(params), testing::HasSubstr("time_step must be between"));
  params = dome_params();
  params.trans_landmark = 3;
  EXPECT_EQ(message(params), "trans_landmark must be one of the profile's 2, got 3");
  for (const bool published : {false, true}) {
    params = dome_params();
    params.threshold = [](double time) { return time < 0.2 ? 3.0 : std::nan(""); };
    EXPECT_THAT(message(params, published), testing::HasSubstr("threshold must be > 0"));
    params = dome_params();
    params.most_primordia = 20;
    EXPECT_EQ(message(params, published), "threshold must not let more primordia appear than 20");
  }
}

TEST(ActiveRing, RefusesThresholdsFarSmallerThanItsRing) {
  ActiveRingParams params = dome_params();
  params.threshold = [](double) { return 1e-6; };
  for (auto* grow : {grow_active_ring, grow_active_ring_as_published}) {
    const auto grown = grow(GrowingDome(), params, {});
    ASSERT_FALSE(grown.has_value());
    EXPECT_EQ(grown.error().where, "threshold");
  }
}

TEST(ActiveRing, StopsWhenItIsAskedTo) {
  const ActiveRingParams params = dome_params();
  for (auto* grow : {grow_active_ring, grow_active_ring_as_published}) {
    const auto grown = grow(GrowingDome(), params, [](std::string_view, double) { return false; });
    ASSERT_FALSE(grown.has_value());
    EXPECT_EQ(grown.error().code, ErrorCode::kCancelled);
  }
}

}  // namespace
}  // namespace anthesis
