#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/collision_model.h"
#include "organ_grid.h"

namespace anthesis {
namespace {

constexpr std::size_t kFewestTogether = 16;  ///< organs that are judged together, neighbours along the profile

/// By how much the profile has turned from the apex on, whichever way, against the length along it. Where it ends on
/// the axis it goes on as its mirror image.
class Turning {
 public:
  explicit Turning(const SurfaceOfRevolution& surface) {
    constexpr int kSteps = 128;  // of a piece; what is asked for is half an angle, to a percent
    const BSplineCurve<Vec2>& profile = surface.profile_mm();
    const std::vector<double> knots = profile.knots();
    Vec2 last = profile.at(0.0);
    const bool from_axis = last.x == 0.0;
    Vec2 before{};
    double length_mm = 0.0;
    double turned = 0.0;
    push(length_mm, turned);
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
      for (int i = 1; i <= kSteps; ++i) {
        const Vec2 point = profile.at(knots[k] + (knots[k + 1] - knots[k]) * i / kSteps);
        const double chord_mm = length(point - last);
        if (!(chord_mm > 0.0)) {
          continue;
        }
        const Vec2 direction = (point - last) / chord_mm;
        if (before == Vec2{}) {
          apex_corner_ = from_axis ? 2.0 * angle({1.0, 0.0}, direction) : kRim;
        } else {
          // At a knot there may be a corner; elsewhere a chord has its direction at its middle.
          if (i == 1) {
            push(length_mm, turned);
          }
          turned += angle(before, direction);
          push(length_mm + (i == 1 ? 0.0 : 0.5 * chord_mm), turned);
        }
        length_mm += chord_mm;
        last = point;
        before = direction;
      }
    }
    push(length_mm, turned);
    base_corner_ = last.x == 0.0 ? 2.0 * angle({-1.0, 0.0}, before) : kRim;
  }

  /// Within `reach_mm` of a place; half of it is a length over the radius of curvature.
  double within(double length_mm, double reach_mm) const {
    const double low_mm = length_mm - reach_mm;
    const double high_mm = length_mm + reach_mm;
    double turned = at(high_mm, true) - at(low_mm, false);
    if (low_mm < 0.0 && apex_corner_ != kRim) {
      turned += apex_corner_ + at(-low_mm, true);
    }
    if (high_mm > length_.back() && base_corner_ != kRim) {
      turned += base_corner_ + turned_.back() - at(2.0 * length_.back() - high_mm, false);
    }
    return turned;
  }

 private:
  static constexpr double kRim = -1.0;  ///< the surface ends there

  static double angle(Vec2 a, Vec2 b) { return std::abs(math::atan2(cross(a, b), dot(a, b))); }
  void push(double length_mm, double turned) {
    length_.push_back(length_mm);
    turned_.push_back(turned);
  }
  /// At a corner, its angle included or not.
  double at(double length_mm, bool after) const {
    const auto next = after ? std::upper_bound(length_.begin(), length_.end(), length_mm)
                            : std::lower_bound(length_.begin(), length_.end(), length_mm);
    if (next == length_.begin()) {
      return turned_.front();
    }
    if (next == length_.end()) {
      return turned_.back();
    }
    const std::size_t i = static_cast<std::size_t>(next - length_.begin()) - 1;
    const double share = (length_mm - length_[i]) / (length_[i + 1] - length_[i]);
    return turned_[i] + share * (turned_[i + 1] - turned_[i]);
  }

  std::vector<double> length_;
  std::vector<double> turned_;
  double apex_corner_ = kRim;  ///< twice the angle between the profile and the plane across the axis
  double base_corner_ = kRim;
};

/// Denominators of the fractions p / q that no fraction of a smaller denominator beats from the same side: the numbers
/// of the parastichies that a divergence can have. For the golden angle, the Fibonacci numbers.
std::vector<std::uint32_t> parastichy_numbers(double divergence_rad, std::size_t most) {
  const double turns = divergence_rad / math::kTurnRad;
  double below = 1.0;
  double above = 1.0;
  std::vector<std::uint32_t> numbers;
  for (std::size_t q = 1; q <= most; ++q) {
    const double x = static_cast<double>(q) * turns;
    const double over = x - std::floor(x);  // past the whole turn; short of it is 1 - over
    if (over < below || 1.0 - over < above) {
      numbers.push_back(static_cast<std::uint32_t>(q));
      below = std::min(below, over);
      above = std::min(above, 1.0 - over);
    }
    if (below < 1e-9 || above < 1e-9) {
      break;
    }
  }
  return numbers;
}

}  // namespace

const char* flaw_name(PatternFlaw flaw) {
  switch (flaw) {
    case PatternFlaw::kCurvature:
      return "curvature";
    case PatternFlaw::kRadiusRatio:
      return "radius_ratio";
    case PatternFlaw::kGap:
      return "gap";
    case PatternFlaw::kJump:
      return "jump";
    case PatternFlaw::kIrregular:
      return "irregular";
  }
  return "";
}

CollisionValidity judge_pattern(const CollisionParams& params, const CollisionPattern& pattern,
                                const ValidityLimits& limits) {
  const std::vector<CollisionOrgan>& organs = pattern.organs;
  CollisionValidity validity;
  if (organs.empty()) {
    return validity;
  }
  validity.organs.resize(organs.size());
  const SurfaceOfRevolution& surface = params.surface;
  const double factor = params.contact_factor;
  const double length_mm = surface.length_mm();
  const Turning turning(surface);
  const std::vector<std::uint32_t> numbers =
      parastichy_numbers(params.divergence_rad, std::min<std::size_t>(organs.size(), 1'000'000));
  Vec2 low = surface.profile_mm().controls.front();
  Vec2 high = low;
  for (const Vec2 c : surface.profile_mm().controls) {
    low = {std::min(low.x, c.x), std::min(low.y, c.y)};
    high = {std::max(high.x, c.x), std::max(high.y, c.y)};
  }
  OrganGrid grid(low, high, organs.front().radius_mm, factor);
  for (std::size_t n = 0; n < organs.size(); ++n) {
    const CollisionOrgan& organ = organs[n];
    OrganValidity& judged = validity.organs[n];
    const double r = organ.radius_mm;
    const SurfaceFrame frame = surface.frame(organ.t, organ.azimuth_rad);
    const double axis_mm = surface.radius_mm(organ.t);
    judged.curvature =
        std::max(0.5 * turning.within(organ.s * length_mm, r), r * std::abs(frame.meridian.z) / std::max(axis_mm, r));
    if (n > 0) {
      judged.jump = std::abs(organ.s - organs[n - 1].s) * length_mm / (2.0 * factor * r);
    }
    // The nearest earlier organ on either side: of an organ that is held, one is its holder.
    std::array<double, 2> clearance{2.0, 2.0};
    std::array<double, 2> ratio{1.0, 1.0};
    for (const std::uint32_t index : grid.near({axis_mm, frame.position_mm.z}, organ.azimuth_rad, 2.2 * r)) {
      const OrganGrid::Entry& e = grid[index];
      const Vec3 apart = Vec3{e.x, e.y, e.z} - frame.position_mm;
      const double wanted = factor * (r + e.radius_mm);
      const double spare = length(apart) / wanted - 1.0;
      const int side = dot(apart, frame.parallel) < 0.0 ? 0 : 1;
      if (spare < clearance[side]) {
        clearance[side] = spare;
        ratio[side] = std::max(r / e.radius_mm, e.radius_mm / r);
      }
    }
    if (organ.contacts[0] != kNoOrgan) {
      judged.gap = std::min(std::max({clearance[0], clearance[1], 0.0}), 1.0);
      judged.radius_ratio = std::max(ratio[0], ratio[1]);
      const auto is_number = [&](std::uint32_t holder) {
        return holder != kNoOrgan &&
               std::binary_search(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(n) - holder);
      };
      judged.is_irregular = !is_number(organ.contacts[0]) && !is_number(organ.contacts[1]);
    }
    grid.insert({axis_mm, frame.position_mm.z}, organ.azimuth_rad, frame.position_mm, r);
  }

  std::vector<std::uint32_t> along(organs.size());
  std::iota(along.begin(), along.end(), 0u);
  std::stable_sort(along.begin(), along.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return organs[a].s < organs[b].s; });
  // About one round of the pattern each.
  const std::size_t together =
      std::max(kFewestTogether, static_cast<std::size_t>(std::sqrt(static_cast<double>(organs.size()))));
  const std::size_t stretches = std::max<std::size_t>(organs.size() / together, 1);
  const auto warn = [&](PatternFlaw flaw, double limit, const auto& measure_of) {
    std::size_t open_until = 0;  // the warning before goes on across one stretch that is better
    for (std::size_t k = 0; k < stretches; ++k) {
      const std::size_t first = k * organs.size() / stretches;
      const std::size_t last = (k + 1) * organs.size() / stretches;
      const double measure = measure_of(std::span<const std::uint32_t>(along).subspan(first, last - first));
      if (!(measure > limit)) {
        continue;
      }
      if (k >= open_until) {
        validity.warnings.push_back({flaw, organs[along[first]].s, 0.0, measure, limit});
      }
      open_until = k + 3;
      PatternWarning& warning = validity.warnings.back();
      warning.s_to = organs[along[last - 1]].s;
      warning.measure = std::max(warning.measure, measure);
    }
  };
  // The largest value of a stretch once a share of its organs is set aside.
  std::vector<double> values;
  const auto warn_above = [&](PatternFlaw flaw, double limit, std::size_t aside_of_ten, const auto& value_of) {
    warn(flaw, limit, [&](std::span<const std::uint32_t> stretch) {
      values.clear();
      for (const std::uint32_t i : stretch) {
        values.push_back(value_of(validity.organs[i]));
      }
      std::sort(values.begin(), values.end(), std::greater<>());
      return values[stretch.size() * aside_of_ten / 10];
    });
  };
  warn_above(PatternFlaw::kCurvature, limits.curvature, 0, [](const OrganValidity& o) { return o.curvature; });
  warn_above(PatternFlaw::kRadiusRatio, limits.radius_ratio, 0, [](const OrganValidity& o) { return o.radius_ratio; });
  warn_above(PatternFlaw::kGap, limits.gap, 2, [](const OrganValidity& o) { return o.gap; });
  warn_above(PatternFlaw::kJump, limits.jump, 2, [](const OrganValidity& o) { return o.jump; });
  warn(PatternFlaw::kIrregular, limits.irregular, [&](std::span<const std::uint32_t> stretch) {
    const auto irregular =
        std::count_if(stretch.begin(), stretch.end(), [&](std::uint32_t i) { return validity.organs[i].is_irregular; });
    return static_cast<double>(irregular) / static_cast<double>(stretch.size());
  });
  return validity;
}

}  // namespace anthesis
