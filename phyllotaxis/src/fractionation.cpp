#include "anthesis/phyllotaxis/fractionation.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

int degree_for(std::size_t points) {
  return std::min(3, static_cast<int>(points) - 1);
}

/// Azimuth k * divergence in [0, 2 pi), computed as a product so that it does not inherit rounding.
double azimuth_of(std::size_t k, double divergence_rad) {
  const double turns = static_cast<double>(k) * (divergence_rad / math::kTurnRad);
  const double azimuth = (turns - std::floor(turns)) * math::kTurnRad;
  return azimuth < math::kTurnRad ? azimuth : 0.0;
}

}  // namespace

std::optional<Error> check(const FractionationParams& params) {
  if (params.profiles.empty()) {
    return invalid_parameter("receptacle", "must have at least 1 profile", 0.0);
  }
  for (std::size_t i = 0; i < params.profiles.size(); ++i) {
    const KeyProfile& profile = params.profiles[i];
    const std::string where = "receptacle[" + std::to_string(i) + "]";
    if (auto error = check_profile(where + ".points", profile.controls)) {
      return error;
    }
    if (!std::isfinite(profile.time) || (i > 0 && profile.time <= params.profiles[i - 1].time)) {
      return invalid_parameter(where + ".time", "must be finite and later than the profile before", profile.time);
    }
    if (profile.controls.size() != params.profiles[0].controls.size()) {
      return invalid_parameter(where + ".points", "must be as many as in the first profile",
                               static_cast<double>(profile.controls.size()));
    }
  }
  if (!std::isfinite(params.divergence_rad)) {
    return invalid_parameter("divergence_deg", "must be finite", math::degrees(params.divergence_rad));
  }
  if (!(params.interval > 0.0) || !std::isfinite(params.interval)) {
    return invalid_parameter("interval", "must be finite and > 0", params.interval);
  }
  if (!(params.meristem_area_mm2 > 0.0) || !std::isfinite(params.meristem_area_mm2)) {
    return invalid_parameter("meristem_area_mm2", "must be finite and > 0", params.meristem_area_mm2);
  }
  return std::nullopt;
}

Expected<Fractionation> Fractionation::run(FractionationParams params, std::size_t limit, const Progress& progress) {
  if (auto error = check(params)) {
    return unexpected(*error);
  }
  Fractionation result(std::move(params));
  const FractionationParams& p = result.params_;
  std::vector<Primordium>& primordia = result.primordia_;
  result.taken_.push_back(0.0);

  // The places of birth need the share of the naked region in the whole surface at each birth. All primordia grow by
  // one function of age and ages at births are multiples of the interval, so the function is looked up once for each
  // age.
  std::vector<double> growth_at_age;
  const bool shape_changes = p.profiles.size() > 1;
  std::optional<SurfaceOfRevolution> shape;
  const double start_factor = p.meristem_growth(0.0);
  for (std::size_t i = 0;; ++i) {
    const double birth = static_cast<double>(i) * p.interval;
    if (birth > 1.0) {
      break;
    }
    growth_at_age.push_back(p.area_growth(birth));
    const double factor = p.meristem_growth(birth);
    const double naked = factor * (p.meristem_area_mm2 / start_factor - result.taken_.back());
    double covered = 0.0;
    for (std::size_t j = 0; j < i; ++j) {
      covered += primordia[j].mature_area_mm2 * growth_at_age[i - j];
    }
    if (!shape || shape_changes) {
      std::vector<Vec2> controls = result.profile(birth);
      const int degree = degree_for(controls.size());
      shape.emplace(std::move(controls), degree);
    }
    const double share = std::clamp(naked / (naked + covered), 0.0, 1.0);
    const double s = shape->s_from_t(shape->t_from_area_mm2(share * shape->area_mm2()));
    const double mature = p.area_mm2(s);
    const double taken = mature * growth_at_age.front();
    if (naked < taken) {
      break;  // O16: the process ends when less than one primordium's area is left
    }
    if (primordia.size() == limit) {
      return unexpected(
          Error{ErrorCode::kTooLarge, "interval", "must give at most " + std::to_string(limit) + " organs, got more"});
    }
    if (!report(progress, "pattern", birth)) {
      return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
    }
    primordia.push_back({birth, azimuth_of(i, p.divergence_rad), mature, s});
    result.taken_.push_back(result.taken_.back() + taken / factor);
  }
  return result;
}

std::size_t Fractionation::born(double time) const {
  const auto end = std::upper_bound(primordia_.begin(), primordia_.end(), time,
                                    [](double t, const Primordium& primordium) { return t < primordium.birth; });
  return static_cast<std::size_t>(end - primordia_.begin());
}

double Fractionation::naked_area_mm2(double time) const {
  const double factor = params_.meristem_growth(time);
  return factor * (params_.meristem_area_mm2 / params_.meristem_growth(0.0) - taken_[born(time)]);
}

double Fractionation::area(std::size_t i, double time) const {
  return primordia_[i].mature_area_mm2 * params_.area_growth(time - primordia_[i].birth);
}

std::vector<Vec2> Fractionation::profile(double time) const {
  const auto& keys = params_.profiles;
  const auto later =
      std::upper_bound(keys.begin(), keys.end(), time, [](double t, const KeyProfile& key) { return t < key.time; });
  if (later == keys.begin()) {
    return keys.front().controls;
  }
  if (later == keys.end()) {
    return keys.back().controls;
  }
  const KeyProfile& before = *(later - 1);
  const double share = (time - before.time) / (later->time - before.time);
  std::vector<Vec2> controls(before.controls.size());
  for (std::size_t i = 0; i < controls.size(); ++i) {
    controls[i] = lerp(before.controls[i], later->controls[i], share);
  }
  return controls;
}

SurfaceOfRevolution Fractionation::surface(double time) const {
  double total = std::max(naked_area_mm2(time), 0.0);
  const std::size_t count = born(time);
  for (std::size_t i = 0; i < count; ++i) {
    total += area(i, time);
  }
  std::vector<Vec2> controls = profile(time);
  const int degree = degree_for(controls.size());
  const SurfaceOfRevolution shape(controls, degree);
  const double scale = std::sqrt(total / shape.area_mm2());
  for (Vec2& control : controls) {
    control = scale * control;
  }
  return SurfaceOfRevolution(std::move(controls), degree);
}

std::vector<PrimordiumPlace> Fractionation::places(double time, const SurfaceOfRevolution& surface) const {
  std::vector<PrimordiumPlace> places(born(time));
  double used = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i].area_mm2 = area(i, time);
    places[i].t = surface.t_from_area_mm2(surface.area_mm2() - used - 0.5 * places[i].area_mm2);
    used += places[i].area_mm2;
  }
  return places;
}

}  // namespace anthesis
