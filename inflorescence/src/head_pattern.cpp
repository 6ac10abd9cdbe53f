#include "head_pattern.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/ridley.h"

namespace anthesis {
namespace {

std::vector<KeyProfile> key_profiles(const Head& head) {
  std::vector<KeyProfile> profiles;
  for (const ReceptacleProfile& profile : head.receptacle) {
    profiles.push_back({profile.time, profile.points});
  }
  return profiles;
}

SurfaceOfRevolution surface_of(std::vector<Vec2> controls) {
  const int degree = std::min(3, static_cast<int>(controls.size()) - 1);
  return SurfaceOfRevolution(std::move(controls), degree);
}

double azimuth_of(std::size_t k, double divergence_rad) {
  const double turns = static_cast<double>(k) * (divergence_rad / math::kTurnRad);
  const double azimuth = (turns - std::floor(turns)) * math::kTurnRad;
  return azimuth < math::kTurnRad ? azimuth : 0.0;
}

Expected<Fractionation> fractionate(const Head& head, std::size_t limit, const Progress& progress) {
  FractionationParams params;
  params.profiles = key_profiles(head);
  params.divergence_rad = math::radians(head.divergence_deg);
  params.interval = head.interval;
  params.meristem_area_mm2 = head.meristem_area_mm2;
  params.meristem_growth = FunctionGraph(head.meristem_growth);
  params.area_mm2 = FunctionGraph(head.area_mm2);
  params.area_growth = FunctionGraph(head.area_growth);
  return Fractionation::run(std::move(params), limit, progress);
}

FixedPattern fix(const Head& head) {
  FixedPattern pattern;
  pattern.profiles = key_profiles(head);
  pattern.growth = FunctionGraph(head.growth);
  return pattern;
}

Expected<FixedPattern> place_bands(const Head& head, std::size_t limit) {
  FixedPattern pattern = fix(head);
  const SurfaceOfRevolution surface = surface_of(pattern.profiles.back().controls);
  const FunctionGraph area_mm2(head.area_mm2);
  const std::size_t most = head.count > 0 ? static_cast<std::size_t>(head.count) : limit + 1;
  pattern.t = place_organs(surface, area_mm2, SpiralDirection::kFromBase, most);
  if (pattern.t.size() > limit) {
    return unexpected(
        Error{ErrorCode::kTooLarge, "area_mm2", "must give at most " + std::to_string(limit) + " organs, got more"});
  }
  for (std::size_t i = 0; i < pattern.t.size(); ++i) {
    const double s = surface.s_from_t(pattern.t[i]);
    pattern.primordia.push_back(
        {static_cast<double>(i) * head.interval, azimuth_of(i, math::radians(head.divergence_deg)), area_mm2(s), s});
  }
  return pattern;
}

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

}  // namespace

Expected<HeadPattern> HeadPattern::make(const Head& head, std::size_t limit, const Progress& progress) {
  if (head.rule == PlacementRule::kCentripetal) {
    auto pattern = fractionate(head, limit, progress);
    if (!pattern) {
      return unexpected(pattern.error());
    }
    return HeadPattern(std::move(*pattern));
  }
  auto pattern = place_bands(head, limit);
  if (!pattern) {
    return unexpected(pattern.error());
  }
  return HeadPattern(std::move(*pattern));
}

std::span<const Primordium> HeadPattern::primordia() const {
  if (const auto* growing = std::get_if<Fractionation>(&pattern_)) {
    return growing->primordia();
  }
  return std::get<FixedPattern>(pattern_).primordia;
}

SurfaceOfRevolution HeadPattern::surface(double time) const {
  if (const auto* growing = std::get_if<Fractionation>(&pattern_)) {
    return growing->surface(time);
  }
  const auto& fixed = std::get<FixedPattern>(pattern_);
  std::vector<Vec2> controls = profile_at(fixed.profiles, time);
  const double factor = fixed.growth(time);
  for (Vec2& control : controls) {
    control = factor * control;
  }
  return surface_of(std::move(controls));
}

std::vector<PrimordiumPlace> HeadPattern::places(double time, const SurfaceOfRevolution& surface) const {
  if (const auto* growing = std::get_if<Fractionation>(&pattern_)) {
    return growing->places(time, surface);
  }
  const auto& fixed = std::get<FixedPattern>(pattern_);
  const double factor = fixed.growth(time);
  std::vector<PrimordiumPlace> places;
  for (std::size_t i = 0; i < fixed.primordia.size() && fixed.primordia[i].birth <= time; ++i) {
    places.push_back({fixed.t[i], fixed.primordia[i].mature_area_mm2 * factor * factor});
  }
  return places;
}

}  // namespace anthesis
