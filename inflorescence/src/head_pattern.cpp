#include "head_pattern.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anthesis/base/math.h"
#include "anthesis/inflorescence/head_interior.h"
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

/// How far apart tissue at an organ's place has grown at a time, along and across, times each other.
double stretch_at(const RingPattern& pattern, std::size_t i, double time) {
  constexpr double kStep = 1e-3;
  const double u = pattern.ring[i].material;
  const double inner = pattern.head.s_from_material(time, std::max(u - kStep, 0.0));
  const double outer = pattern.head.s_from_material(time, std::min(u + kStep, 1.0));
  const double radius = pattern.head.radius(time, pattern.head.s_from_material(time, u));
  return (outer - inner) * pattern.head.length(time) * radius;
}

/// The area of an organ's place, which is stretched with the tissue.
double area_on_ring(const RingPattern& pattern, std::size_t i, double time) {
  const double mature = stretch_at(pattern, i, 1.0);
  const double area = pattern.primordia[i].mature_area_mm2;
  return time < 1.0 && mature > 0.0 ? area * stretch_at(pattern, i, time) / mature : area;
}

/// The cells of the mature head: each as large as if all stood as close as an organ's nearest neighbour.
std::vector<double> mature_areas(const RingPattern& pattern) {
  struct Place {
    double along = 0.0;
    Vec3 position;
    std::size_t organ = 0;
  };
  const GrownProfile mature = pattern.head.at(1.0);
  std::vector<Place> places;
  for (std::size_t i = 0; i < pattern.ring.size(); ++i) {
    const double s = pattern.head.s_from_material(1.0, pattern.ring[i].material);
    const Vec2 point = mature.point(s);
    const auto [sine, cosine] = math::sin_cos(pattern.ring[i].stable.azimuth_rad);
    places.push_back({s * mature.length(), {point.x * cosine, point.x * sine, point.y}, i});
  }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.along != b.along ? a.along < b.along : a.organ < b.organ; });
  constexpr double kLeastChord = 0.5;  // of the way along: receptacles have no hairpins as narrow as their organs
  std::vector<double> areas(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const int direction : {-1, 1}) {
      for (std::size_t other = k + direction; other < places.size(); other += direction) {
        if (kLeastChord * std::abs(places[other].along - places[k].along) >= nearest) {
          break;
        }
        nearest = std::min(nearest, length(places[other].position - places[k].position));
      }
    }
    if (std::isinf(nearest)) {  // alone
      nearest = mature.length();
    }
    areas[places[k].organ] = 0.5 * std::sqrt(3.0) * nearest * nearest;
  }
  return areas;
}

Expected<RingPattern> follow_ring(const Head& head, std::size_t limit, const Progress& progress) {
  ANTHESIS_ASSERT(head.active_ring.has_value());
  ActiveRingParams params = active_ring_params(*head.active_ring);
  params.most_primordia = std::min(params.most_primordia, limit);
  RingPattern pattern{GrowingReceptacle(digitised_head(*head.active_ring)), {}, {}, {}};
  auto grown = grow_active_ring(pattern.head, params, progress);
  if (!grown) {
    return unexpected(error_of_ring(grown.error(), "active_ring"));
  }
  pattern.ring = std::move(*grown);
  const std::vector<double> areas = mature_areas(pattern);
  for (std::size_t i = 0; i < pattern.ring.size(); ++i) {
    const RingPrimordium& one = pattern.ring[i];
    pattern.primordia.push_back(
        {one.born.time, one.stable.azimuth_rad, areas[i], one.born.s, static_cast<std::int32_t>(i)});
    pattern.kinds.push_back(one.stable.kind);
  }
  return pattern;
}

constexpr int kSurfacePoints = 65;
constexpr int kSurfaceDegree = 3;

/// The blended section as one spline, whose parameter is s.
SurfaceOfRevolution surface_of(const GrownProfile& profile) {
  std::vector<Vec2> points;
  for (const double s : greville_places(kSurfacePoints, kSurfaceDegree)) {
    points.push_back(profile.point(s));
  }
  points = interpolating_controls(std::move(points), kSurfaceDegree);
  for (Vec2& point : points) {
    point.x = std::max(point.x, 0.0);
  }
  points.front().x = 0.0;
  points[1].y = points[0].y;  // smooth over the apex
  return SurfaceOfRevolution(std::move(points), kSurfaceDegree);
}

}  // namespace

Error error_of_ring(Error error, std::string_view table) {
  if (error.code != ErrorCode::kCancelled) {
    const std::string key = error.where == "threshold" ? "threshold_mm" : error.where;
    error.where = std::string(table) + (key.empty() ? "" : ".") + key;
  }
  return error;
}

Expected<HeadPattern> HeadPattern::make(const Head& head, std::size_t limit, const Progress& progress) {
  if (grows_meristem(head.rule)) {
    auto pattern = grow_meristem(head, limit, progress);
    if (!pattern) {
      return unexpected(pattern.error());
    }
    return HeadPattern(std::move(*pattern));
  }
  if (head.rule == PlacementRule::kActiveRing) {
    auto pattern = follow_ring(head, limit, progress);
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
  if (const auto* ring = std::get_if<RingPattern>(&pattern_)) {
    return ring->primordia;
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
  if (const auto* ring = std::get_if<RingPattern>(&pattern_)) {
    return surface_of(ring->head.at(time));
  }
  const auto& fixed = std::get<FixedPattern>(pattern_);
  std::vector<Vec2> controls = profile_at(fixed.profiles, time);
  const double factor = fixed.growth(time);
  for (Vec2& control : controls) {
    control = factor * control;
  }
  return surface_of(std::move(controls), fixed.bezier);
}

std::span<const PrimordiumKind> HeadPattern::kinds() const {
  const auto* ring = std::get_if<RingPattern>(&pattern_);
  return ring == nullptr ? std::span<const PrimordiumKind>() : ring->kinds;
}

std::vector<PrimordiumPlace> HeadPattern::places(double time, const SurfaceOfRevolution& surface) const {
  if (const auto* growing = std::get_if<MeristemDynamics>(&pattern_)) {
    return growing->places(time, surface);
  }
  if (const auto* ring = std::get_if<RingPattern>(&pattern_)) {
    std::vector<PrimordiumPlace> places;
    for (std::size_t i = 0; i < ring->ring.size() && ring->primordia[i].birth <= time; ++i) {
      places.push_back({ring->head.s_from_material(time, ring->ring[i].material), area_on_ring(*ring, i, time)});
    }
    return places;
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
