#include "head_pattern.h"

#include <algorithm>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/collision_model.h"
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

SurfaceOfRevolution surface_of(std::vector<Vec2> controls, bool bezier) {
  if (bezier) {
    return SurfaceOfRevolution(bezier_chain<Vec2>(std::move(controls), 3));
  }
  const int degree = std::min(3, static_cast<int>(controls.size()) - 1);
  return SurfaceOfRevolution(std::move(controls), degree);
}

Expected<MeristemDynamics> grow_meristem(const Head& head, std::size_t limit, const Progress& progress) {
  MeristemDynamicsParams params;
  params.mode = head.rule == PlacementRule::kDivergent     ? MeristemMode::kDivergent
                : head.rule == PlacementRule::kSegregation ? MeristemMode::kSegregation
                                                           : MeristemMode::kCentripetal;
  params.profiles = key_profiles(head);
  params.divergence_rad = math::radians(head.divergence_deg);
  params.interval = head.interval;
  params.meristem_area_mm2 = head.meristem_area_mm2;
  params.meristem_growth = head.meristem_rate.empty() ? GrowthFunction(FunctionGraph(head.meristem_growth))
                                                      : GrowthFunction::from_rate(FunctionGraph(head.meristem_rate));
  params.area_mm2 = FunctionGraph(head.area_mm2);
  params.area_growth = FunctionGraph(head.area_growth);
  params.outer_area_mm2 = head.outer_area_mm2;
  params.outer_growth = FunctionGraph(head.outer_growth);
  params.threshold_area_mm2 = head.threshold_area_mm2;
  return MeristemDynamics::run(std::move(params), limit, progress);
}

FixedPattern fix(const Head& head) {
  FixedPattern pattern;
  pattern.profiles = key_profiles(head);
  pattern.bezier = head.bezier;
  pattern.growth = FunctionGraph(head.growth);
  return pattern;
}

void add_organ(FixedPattern& pattern, const Head& head, double t, double s, double area_mm2) {
  const std::size_t i = pattern.t.size();
  pattern.t.push_back(t);
  pattern.primordia.push_back({static_cast<double>(i) * head.interval,
                               spiral_azimuth_rad(i, math::radians(head.divergence_deg)), area_mm2, s,
                               static_cast<std::int32_t>(i)});
}

Expected<FixedPattern> place_bands(const Head& head, std::size_t limit) {
  FixedPattern pattern = fix(head);
  const SurfaceOfRevolution surface = surface_of(pattern.profiles.back().controls, head.bezier);
  const FunctionGraph area_mm2(head.area_mm2);
  const std::size_t most = head.count > 0 ? static_cast<std::size_t>(head.count) : limit + 1;
  const std::vector<double> places = place_organs(surface, area_mm2, SpiralDirection::kFromBase, most);
  if (places.size() > limit) {
    return unexpected(
        Error{ErrorCode::kTooLarge, "area_mm2", "must give at most " + std::to_string(limit) + " organs, got more"});
  }
  for (const double t : places) {
    const double s = surface.s_from_t(t);
    add_organ(pattern, head, t, s, area_mm2(s));
  }
  return pattern;
}

Expected<FixedPattern> let_collide(const Head& head, std::size_t limit, const Progress& progress) {
  FixedPattern pattern = fix(head);
  CollisionParams params{surface_of(pattern.profiles.back().controls, head.bezier)};
  params.radius_mm = RadiusAlongProfile{FunctionGraph(head.radius_mm)};
  params.divergence_rad = math::radians(head.divergence_deg);
  params.contact_factor = head.contact_factor;
  const auto placed = place_by_collision(params, limit, progress);
  if (!placed) {
    return unexpected(placed.error());
  }
  pattern.warnings = judge_pattern(params, *placed).warnings;
  for (const CollisionOrgan& organ : placed->organs) {
    if (head.count > 0 && pattern.t.size() == static_cast<std::size_t>(head.count)) {
      break;
    }
    add_organ(pattern, head, organ.t, organ.s, math::kPi * organ.radius_mm * organ.radius_mm);
  }
  return pattern;
}

}  // namespace

Expected<HeadPattern> HeadPattern::make(const Head& head, std::size_t limit, const Progress& progress) {
  if (grows_meristem(head.rule)) {
    auto pattern = grow_meristem(head, limit, progress);
    if (!pattern) {
      return unexpected(pattern.error());
    }
    return HeadPattern(std::move(*pattern));
  }
  auto pattern = head.rule == PlacementRule::kRidley ? place_bands(head, limit) : let_collide(head, limit, progress);
  if (!pattern) {
    return unexpected(pattern.error());
  }
  return HeadPattern(std::move(*pattern));
}

std::span<const Primordium> HeadPattern::primordia() const {
  if (const auto* growing = std::get_if<MeristemDynamics>(&pattern_)) {
    return growing->primordia();
  }
  return std::get<FixedPattern>(pattern_).primordia;
}

std::span<const PatternWarning> HeadPattern::warnings() const {
  const auto* fixed = std::get_if<FixedPattern>(&pattern_);
  return fixed == nullptr ? std::span<const PatternWarning>() : fixed->warnings;
}

SurfaceOfRevolution HeadPattern::surface(double time) const {
  if (const auto* growing = std::get_if<MeristemDynamics>(&pattern_)) {
    return growing->surface(time);
  }
  const auto& fixed = std::get<FixedPattern>(pattern_);
  std::vector<Vec2> controls = profile_at(fixed.profiles, time);
  const double factor = fixed.growth(time);
  for (Vec2& control : controls) {
    control = factor * control;
  }
  return surface_of(std::move(controls), fixed.bezier);
}

std::vector<PrimordiumPlace> HeadPattern::places(double time, const SurfaceOfRevolution& surface) const {
  if (const auto* growing = std::get_if<MeristemDynamics>(&pattern_)) {
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
