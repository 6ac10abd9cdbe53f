#include "anthesis/phyllotaxis/collision_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "anthesis/base/math.h"
#include "generator_curve.h"
#include "organ_grid.h"
#include "skyline.h"

namespace anthesis {
namespace {

constexpr double kContactTolerance = 1e-9;  ///< of the contact distance

/// The half plane of a generator, or of a sector of them about `azimuth_rad`: half its angle is `half_sine`,
/// `half_cosine`.
struct Meridian {
  double azimuth_rad = 0.0;
  double sine = 0.0;
  double cosine = 1.0;
  double half_sine = 0.0;
  double half_cosine = 1.0;

  explicit Meridian(double azimuth) : azimuth_rad(azimuth) {
    const auto [s, c] = math::sin_cos(azimuth);
    sine = s;
    cosine = c;
  }
};

GeneratorCurve make_curve(const CollisionParams& params) {
  const auto* by_place = std::get_if<RadiusAlongProfile>(&params.radius_mm);
  return by_place != nullptr ? GeneratorCurve(params.surface, by_place->radius_mm) : GeneratorCurve(params.surface);
}

class CollisionPlacement {
 public:
  CollisionPlacement(const CollisionParams& params, GeneratorCurve curve, double usual_mm)
      : params_(params),
        curve_(std::move(curve)),
        grid_(curve_.low_mm(), curve_.high_mm(), usual_mm, params.contact_factor),
        slack_mm_(16.0 * std::numeric_limits<double>::epsilon() * curve_.extent_mm()) {}

  Expected<CollisionPattern> run(std::size_t limit, const Progress& progress);

 private:
  struct Contacts {
    std::array<std::uint32_t, 2> index{kNoOrgan, kNoOrgan};
    void add(std::uint32_t i) {
      // Rarely called, and more rarely for a third: those of the least number stay.
      if (i < index[0]) {
        index[1] = index[0];
        index[0] = i;
      } else if (i < index[1]) {
        index[1] = i;
      }
    }
  };

  ForbiddenDisc disc_of(std::uint32_t index, const Meridian& meridian) const;
  enum class Step { kNone, kTaken, kPastTheTip };
  Step leave_usual(const Meridian& meridian, GeneratorPlace& place, double own_mm);
  bool climb(const Meridian& meridian, const ForbiddenStretches* proven, GeneratorPlace& place, double own_mm);
  void raise_skyline(double azimuth_rad);
  std::optional<double> radius_of(std::size_t organ) const;

  const CollisionParams& params_;
  GeneratorCurve curve_;
  OrganGrid grid_;
  Skyline skyline_;
  double slack_mm_;  ///< what rounding may make of a distance
  Contacts contacts_;
  int searches_ = 0;  ///< of the grid during the last climb
  std::uint32_t placed_ = 0;
  std::array<std::uint32_t, 4> usual_offsets_{};  ///< how much earlier organs were that stood in the way, latest first
};

/// What an organ forbids in the half plane of a generator; for a sector, as seen from that edge of it that is further
/// away, so that it is forbidden to all generators in it.
ForbiddenDisc CollisionPlacement::disc_of(std::uint32_t index, const Meridian& meridian) const {
  const OrganGrid::Entry& e = grid_[index];
  const double ahead = e.x * meridian.cosine + e.y * meridian.sine;
  const double aside = e.x * meridian.sine - e.y * meridian.cosine;
  if (!(meridian.half_sine > 0.0)) {
    return {{ahead, e.z}, aside * aside, e.radius_mm};
  }
  const double turned_ahead = ahead * meridian.half_cosine - std::abs(aside) * meridian.half_sine;
  const double turned_aside = std::abs(aside) * meridian.half_cosine + ahead * meridian.half_sine;
  if (turned_aside < 0.0) {  // beyond the opposite side, and that is the furthest
    return {{-std::sqrt(ahead * ahead + aside * aside), e.z}, 0.0, e.radius_mm};
  }
  return {{turned_ahead, e.z}, turned_aside * turned_aside, e.radius_mm};
}

/// Leaves an organ that is as much earlier as one that stood in the way of the organs before. Parastichies make that
/// a good guess, which saves a search.
CollisionPlacement::Step CollisionPlacement::leave_usual(const Meridian& meridian, GeneratorPlace& place,
                                                         double own_mm) {
  const GeneratorCurve::Point here = curve_.at(place);
  const double organ_mm = own_mm + here.organ_mm;
  for (const std::uint32_t offset : usual_offsets_) {
    if (offset == 0 || offset > placed_) {
      continue;
    }
    const ForbiddenDisc disc = disc_of(placed_ - offset, meridian);
    const Vec2 apart = here.position_mm - disc.centre;
    const double wanted = params_.contact_factor * (disc.radius_mm + organ_mm);
    if (wanted * wanted - (dot(apart, apart) + disc.aside2) > 2.0 * wanted * slack_mm_) {
      return curve_.leave(place, disc, own_mm, params_.contact_factor) ? Step::kTaken : Step::kPastTheTip;
    }
  }
  return Step::kNone;
}

/// The first place from `place` on where no organ forbids another of `own_mm` (added to the radius by place), on the
/// generator or, for a sector, to all generators in it. False if there is none up to the tip.
bool CollisionPlacement::climb(const Meridian& meridian, const ForbiddenStretches* proven, GeneratorPlace& place,
                               double own_mm) {
  const double factor = params_.contact_factor;
  searches_ = 0;
  for (;;) {
    if (proven != nullptr) {
      for (;;) {
        const double number = GeneratorCurve::number_of(place);
        const double passed = proven->pass(number);
        if (passed > number) {
          place = curve_.place_at(passed);
        }
        const Step step = leave_usual(meridian, place, own_mm);
        if (step == Step::kPastTheTip) {
          return false;
        }
        if (step == Step::kNone) {
          break;
        }
      }
    }
    ++searches_;
    const GeneratorCurve::Point here = curve_.at(place);
    const double organ_mm = own_mm + here.organ_mm;
    const double speed = length(here.derivative);
    const Vec2 along = speed > 0.0 ? here.derivative / speed : Vec2{};
    const std::span<const std::uint32_t> near = grid_.near(here.position_mm, meridian.azimuth_rad, organ_mm);
    // The organ whose disc reaches furthest along the tangent is the one to leave: a guess at which comes last.
    double furthest = -1.0;
    std::uint32_t worst = kNoOrgan;
    contacts_ = {};
    for (const std::uint32_t index : near) {
      const ForbiddenDisc disc = disc_of(index, meridian);
      const Vec2 apart = here.position_mm - disc.centre;
      const double wanted = factor * (disc.radius_mm + organ_mm);
      const double depth2 = wanted * wanted - (dot(apart, apart) + disc.aside2);
      if (depth2 < -wanted * (2.0 * kContactTolerance * wanted + 2.0 * slack_mm_)) {
        continue;
      }
      if (depth2 <= 2.0 * wanted * slack_mm_) {
        if (dot(apart, here.derivative) > wanted * factor * here.organ_derivative) {
          contacts_.add(index);
        }
        continue;
      }
      const double behind = dot(apart, along);
      const double reach = std::sqrt(std::max(behind * behind + depth2, 0.0)) - behind;
      if (reach > furthest) {
        furthest = reach;
        worst = index;
      }
    }
    if (worst == kNoOrgan) {
      return true;
    }
    if (proven != nullptr &&
        std::find(usual_offsets_.begin(), usual_offsets_.end(), placed_ - worst) == usual_offsets_.end()) {
      std::copy_backward(usual_offsets_.begin(), usual_offsets_.end() - 1, usual_offsets_.end());
      usual_offsets_[0] = placed_ - worst;
    }
    if (!curve_.leave(place, disc_of(worst, meridian), own_mm, factor)) {
      return false;
    }
  }
}

/// Called where a climb was long: proves what only several organs together forbid to the whole sector.
void CollisionPlacement::raise_skyline(double azimuth_rad) {
  Meridian meridian(skyline_.middle_of(azimuth_rad));
  const auto [sine, cosine] = math::sin_cos(skyline_.half_angle());
  meridian.half_sine = sine;
  meridian.half_cosine = cosine;
  const Contacts contacts = contacts_;
  ForbiddenStretches& sector = skyline_.at(azimuth_rad);
  GeneratorPlace place = curve_.place_at(sector.all_below());
  if (!climb(meridian, nullptr, place, skyline_.floor_mm())) {
    place = curve_.tip();
  }
  contacts_ = contacts;
  sector.add_all_below(GeneratorCurve::number_of(place));
}

std::optional<double> CollisionPlacement::radius_of(std::size_t organ) const {
  if (const auto* same = std::get_if<double>(&params_.radius_mm)) {
    return *same;
  }
  if (const auto* sequence = std::get_if<std::vector<double>>(&params_.radius_mm)) {
    return organ < sequence->size() ? std::optional<double>((*sequence)[organ]) : std::nullopt;
  }
  if (const auto* by_index = std::get_if<RadiusByIndex>(&params_.radius_mm)) {
    return by_index->radius_mm(organ);
  }
  return 0.0;  // the curve adds the radius by place
}

Expected<CollisionPattern> CollisionPlacement::run(std::size_t limit, const Progress& progress) {
  constexpr int kLongClimb = 6;
  const SurfaceOfRevolution& surface = params_.surface;
  const bool by_place = std::holds_alternative<RadiusAlongProfile>(params_.radius_mm);
  CollisionPattern pattern;
  double largest_mm = 0.0;
  bool on_base = true;
  for (std::size_t n = 0;; ++n) {
    const std::optional<double> given = radius_of(n);
    if (!given) {
      break;
    }
    const double own_mm = *given;
    if (!by_place && !(own_mm > 0.0 && std::isfinite(own_mm))) {
      return unexpected(invalid_parameter("radius_mm[" + std::to_string(n) + "]", "must be finite and > 0", own_mm));
    }
    if (n % 1024 == 0 && !report(progress, "pattern", n == 0 ? 0.0 : 1.0 - pattern.organs.back().s)) {
      return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
    }
    const Meridian meridian(spiral_azimuth_rad(n, params_.divergence_rad));
    GeneratorPlace place;
    bool limited = false;
    if (n > 0 && (params_.fall_limit == FallLimit::kAlways ||
                  (params_.fall_limit == FallLimit::kWhereRadiiDecrease && !by_place && own_mm < largest_mm))) {
      limited = true;
      const CollisionOrgan& before = pattern.organs.back();
      const double fall_mm = params_.fall_radii * (by_place ? before.radius_mm : own_mm);
      const double s = before.s + fall_mm / surface.length_mm();
      if (s < 1.0) {
        place = curve_.place_of(surface.t_from_s(s));
      }
    }
    const ForbiddenStretches nothing;
    const ForbiddenStretches* proven = &nothing;
    if (!limited) {
      if (n == 0 || own_mm < skyline_.floor_mm()) {
        // The first radius is often the only one. Radii that fall should not empty the skyline each time.
        skyline_.reset(n == 0 ? own_mm : 0.95 * own_mm);
      }
      proven = &skyline_.at(meridian.azimuth_rad);
    }
    placed_ = static_cast<std::uint32_t>(n);
    if (!climb(meridian, proven, place, own_mm)) {
      break;
    }
    if (!limited && searches_ > kLongClimb) {
      raise_skyline(meridian.azimuth_rad);
    }
    if (n == std::min<std::size_t>(limit, kNoOrgan - 1)) {
      return unexpected(
          Error{ErrorCode::kTooLarge, "radius_mm", "must give at most " + std::to_string(n) + " organs, got more"});
    }
    const GeneratorCurve::Point point = curve_.at(place);
    CollisionOrgan organ;
    organ.t = curve_.t_of(place);
    organ.s = surface.s_from_t(organ.t);
    organ.azimuth_rad = meridian.azimuth_rad;
    organ.radius_mm = own_mm + point.organ_mm;
    organ.contacts = contacts_.index;
    on_base = on_base && place == GeneratorPlace{};
    pattern.base_ring += on_base ? 1 : 0;
    pattern.organs.push_back(organ);
    largest_mm = std::max(largest_mm, organ.radius_mm);
    const Vec2 p = point.position_mm;
    if (!limited) {
      const double least_mm = by_place ? curve_.least_organ_near_mm(place) : skyline_.floor_mm();
      skyline_.add(curve_, place, p.x, organ.azimuth_rad, params_.contact_factor * (organ.radius_mm + least_mm));
    }
    grid_.insert(p, organ.azimuth_rad, {p.x * meridian.cosine, p.x * meridian.sine, p.y}, organ.radius_mm);
  }
  if (!report(progress, "pattern", 1.0)) {
    return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
  }
  return pattern;
}

}  // namespace

std::optional<Error> check(const CollisionParams& params) {
  if (auto error = check_profile("surface", params.surface.profile_mm())) {
    return error;
  }
  if (const auto* same = std::get_if<double>(&params.radius_mm)) {
    if (!(*same > 0.0 && std::isfinite(*same))) {
      return invalid_parameter("radius_mm", "must be finite and > 0", *same);
    }
  }
  if (const auto* sequence = std::get_if<std::vector<double>>(&params.radius_mm)) {
    for (std::size_t i = 0; i < sequence->size(); ++i) {
      const double radius_mm = (*sequence)[i];
      if (!(radius_mm > 0.0 && std::isfinite(radius_mm))) {
        return invalid_parameter("radius_mm[" + std::to_string(i) + "]", "must be finite and > 0", radius_mm);
      }
    }
  }
  if (const auto* by_index = std::get_if<RadiusByIndex>(&params.radius_mm)) {
    if (!by_index->radius_mm) {
      return invalid_parameter("radius_mm", "must be a function", "none");
    }
  }
  if (!std::isfinite(params.divergence_rad)) {
    return invalid_parameter("divergence_deg", "must be finite", math::degrees(params.divergence_rad));
  }
  if (!(params.contact_factor > 0.0 && std::isfinite(params.contact_factor))) {
    return invalid_parameter("contact_factor", "must be finite and > 0", params.contact_factor);
  }
  if (!(params.fall_radii >= 0.0 && std::isfinite(params.fall_radii))) {
    return invalid_parameter("fall_radii", "must be finite and >= 0", params.fall_radii);
  }
  return std::nullopt;
}

Expected<CollisionPattern> place_by_collision(const CollisionParams& params, std::size_t limit,
                                              const Progress& progress) {
  if (auto error = check(params)) {
    return unexpected(*error);
  }
  GeneratorCurve curve = make_curve(params);
  double usual_mm = 1.0;
  if (std::holds_alternative<RadiusAlongProfile>(params.radius_mm)) {
    if (!(curve.least_organ_mm() > 0.0) || !std::isfinite(curve.largest_organ_mm())) {
      return unexpected(invalid_parameter("radius_mm", "must be > 0 along the whole profile", curve.least_organ_mm()));
    }
    usual_mm = curve.largest_organ_mm();
  } else if (const auto* same = std::get_if<double>(&params.radius_mm)) {
    usual_mm = *same;
  } else if (const auto* sequence = std::get_if<std::vector<double>>(&params.radius_mm)) {
    usual_mm = sequence->empty() ? 1.0 : sequence->front();
  } else {
    usual_mm = std::get<RadiusByIndex>(params.radius_mm).radius_mm(0);
    if (!(usual_mm > 0.0 && std::isfinite(usual_mm))) {
      return unexpected(invalid_parameter("radius_mm[0]", "must be finite and > 0", usual_mm));
    }
  }
  return CollisionPlacement(params, std::move(curve), usual_mm).run(limit, progress);
}

}  // namespace anthesis
