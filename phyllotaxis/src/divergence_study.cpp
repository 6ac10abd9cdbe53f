#include "anthesis/phyllotaxis/divergence_study.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "anthesis/base/assert.h"
#include "anthesis/base/check.h"
#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/phyllotaxis/collision_model.h"
#include "anthesis/phyllotaxis/contact_pressure.h"
#include "anthesis/phyllotaxis/inhibition.h"
#include "conformal_profile.h"

namespace anthesis {
namespace {

constexpr double kFirstRise = 0.5;  // organs in two rows by every model
constexpr std::size_t kMeasured = 120;
constexpr std::size_t kFewest = 8;
constexpr std::size_t kCollisionLimit = 200000;

/// The part of the surface that is looked at: nearer to the axis than this share of the base's radius, organs that are
/// to be as small as their place would need no end of them.
constexpr double kThinnest = 1e-4;

std::vector<Vec2> profile_of(const DivergenceStudyParams& params, double size) {
  if (!params.profile_mm.empty()) {
    return params.profile_mm;
  }
  // A cylinder of radius 1, high enough for some hundred organs of any size.
  const double circumferences = 2.0 + 100.0 * size * size;
  return {{1.0, circumferences * math::kTurnRad}, {1.0, 0.0}};
}

int degree_of(const std::vector<Vec2>& profile) {
  return std::min(3, static_cast<int>(profile.size()) - 1);
}

/// The least s from which on the radius is at least kThinnest of the base's.
double first_s(const SurfaceOfRevolution& surface) {
  const double thinnest = kThinnest * surface.radius_mm(1.0);
  double low = 1.0;
  constexpr int kLooks = 4096;
  for (int i = kLooks; i >= 0; --i) {
    const double share = static_cast<double>(i) / kLooks;
    const double s = share * share * share * share;
    if (surface.radius_mm(surface.t_from_s(s)) < thinnest) {
      break;
    }
    low = s;
  }
  return low;
}

/// Places below, near and above, in conformal coordinates: what of them is measured.
DivergenceResult measured(StudyModel model, double size, std::span<const Vec2> places, std::size_t first,
                          std::size_t last) {
  DivergenceResult result;
  result.model = model;
  result.size = size;
  if (last < first + kFewest) {
    return result;
  }
  result.pattern = measure_pattern(places, first, last);
  result.rise = std::abs(places[last - 1].y - places[first].y) / static_cast<double>(last - 1 - first);
  result.measured = result.pattern.n > 0;
  return result;
}

int steps_to(double rise, double births_per_fold) {
  const double folds = math::log(kFirstRise / rise);
  return 1 + static_cast<int>(std::ceil(std::max(0.0, folds) * births_per_fold));
}

DivergenceResult by_contact_pressure(const DivergenceStudyParams& params, double size) {
  const double rise = fibonacci_lattice(0.5 * size).lattice.rise;
  const Expected<std::vector<PressedLattice>> history =
      contact_pressure({.first_divergence_rad = params.first_divergence_rad,
                        .first_rise = kFirstRise,
                        .last_rise = rise,
                        .steps = 1 + steps_to(rise, params.births_per_fold)});
  DivergenceResult result;
  result.model = StudyModel::kContactPressure;
  result.size = size;
  if (history) {
    const PressedLattice& last = history->back();
    result.rise = last.rise;
    result.measured = true;
    // Read off the lattice, not counted: there is no pattern of organs.
    result.pattern = {.divergence_rad = last.divergence_rad,
                      .deviation_rad = 0.0,
                      .m = last.m,
                      .n = last.n,
                      .agreement = 1.0,
                      .distance = last.distance};
  }
  return result;
}

DivergenceResult by_collision(const DivergenceStudyParams& params, double size) {
  const std::vector<Vec2> profile = profile_of(params, size);
  const SurfaceOfRevolution surface(profile, degree_of(profile));
  const double start = first_s(surface);
  const detail::ConformalProfile conformal(surface, start);

  // Radii in proportion to the surface's, so that organs have the same size all over it.
  std::vector<Vec2> radii;
  constexpr int kPoints = 257;
  const double share = size * math::kPi;
  const double thinnest = kThinnest * surface.radius_mm(1.0);
  for (int i = 0; i < kPoints; ++i) {
    const double s = static_cast<double>(i) / (kPoints - 1);
    radii.push_back({s, share * std::max(thinnest, surface.radius_mm(surface.t_from_s(s)))});
  }
  const auto [least, most] = std::minmax_element(radii.begin(), radii.end(), [](Vec2 a, Vec2 b) { return a.y < b.y; });
  CollisionParams collision{.surface = surface, .divergence_rad = params.collision_divergence_rad};
  if (most->y - least->y <= 1e-12 * most->y) {
    collision.radius_mm = most->y;
  } else {
    collision.radius_mm = RadiusAlongProfile{FunctionGraph(radii)};
  }
  const Expected<CollisionPattern> pattern = place_by_collision(collision, kCollisionLimit);
  DivergenceResult result;
  result.model = StudyModel::kCollision;
  result.size = size;
  if (!pattern) {
    return result;
  }
  std::vector<Vec2> places;
  for (const CollisionOrgan& organ : pattern->organs) {
    if (organ.s < start) {
      break;
    }
    places.push_back({organ.azimuth_rad / math::kTurnRad, -conformal.u_at(organ.s) / math::kTurnRad});
  }
  // Not the uppermost, which lack neighbours, nor the lower half, which remembers the ring at the base.
  const std::size_t edge = static_cast<std::size_t>(result.size > 0.0 ? std::ceil(1.0 / result.size) : 0.0);
  const std::size_t last = places.size() > edge ? places.size() - edge : 0;
  const std::size_t first = std::max(places.size() / 2, last > kMeasured ? last - kMeasured : 0);
  return measured(StudyModel::kCollision, size, places, std::min(first, last), last);
}

DivergenceResult by_inhibition(const DivergenceStudyParams& params, double size) {
  const double rise = fibonacci_lattice(0.5 * size).lattice.rise;
  InhibitionParams inhibition;
  inhibition.exponent = params.inhibition_exponent;
  inhibition.transport = RingTransport::kCylinder;
  if (!params.profile_mm.empty()) {
    const SurfaceOfRevolution surface(params.profile_mm, degree_of(params.profile_mm));
    inhibition.transport = RingTransport::kSurface;
    inhibition.profile = params.profile_mm;
    inhibition.ring_s = std::max(first_s(surface), 1e-6);
  }
  inhibition.period = {math::kTurnRad * kFirstRise, math::kTurnRad * rise};
  inhibition.ramp = static_cast<std::size_t>(steps_to(rise, params.births_per_fold));
  inhibition.count = inhibition.ramp + 60 + kMeasured;  // some births to come to rest
  inhibition.horizon = 4.0;  // at 1 / d^3 organs beyond move the minimum by less than a thousandth of a degree
  const Expected<std::vector<RingBirth>> births = grow_by_inhibition(inhibition);
  DivergenceResult result;
  result.model = StudyModel::kInhibition;
  result.size = size;
  if (!births) {
    return result;
  }
  const std::vector<Vec2> places = unrolled_births(RingTrack(inhibition), *births);
  return measured(StudyModel::kInhibition, size, places, places.size() - kMeasured, places.size());
}

}  // namespace

const char* model_name(StudyModel model) {
  switch (model) {
    case StudyModel::kContactPressure:
      return "contact pressure";
    case StudyModel::kCollision:
      return "collision";
    case StudyModel::kInhibition:
      break;
  }
  return "inhibition";
}

std::vector<double> DivergenceStudyParams::study_sizes(double smallest, double largest, std::size_t count) {
  ANTHESIS_ASSERT(smallest > 0.0 && smallest <= largest && count >= 2);
  std::vector<double> sizes;
  const double folds = math::log(largest / smallest);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    sizes.push_back(std::min(largest, smallest * math::exp(share * folds)));
  }
  return sizes;
}

std::optional<Error> check(const DivergenceStudyParams& params) {
  if (params.sizes.empty() || params.sizes.size() > 1000) {
    return invalid_parameter("sizes", "must be 1 to 1000", static_cast<double>(params.sizes.size()));
  }
  for (const double size : params.sizes) {
    if (auto error = check_number("sizes", size, 0.02, 0.5)) {
      return error;
    }
  }
  if (!params.profile_mm.empty()) {
    if (auto error = check_profile("profile_mm", params.profile_mm)) {
      return error;
    }
    if (!(params.profile_mm.back().x > 0.0)) {
      return invalid_parameter("profile_mm", "must have a base of radius > 0", params.profile_mm.back().x);
    }
  }
  for (const auto& [name, angle] : {std::pair{"collision_divergence_rad", params.collision_divergence_rad},
                                    std::pair{"first_divergence_rad", params.first_divergence_rad}}) {
    if (!std::isfinite(angle)) {
      return invalid_parameter(name, "must be finite", angle);
    }
  }
  if (auto error = check_whole("inhibition_exponent", params.inhibition_exponent, 1, 12)) {
    return error;
  }
  return check_number("births_per_fold", params.births_per_fold, 5.0, 1000.0);
}

Expected<DivergenceStudy> study_divergence(const DivergenceStudyParams& params, const Progress& progress) {
  if (auto error = check(params)) {
    return unexpected(*error);
  }
  DivergenceStudy study;
  const std::size_t sizes = params.sizes.size();
  study.results.resize(kStudyModels * sizes);
  const auto run = [&](std::size_t i) {
    // The slowest, inhibition at small sizes, come first in every list that is smallest first.
    const std::size_t model = kStudyModels - 1 - i / sizes;
    const std::size_t at = i % sizes;
    const double size = params.sizes[at];
    DivergenceResult& result = study.results[model * sizes + at];
    switch (static_cast<StudyModel>(model)) {
      case StudyModel::kContactPressure:
        result = by_contact_pressure(params, size);
        break;
      case StudyModel::kCollision:
        result = by_collision(params, size);
        break;
      case StudyModel::kInhibition:
        result = by_inhibition(params, size);
        break;
    }
  };
  if (!parallel_for(study.results.size(), run, progress, "divergence study")) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  const double smallest = *std::min_element(params.sizes.begin(), params.sizes.end());
  Expected<std::vector<LatticeArc>> arcs = van_iterson_diagram({.least_radius = 0.45 * smallest});
  if (!arcs) {
    return unexpected(arcs.error());
  }
  study.arcs = std::move(*arcs);
  return study;
}

}  // namespace anthesis
