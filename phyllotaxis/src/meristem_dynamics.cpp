#include "anthesis/phyllotaxis/meristem_dynamics.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"
#include "growth_table.h"

namespace anthesis {
namespace {

int degree_for(std::size_t points) {
  return std::min(3, static_cast<int>(points) - 1);
}

/// Azimuth index * divergence in [0, 2 pi), computed as a product so that it does not inherit rounding.
double azimuth_of(std::int32_t index, double divergence_rad) {
  const double turns = static_cast<double>(index) * (divergence_rad / math::kTurnRad);
  const double azimuth = (turns - std::floor(turns)) * math::kTurnRad;
  return azimuth < math::kTurnRad ? azimuth : 0.0;
}

bool positive(double value) {
  return value > 0.0 && std::isfinite(value);
}

Error too_many(std::string_view where, std::size_t limit) {
  return {ErrorCode::kTooLarge, std::string(where), "must give at most " + std::to_string(limit) + " organs, got more"};
}

Error cancelled() {
  return {ErrorCode::kCancelled, "", "cancelled"};
}

}  // namespace

std::vector<Vec2> profile_at(std::span<const KeyProfile> keys, double time) {
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

std::optional<Error> check(const MeristemDynamicsParams& params) {
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
  if (params.mode != MeristemMode::kSegregation && !positive(params.interval)) {
    return invalid_parameter("interval", "must be finite and > 0", params.interval);
  }
  if (!positive(params.meristem_area_mm2)) {
    return invalid_parameter("meristem_area_mm2", "must be finite and > 0", params.meristem_area_mm2);
  }
  if (params.mode == MeristemMode::kDivergent && !positive(params.outer_area_mm2)) {
    return invalid_parameter("outer_area_mm2", "must be finite and > 0", params.outer_area_mm2);
  }
  if (params.mode == MeristemMode::kSegregation &&
      !(params.threshold_area_mm2 >= params.meristem_area_mm2 && std::isfinite(params.threshold_area_mm2))) {
    return invalid_parameter("threshold_area_mm2", "must be finite and >= meristem_area_mm2",
                             params.threshold_area_mm2);
  }
  return std::nullopt;
}

Expected<MeristemDynamics> MeristemDynamics::run(MeristemDynamicsParams params, std::size_t limit,
                                                 const Progress& progress) {
  if (auto error = check(params)) {
    return unexpected(*error);
  }
  MeristemDynamics result(std::move(params));
  const bool segregates = result.params_.mode == MeristemMode::kSegregation;
  if (auto error = segregates ? result.segregate(limit, progress) : result.fractionate(limit, progress)) {
    return unexpected(*error);
  }
  return result;
}

std::optional<Error> MeristemDynamics::fractionate(std::size_t limit, const Progress& progress) {
  const MeristemDynamicsParams& p = params_;
  const bool divergent = p.mode == MeristemMode::kDivergent;
  taken_.push_back(0.0);
  outer_taken_.push_back(0.0);

  // Births fall on a grid of ticks, those of the outer front on its odd ones. The places of birth need the shares of
  // the regions in the whole surface at each birth. All primordia grow by one function of age and ages at births are
  // whole ticks, so the function is looked up once for each age.
  const double tick = divergent ? 0.5 * p.interval : p.interval;
  std::vector<std::size_t> tick_of;
  std::vector<double> growth_at_age;
  SurfaceOfRevolution current = shape(0.0);
  bool inner_alive = true;
  bool outer_alive = divergent;
  std::int32_t next_inner = 0;
  std::int32_t next_outer = -1;
  for (std::size_t now = 0; inner_alive || outer_alive; ++now) {
    const double birth = static_cast<double>(now) * tick;
    if (birth > 1.0) {
      break;
    }
    growth_at_age.push_back(p.area_growth(birth));
    const bool outward = divergent && now % 2 == 1;
    if (!(outward ? outer_alive : inner_alive)) {
      continue;
    }
    const double inner = inner_after(primordia_.size(), birth);
    const double outer = outer_after(primordia_.size(), birth);
    double covered = 0.0;
    for (std::size_t j = 0; j < primordia_.size(); ++j) {
      covered += primordia_[j].mature_area_mm2 * growth_at_age[now - tick_of[j]];
    }
    if (p.profiles.size() > 1) {
      current = shape(birth);
    }
    const double above = outward ? inner + covered : inner;
    const double share = std::clamp(above / (inner + covered + outer), 0.0, 1.0);
    const double s = current.s_from_t(current.t_from_area_mm2(share * current.area_mm2()));
    const double mature = p.area_mm2(s);
    const double taken = mature * growth_at_age.front();
    if ((outward ? outer : inner) < taken) {  // O16: the process ends when less than one primordium's area is left
      (outward ? outer_alive : inner_alive) = false;
      continue;
    }
    if (primordia_.size() == limit) {
      return too_many("interval", limit);
    }
    if (!report(progress, "pattern", birth)) {
      return cancelled();
    }
    const std::int32_t index = outward ? next_outer-- : next_inner++;
    primordia_.push_back({birth, azimuth_of(index, p.divergence_rad), mature, s, index});
    tick_of.push_back(now);
    taken_.push_back(taken_.back() + (outward ? 0.0 : taken / p.meristem_growth(birth)));
    outer_taken_.push_back(outer_taken_.back() + (outward ? taken / p.outer_growth(birth) : 0.0));
  }
  return std::nullopt;
}

std::optional<Error> MeristemDynamics::segregate(std::size_t limit, const Progress& progress) {
  const MeristemDynamicsParams& p = params_;
  const double newborn_share = p.area_growth(0.0);
  const GrowthTable growth(p.area_growth);
  SurfaceOfRevolution current = shape(0.0);
  remaining_.push_back(p.meristem_area_mm2);
  double last_birth = 0.0;
  for (;;) {
    const double birth = p.meristem_growth.when(last_birth, p.threshold_area_mm2 / remaining_.back());
    if (!(birth <= 1.0)) {
      break;
    }
    double covered = 0.0;
    for (std::size_t j = 0; j < primordia_.size(); ++j) {
      covered += primordia_[j].mature_area_mm2 * growth(birth - primordia_[j].birth);
    }
    if (p.profiles.size() > 1) {
      current = shape(birth);
    }
    const double share = p.threshold_area_mm2 / (p.threshold_area_mm2 + covered);
    const double s = current.s_from_t(current.t_from_area_mm2(share * current.area_mm2()));
    const double mature = p.area_mm2(s);
    const double newborn = mature * newborn_share;
    if (!(newborn < p.threshold_area_mm2)) {
      return invalid_parameter("threshold_area_mm2", "must be > the area of a newborn primordium, " + to_text(newborn),
                               p.threshold_area_mm2);
    }
    if (primordia_.size() == limit) {
      return too_many("threshold_area_mm2", limit);
    }
    if (!report(progress, "pattern", birth)) {
      return cancelled();
    }
    const auto index = static_cast<std::int32_t>(primordia_.size());
    primordia_.push_back({birth, azimuth_of(index, p.divergence_rad), mature, s, index});
    remaining_.push_back(p.threshold_area_mm2 - newborn);
    last_birth = birth;
  }
  return std::nullopt;
}

std::size_t MeristemDynamics::born(double time) const {
  const auto end = std::upper_bound(primordia_.begin(), primordia_.end(), time,
                                    [](double t, const Primordium& primordium) { return t < primordium.birth; });
  return static_cast<std::size_t>(end - primordia_.begin());
}

double MeristemDynamics::inner_after(std::size_t count, double time) const {
  const MeristemDynamicsParams& p = params_;
  if (p.mode == MeristemMode::kSegregation) {
    const double since = count == 0 ? 0.0 : primordia_[count - 1].birth;
    return remaining_[count] * p.meristem_growth.ratio(since, time);
  }
  return p.meristem_growth(time) * (p.meristem_area_mm2 / p.meristem_growth(0.0) - taken_[count]);
}

double MeristemDynamics::outer_after(std::size_t count, double time) const {
  const MeristemDynamicsParams& p = params_;
  return p.mode == MeristemMode::kDivergent
             ? p.outer_growth(time) * (p.outer_area_mm2 / p.outer_growth(0.0) - outer_taken_[count])
             : 0.0;
}

double MeristemDynamics::naked_area_mm2(double time) const {
  return inner_after(born(time), time);
}

double MeristemDynamics::outer_area_mm2(double time) const {
  return outer_after(born(time), time);
}

double MeristemDynamics::area(std::size_t i, double time) const {
  return primordia_[i].mature_area_mm2 * params_.area_growth(time - primordia_[i].birth);
}

SurfaceOfRevolution MeristemDynamics::shape(double time) const {
  std::vector<Vec2> controls = profile_at(params_.profiles, time);
  const int degree = degree_for(controls.size());
  return SurfaceOfRevolution(std::move(controls), degree);
}

SurfaceOfRevolution MeristemDynamics::surface(double time) const {
  double total = std::max(naked_area_mm2(time), 0.0) + std::max(outer_area_mm2(time), 0.0);
  const std::size_t count = born(time);
  for (std::size_t i = 0; i < count; ++i) {
    total += area(i, time);
  }
  std::vector<Vec2> controls = profile_at(params_.profiles, time);
  const int degree = degree_for(controls.size());
  const SurfaceOfRevolution unscaled(controls, degree);
  const double scale = std::sqrt(total / unscaled.area_mm2());
  for (Vec2& control : controls) {
    control = scale * control;
  }
  return SurfaceOfRevolution(std::move(controls), degree);
}

std::vector<PrimordiumPlace> MeristemDynamics::places(double time, const SurfaceOfRevolution& surface) const {
  std::vector<PrimordiumPlace> places(born(time));
  double used = std::max(outer_area_mm2(time), 0.0);
  const auto place = [&](std::size_t i) {
    places[i].area_mm2 = area(i, time);
    places[i].t = surface.t_from_area_mm2(surface.area_mm2() - used - 0.5 * places[i].area_mm2);
    used += places[i].area_mm2;
  };
  // From the base to the apex: the outer front's primordia with the latest first, then the inner front's as born.
  for (std::size_t i = places.size(); i-- > 0;) {
    if (primordia_[i].index < 0) {
      place(i);
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (primordia_[i].index >= 0) {
      place(i);
    }
  }
  return places;
}

}  // namespace anthesis
