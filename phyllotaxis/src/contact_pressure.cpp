#include "anthesis/phyllotaxis/contact_pressure.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/check.h"
#include "anthesis/base/math.h"

namespace anthesis {
namespace {

double fraction_of(double turns) {
  return turns - std::floor(turns);
}
double wrapped(double turns) {  // to [-1/2, 1/2)
  return turns - std::floor(turns + 0.5);
}

/// The image of an organ relative to which the first one moves: `index` up, `x` aside in the direction of the walk.
struct Image {
  int index = 0;
  double x = 0.0;
};

/// The least t >= 0 from which on the organ at `next` is nearer than the one at `now`, both moving aside by t times
/// their index; infinity if none. At t = 0, `next` is not nearer.
double overtaken_at(Image now, Image next, double rise) {
  const double k = now.index;
  const double n = next.index;
  // f(t) = distance(now)^2 - distance(next)^2 = a t^2 + 2 b t + c
  const double a = (k - n) * (k + n);
  const double b = k * now.x - n * next.x;
  const double c = std::min(0.0, (now.x - next.x) * (now.x + next.x) + a * rise * rise);
  if (c > -1e-15 && b > 0.0) {
    return 0.0;
  }
  const double root2 = b * b - a * c;
  if (root2 < 0.0) {
    return HUGE_VAL;
  }
  // The smallest root at which f rises, with no difference of near equals: f' there is +2 sqrt(root2).
  const double root = std::sqrt(root2);
  if (b >= 0.0) {
    return b + root > 0.0 ? -c / (b + root) : HUGE_VAL;
  }
  return a > 0.0 ? (root - b) / a : HUGE_VAL;
}

}  // namespace

PressedLattice press(double divergence_rad, double rise, PressureSide side) {
  ANTHESIS_ASSERT(std::isfinite(divergence_rad) && rise >= 1e-6 && rise <= 1e3);
  double divergence = fraction_of(divergence_rad / math::kTurnRad);
  // Points of density 1 / rise are nowhere farther apart than sqrt(2 / sqrt(3) rise); beyond that height none matters.
  const int highest = 1 + static_cast<int>(std::sqrt(1.1547005383792517 / rise));

  PressedLattice result;
  result.rise = rise;
  Image nearest;
  double least = HUGE_VAL;
  for (int index = 1; index <= highest; ++index) {
    const double x = wrapped(index * divergence);
    const double squared = x * x + (index * rise) * (index * rise);
    if (squared < least) {
      least = squared;
      nearest = {index, x};
    }
  }
  if (least >= 1.0) {  // an organ is nearer to itself around the cylinder than to any other
    result.divergence_rad = divergence * math::kTurnRad;
    result.distance = 1.0;
    return result;
  }
  double direction = nearest.x < 0.0 ? -1.0 : 1.0;
  if (std::abs(nearest.x) < 1e-12) {
    direction = side == PressureSide::kTowardsSmaller ? -1.0 : 1.0;
  }
  nearest.x = std::abs(nearest.x);

  // Uphill: away from the nearest organ, until another is as near. If that one is approached, it holds; if it is left
  // behind as well, but more slowly, it is now the one to flee from. Distances along the walk only grow.
  double walked = 0.0;
  Image holding;
  for (int i = 0; i < 100 * highest; ++i) {
    double least_step = HUGE_VAL;
    Image next;
    for (int index = 1; index <= highest; ++index) {
      const double x = wrapped(direction * index * (divergence + direction * walked));
      for (const double image : {x - 1.0, x, x + 1.0}) {
        if (index == nearest.index && std::abs(image - nearest.x) < 0.5) {
          continue;  // itself
        }
        const double step = overtaken_at(nearest, {index, image}, rise);
        if (step < least_step) {
          least_step = step;
          next = {index, image};
        }
      }
    }
    const double ring = std::sqrt(1.0 - (nearest.index * rise) * (nearest.index * rise));
    if (nearest.x + nearest.index * least_step >= ring) {  // the ring around the cylinder is as near: no need to go on
      walked += (ring - nearest.x) / nearest.index;
      nearest.x = ring;
      break;
    }
    walked += least_step;
    nearest.x += nearest.index * least_step;
    next.x += next.index * least_step;
    if (next.x <= 0.0) {
      holding = next;
      break;
    }
    nearest = next;
  }
  divergence = fraction_of(divergence + direction * walked);
  result.divergence_rad = divergence * math::kTurnRad;
  result.distance = length(Vec2{nearest.x, nearest.index * rise});
  result.m = std::min(nearest.index, holding.index);
  result.n = std::max(nearest.index, holding.index);
  return result;
}

std::optional<Error> check(const ContactPressureParams& params) {
  if (!std::isfinite(params.first_divergence_rad)) {
    return invalid_parameter("first_divergence_rad", "must be finite", params.first_divergence_rad);
  }
  if (auto error = check_number("first_rise", params.first_rise, 1e-6, 1e3)) {
    return error;
  }
  if (auto error = check_number("last_rise", params.last_rise, 1e-6, params.first_rise)) {
    return error;
  }
  return check_whole("steps", params.steps, 1, 100000);
}

Expected<std::vector<PressedLattice>> contact_pressure(const ContactPressureParams& params, const Progress& progress) {
  if (auto error = check(params)) {
    return unexpected(*error);
  }
  std::vector<PressedLattice> result;
  result.reserve(static_cast<std::size_t>(params.steps));
  double divergence_rad = params.first_divergence_rad;
  // At half a turn two mirror images part; the first divergence says which is meant.
  const PressureSide side =
      fraction_of(divergence_rad / math::kTurnRad) > 0.5 ? PressureSide::kTowardsLarger : PressureSide::kTowardsSmaller;
  const double fall = math::log(params.last_rise / params.first_rise);
  for (int i = 0; i < params.steps; ++i) {
    if (!report(progress, "contact pressure", static_cast<double>(i) / params.steps)) {
      return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
    }
    const double share = params.steps == 1 ? 0.0 : static_cast<double>(i) / (params.steps - 1);
    const double rise = i + 1 == params.steps && i > 0 ? params.last_rise : params.first_rise * math::exp(share * fall);
    result.push_back(press(divergence_rad, std::max(1e-6, rise), side));
    divergence_rad = result.back().divergence_rad;
  }
  return result;
}

}  // namespace anthesis
