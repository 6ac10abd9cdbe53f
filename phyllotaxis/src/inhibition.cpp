#include "anthesis/phyllotaxis/inhibition.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/check.h"
#include "anthesis/base/math.h"
#include "conformal_profile.h"

namespace anthesis {
namespace {

double whole_turns_off(double angle_rad) {  // to [0, 2 pi)
  const double turns = angle_rad / math::kTurnRad;
  const double rest = (turns - std::floor(turns)) * math::kTurnRad;
  return rest < math::kTurnRad ? rest : 0.0;
}

/// Inhibition by one organ and its first three derivatives, all with alternating signs, as positive numbers.
struct Jet {
  double e = 0.0;
  double e1 = 0.0;
  double e2 = 0.0;
  double e3 = 0.0;
};

class Law {
 public:
  Law(const InhibitionParams& params, double range) : kind_(params.law), exponent_(params.exponent), range_(range) {}

  double value(double d) const {
    return kind_ == InhibitionLaw::kPower ? power(range_ / d) : math::exp(1.0 - d / range_);
  }
  Jet jet(double d) const {
    Jet jet;
    jet.e = value(d);
    if (kind_ == InhibitionLaw::kPower) {
      const double p = exponent_;
      jet.e1 = p * jet.e / d;
      jet.e2 = (p + 1.0) * jet.e1 / d;
      jet.e3 = (p + 2.0) * jet.e2 / d;
    } else {
      jet.e1 = jet.e / range_;
      jet.e2 = jet.e1 / range_;
      jet.e3 = jet.e2 / range_;
    }
    return jet;
  }

 private:
  double power(double x) const {
    double result = 1.0;
    double square = x;
    for (int left = exponent_; left > 0; left >>= 1) {
      if (left & 1) {
        result *= square;
      }
      square *= square;
    }
    return result;
  }

  InhibitionLaw kind_;
  int exponent_;
  double range_;
};

/// An organ as seen from the ring: squared distance to the angle theta is gap + 4 radius sin((theta - azimuth) / 2)^2.
struct Inhibitor {
  double gap = 0.0;
  double radius = 1.0;
  double root = 1.0;  ///< of the radius; no distance changes faster than this with theta
  math::SinCos azimuth{0.0, 1.0};
};

/// Inhibition at an angle, with derivatives by it, and bounds over all angles within `half_width`.
struct RingValue {
  double e = 0.0;
  double e1 = 0.0;
  double e2 = 0.0;
  double lowest = 0.0;  ///< no inhibition within is less
  double most2 = 0.0;   ///< no second derivative within is larger in size
  double most3 = 0.0;   ///< nor any third
};

struct RingMinimum {
  double angle_rad = 0.0;
  double inhibition = 0.0;
};

/// The sum over all organs as a function of the angle on the ring.
class Ring {
 public:
  Ring(const Law& law, std::vector<Inhibitor> inhibitors) : law_(law), inhibitors_(std::move(inhibitors)) {}

  /// Least value of the ring. Of values equal within kTie the first met from `from_rad` on, in the direction `turn`.
  RingMinimum minimum(double from_rad, double turn) const;

 private:
  static constexpr double kTie = 1e-12;
  static constexpr double kNarrowest = 1e-9;  ///< radians: what is left of a minimum too flat for Newton
  static constexpr double kNearest = 1e-9;    ///< a distance below this counts as this: organs born at this moment

  template <bool bounds>
  RingValue at(double angle_rad, double half_width) const;
  RingMinimum bottom(double low, double high) const;

  Law law_;
  std::vector<Inhibitor> inhibitors_;
};

template <bool bounds>
RingValue Ring::at(double angle_rad, double half_width) const {
  const math::SinCos here = math::sin_cos(angle_rad);
  RingValue sum;
  for (const Inhibitor& organ : inhibitors_) {
    const double sine = here.sin * organ.azimuth.cos - here.cos * organ.azimuth.sin;
    const double cosine = here.cos * organ.azimuth.cos + here.sin * organ.azimuth.sin;
    const double d = std::max(kNearest, std::sqrt(organ.gap + 2.0 * organ.radius * std::max(0.0, 1.0 - cosine)));
    const Jet e = law_.jet(d);
    const double d1 = organ.radius * sine / d;
    const double d2 = (organ.radius * cosine - d1 * d1) / d;
    sum.e += e.e;
    sum.e1 -= e.e1 * d1;
    sum.e2 += e.e2 * d1 * d1 - e.e1 * d2;
    if constexpr (bounds) {
      // |d'| <= root, |d''| <= 2 radius / d, |d'''| <= root + 6 root^3 / d^2
      const double reach = organ.root * half_width;
      const double nearest = std::max({kNearest, std::sqrt(organ.gap), d - reach});
      const Jet most = law_.jet(nearest);
      const double root3 = organ.root * organ.radius;
      sum.lowest += law_.value(d + reach);
      sum.most2 += organ.radius * (most.e2 + 2.0 * most.e1 / nearest);
      sum.most3 += root3 * most.e3 + 6.0 * root3 * most.e2 / nearest +
                   most.e1 * (organ.root + 6.0 * root3 / (nearest * nearest));
    }
  }
  if constexpr (bounds) {
    const double w = half_width;
    sum.lowest = std::max(sum.lowest, sum.e - std::abs(sum.e1) * w - 0.5 * sum.most2 * w * w);
  }
  return sum;
}

/// Of a convex function between two angles.
RingMinimum Ring::bottom(double low, double high) const {
  double angle = 0.5 * (low + high);
  RingMinimum best{angle, HUGE_VAL};
  for (int i = 0; i < 100; ++i) {
    const RingValue here = at<false>(angle, 0.0);
    if (here.e < best.inhibition || i == 0) {
      best = {angle, here.e};
    }
    (here.e1 > 0.0 ? high : low) = angle;
    double next = here.e2 > 0.0 ? angle - here.e1 / here.e2 : 0.5 * (low + high);
    if (!(next > low && next < high)) {
      next = 0.5 * (low + high);
    }
    // Once the step is at rounding the energies no longer tell the angles apart, but the derivative still does.
    if (std::abs(next - angle) <= 1e-15 || next == low || next == high) {
      best.angle_rad = next;
      break;
    }
    if (std::abs(next - angle) < 1e-7) {
      best.angle_rad = next;
    }
    angle = next;
  }
  return best;
}

RingMinimum Ring::minimum(double from_rad, double turn) const {
  struct Part {
    double angle;
    double half_width;
  };
  constexpr int kParts = 32;
  std::vector<Part> stack;
  const double half = math::kPi / kParts;
  for (int i = kParts; i-- > 0;) {
    // Laid out from `from_rad` in the direction `turn`, so that a mirrored ring is searched in mirrored order.
    stack.push_back({from_rad + turn * (2 * i + 1) * half, half});
  }
  RingMinimum best{from_rad, HUGE_VAL};
  const auto offer = [&](RingMinimum found) {
    const double slack = kTie * std::abs(best.inhibition);
    const auto way = [&](double angle) { return whole_turns_off(turn * (angle - from_rad)); };
    if (best.inhibition == HUGE_VAL || found.inhibition < best.inhibition - slack ||
        (found.inhibition < best.inhibition + slack && way(found.angle_rad) < way(best.angle_rad))) {
      best = {found.angle_rad, std::min(found.inhibition, best.inhibition)};
    }
  };
  // A first guess to prune by: the lowest of the middles, and what lies at the bottom of its valley.
  double least = HUGE_VAL;
  double least_angle = from_rad;
  for (auto part = stack.rbegin(); part != stack.rend(); ++part) {
    const double e = at<false>(part->angle, 0.0).e;
    if (e < least) {
      least = e;
      least_angle = part->angle;
    }
  }
  // A valley at least. If it is the lowest it is found again below, certified, unless it is too flat for that.
  const RingMinimum guess = bottom(least_angle - half, least_angle + half);
  double above = std::min(least, guess.inhibition);

  while (!stack.empty()) {
    const Part part = stack.back();
    stack.pop_back();
    const RingValue here = at<true>(part.angle, part.half_width);
    above = std::min(above, here.e);
    if (here.lowest >= above * (1.0 - kTie)) {  // also where the ring is flat to rounding: there is no end of halves
      continue;
    }
    if (here.e2 - here.most3 * part.half_width > 0.0 || part.half_width < kNarrowest) {
      // Convex. Searched a little beyond its ends, where a neighbour would find the same bottom.
      const double reach = part.half_width * 1.001;
      const RingMinimum found = bottom(part.angle - reach, part.angle + reach);
      above = std::min(above, found.inhibition);
      offer(found);
      continue;
    }
    const double quarter = 0.5 * part.half_width;
    stack.push_back({part.angle + turn * quarter, quarter});
    stack.push_back({part.angle - turn * quarter, quarter});
  }
  return guess.inhibition < best.inhibition * (1.0 - kTie) ? guess : best;
}

SurfaceOfRevolution surface_of(const InhibitionParams& params) {
  return {params.profile, std::min(3, static_cast<int>(params.profile.size()) - 1)};
}

double scheduled(const std::array<double, 2>& ends, std::size_t ramp, std::size_t birth) {
  if (birth >= ramp || ends[0] == ends[1]) {
    return ends[1];
  }
  const double share = static_cast<double>(birth) / static_cast<double>(ramp);
  return ends[0] * math::exp(share * math::log(ends[1] / ends[0]));
}

}  // namespace

std::optional<Error> check(const InhibitionParams& params) {
  if (params.transport == RingTransport::kSurface) {
    if (auto error = check_profile("profile", params.profile)) {
      return error;
    }
    if (auto error = check_number("ring_s", params.ring_s, 0.0, 1.0)) {
      return error;
    }
    const SurfaceOfRevolution surface = surface_of(params);
    constexpr int kLooks = 1000;
    for (int i = 0; i <= kLooks; ++i) {
      const double s = params.ring_s + (1.0 - params.ring_s) * i / kLooks;
      if (!(surface.radius_mm(surface.t_from_s(s)) > 1e-9 * surface.length_mm())) {
        return invalid_parameter("ring_s", "must have a radius > 0 from there to the base", params.ring_s);
      }
    }
  }
  if (auto error = check_whole("exponent", params.exponent, 1, 12)) {
    return error;
  }
  for (const double period : params.period) {
    if (auto error = check_number("period", period, 0.001, 100.0)) {
      return error;
    }
  }
  for (const double range : params.range) {
    if (auto error = check_number("range", range, 0.01, 10.0)) {
      return error;
    }
  }
  if (auto error = check_number("ramp", static_cast<double>(params.ramp), 0.0, 1e6)) {
    return error;
  }
  if (auto error = check_number("count", static_cast<double>(params.count), 1.0, 100000.0)) {
    return error;
  }
  if (!(std::abs(params.nudge_rad) < math::kPi)) {
    return invalid_parameter("nudge_rad", "must be within (-pi, pi)", params.nudge_rad);
  }
  return check_number("horizon", params.horizon, 2.0, 1000.0);
}

RingTrack::RingTrack(const InhibitionParams& params) : transport_(params.transport) {
  if (transport_ == RingTransport::kSurface) {
    const SurfaceOfRevolution surface = surface_of(params);
    profile_ = std::make_shared<const detail::ConformalProfile>(surface, params.ring_s);
    const Vec2 ring = profile_->place_mm(0.0);
    ring_radius_mm_ = ring.x;
    ring_height_mm_ = ring.y;
  }
}

RingPlace RingTrack::at(double age) const {
  switch (transport_) {
    case RingTransport::kExponentialDisc:
      return {math::exp(age), 0.0};
    case RingTransport::kSteadyDisc:
      return {1.0 + age, 0.0};
    case RingTransport::kCylinder:
      break;
    case RingTransport::kSurface: {
      const Vec2 place = profile_->place_mm(age);
      return {place.x / ring_radius_mm_, (ring_height_mm_ - place.y) / ring_radius_mm_};
    }
  }
  return {1.0, age};
}

double RingTrack::conformal_distance(double age) const {
  return transport_ == RingTransport::kSteadyDisc ? math::log(1.0 + age) : age;
}

Expected<std::vector<RingBirth>> grow_by_inhibition(const InhibitionParams& params, const Progress& progress) {
  if (auto error = check(params)) {
    return unexpected(*error);
  }
  const RingTrack track(params);
  std::vector<RingBirth> births;
  births.reserve(params.count);
  births.push_back({});
  std::vector<math::SinCos> directions = {{0.0, 1.0}};
  std::size_t first_within = 0;  // organs only ever leave the horizon, the oldest first

  const auto ring_at = [&](double time, double range) {
    std::vector<Inhibitor> inhibitors;
    for (std::size_t i = first_within; i < births.size(); ++i) {
      const RingPlace place = track.at(time - births[i].time);
      // The youngest counts however far: something must say where the ring is least inhibited.
      if (std::max(place.radius, place.depth) > params.horizon && i + 1 < births.size()) {
        continue;
      }
      const double out = place.radius - 1.0;
      inhibitors.push_back(
          {out * out + place.depth * place.depth, place.radius, std::sqrt(place.radius), directions[i]});
    }
    return Ring(Law(params, range), std::move(inhibitors));
  };
  const double turn = params.nudge_rad < 0.0 ? -1.0 : 1.0;

  while (births.size() < params.count) {
    if (!report(progress, "inhibition", static_cast<double>(births.size()) / static_cast<double>(params.count))) {
      return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
    }
    const RingBirth& last = births.back();
    const double range = scheduled(params.range, params.ramp, births.size() - 1);
    RingBirth next;
    const auto least_at = [&](double time) { return ring_at(time, range).minimum(last.azimuth_rad, turn); };
    RingMinimum found;
    if (params.rule == BirthRule::kPeriod) {
      next.time = last.time + scheduled(params.period, params.ramp, births.size() - 1);
      found = least_at(next.time);
    } else {
      // Every organ moves away from every place of the ring, so the least inhibition falls with time: one root.
      double low = last.time;
      found = least_at(low);
      if (found.inhibition > 1.0) {
        double low_excess = math::log(found.inhibition);
        double step = births.size() > 1 ? std::max(1e-3, last.time - births[births.size() - 2].time) : 0.1;
        double high = low + step;
        RingMinimum at_high = least_at(high);
        while (at_high.inhibition > 1.0) {
          low = high;
          low_excess = math::log(at_high.inhibition);
          step *= 2.0;
          high = low + step;
          if (high - last.time > 1000.0) {
            return unexpected(Error{ErrorCode::kTooLarge, "range", "leaves no room for another organ on the ring"});
          }
          at_high = least_at(high);
        }
        double high_excess = math::log(at_high.inhibition);
        found = at_high;
        // Illinois: a secant that halves the weight of an end that stays.
        int side = 0;
        for (int i = 0; i < 100 && high - low > 1e-13 * (1.0 + high); ++i) {
          double time = (low * high_excess - high * low_excess) / (high_excess - low_excess);
          if (!(time > low && time < high)) {
            time = 0.5 * (low + high);
            if (!(time > low && time < high)) {
              break;
            }
          }
          const RingMinimum middle = least_at(time);
          const double excess = math::log(middle.inhibition);
          if (excess > 0.0) {
            low = time;
            low_excess = excess;
            high_excess *= side == 1 ? 0.5 : 1.0;
            side = 1;
          } else {
            high = time;
            high_excess = excess;
            low_excess *= side == -1 ? 0.5 : 1.0;
            side = -1;
            found = middle;
          }
          if (std::abs(excess) < 1e-13) {
            high = time;
            found = middle;
            break;
          }
        }
        low = high;
      }
      next.time = low;
    }
    double angle = found.angle_rad;
    if (births.size() == 1) {
      angle = math::kPi + params.nudge_rad;
    }
    next.azimuth_rad = whole_turns_off(angle);
    next.divergence_rad = whole_turns_off(angle - last.azimuth_rad);
    next.inhibition = found.inhibition;
    births.push_back(next);
    directions.push_back(math::sin_cos(next.azimuth_rad));
    while (first_within + 1 < births.size()) {
      const RingPlace place = track.at(next.time - births[first_within].time);
      if (std::max(place.radius, place.depth) <= params.horizon) {
        break;
      }
      ++first_within;
    }
  }
  return births;
}

std::vector<Vec2> unrolled_births(const RingTrack& track, std::span<const RingBirth> births) {
  std::vector<Vec2> places;
  places.reserve(births.size());
  for (const RingBirth& birth : births) {
    const double out = track.conformal_distance(births.back().time - birth.time);
    places.push_back({birth.azimuth_rad / math::kTurnRad, out / math::kTurnRad});
  }
  return places;
}

}  // namespace anthesis
