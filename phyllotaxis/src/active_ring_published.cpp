#include <algorithm>
#include <array>
#include <cmath>

#include "anthesis/phyllotaxis/active_ring.h"
#include "ring_list.h"

namespace anthesis {
namespace {

using detail::angle_between;
using detail::RingList;

constexpr double kNearEnoughToTie = 1e-5;

struct Primordium {
  double u = 0.0;
  double s = 0.0;
  double azimuth = 0.0;
  double radius = 0.0;  ///< as of the last time it was looked at: the published program refreshes it late
  std::uint32_t born = 0;
  std::uint32_t left = 0;
  std::uint32_t right = 0;
  bool stable = false;
};

/// What the scan asks of a primordium near the ring.
struct Candidate {
  double azimuth = 0.0;
  double mean_radius = 0.0;
  double along_squared = 0.0;  ///< of the distance along the profile
  double half_arc = 0.0;       ///< angle that it forbids to each side; pi or more: all
};

class PublishedRing {
 public:
  PublishedRing(const GrowingProfile& profile, const ActiveRingParams& params, const Progress& progress)
      : profile_(profile), params_(params), progress_(progress) {
    const double end = params.first_azimuth_rad + math::kTurnRad;
    for (double angle = params.first_azimuth_rad; angle < end;
         angle += params.angular_step_rad) {  // added up there too
      scan_.push_back(angle <= math::kTurnRad ? angle : angle - math::kTurnRad);
    }
  }

  Expected<std::vector<RingPrimordium>> run() {
    step_size_ = params_.time_step;
    ring_ = profile_.ring(0.0);
    ring_radius_ = profile_.radius(0.0, ring_);
    if (auto error = set_threshold()) {
      return unexpected(*error);
    }
    for (;;) {
      if (!report(progress_, "primordia", time_)) {
        return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
      }
      advance_clock();
      for (std::size_t k = 0; k < unsettled_.size(); ++k) {
        move(unsettled_[k]);
      }
      std::erase_if(unsettled_, [this](std::uint32_t i) { return has_younger_neighbour(i); });
      if (ring_ > params_.last_ring) {
        scan();
        if (primordia_.size() > params_.most_primordia) {
          return unexpected(Error{ErrorCode::kTooLarge, "threshold",
                                  "must not let more primordia appear than " + std::to_string(params_.most_primordia)});
        }
      }
      ring_ = profile_.ring(time_);
      ring_radius_ = profile_.radius(time_, ring_);
      // The published program waits for the ring to reach 0.005, and for ever if it never does.
      if (time_ >= 1.0) {
        break;
      }
      if (auto error = set_threshold()) {
        return unexpected(*error);
      }
    }
    finish();
    return std::move(record_);
  }

 private:
  std::optional<Error> set_threshold() {
    if (primordia_.size() > params_.threshold_frozen_above) {
      return std::nullopt;
    }
    threshold_ = params_.threshold(time_);
    if (!(threshold_ > 0.0)) {
      return invalid_parameter("threshold", "must be > 0", threshold_);
    }
    if (math::kTurnRad * ring_radius_ > kMostAroundRing * threshold_) {
      return invalid_parameter("threshold", "must let at most 2000 primordia stand round the ring", threshold_);
    }
    return std::nullopt;
  }

  void advance_clock() {
    if (ring_ < 0.01 && step_size_ > 0.1 * params_.time_step) {
      step_size_ *= 0.993;
    }
    before_ = time_;
    time_ = std::min(1.0, time_ + step_size_);
    ++step_;
    length_ = profile_.length(time_);
  }

  bool has_younger_neighbour(std::uint32_t i) const {
    return primordia_[primordia_[i].left].born > primordia_[i].born ||
           primordia_[primordia_[i].right].born > primordia_[i].born;
  }

  RingMoment moment(double s, double azimuth) const {
    return {step_, time_, s, azimuth, kind_of(profile_, params_, time_, s)};
  }

  void move(std::uint32_t index) {
    Primordium& one = primordia_[index];
    one.s = profile_.s_from_material(time_, one.u);
    const bool mobile = primordia_.size() > 1 && one.s < params_.mobile_zone * ring_ && !has_younger_neighbour(index);
    if (mobile) {
      shift(index);
    } else if (!one.stable) {
      one.stable = true;
      record_[index].stable = moment(one.s, one.azimuth);
    }
    one.radius = profile_.radius(time_, one.s);
  }

  /// Towards the older neighbour, by its side and the shorter way's length; away from it if too near.
  void shift(std::uint32_t index) {
    Primordium& one = primordia_[index];
    const bool to_left = primordia_[one.left].born < primordia_[one.right].born;
    const std::uint32_t other_index = to_left ? one.left : one.right;
    const Primordium& other = primordia_[other_index];
    // Primordia are refreshed in the order of birth, and of those not yet in turn the radius is the last step's.
    const double s = profile_.s_from_material(time_, other.u);
    const double radius = other_index < index ? profile_.radius(time_, s)
                                              : profile_.radius(before_, profile_.s_from_material(before_, other.u));
    const double mean_radius = 0.5 * (one.radius + radius);
    const double across = mean_radius * angle_between(one.azimuth, other.azimuth);
    const double along = length_ * (one.s - s);
    const double distance = std::sqrt(across * across + along * along);
    if (!(distance > 0.0 && mean_radius > 0.0)) {
      return;
    }
    const double a = across / distance;
    const double change = params_.relaxation * params_.time_step * a * (across - a * threshold_) / mean_radius;
    one.azimuth = detail::one_turn(one.azimuth + (to_left ? -change : change));
  }

  Candidate candidate(double azimuth, double radius, double s) const {
    Candidate made;
    made.azimuth = azimuth;
    made.mean_radius = 0.5 * (ring_radius_ + radius);
    const double along = length_ * (ring_ - s);
    made.along_squared = along * along;
    const double across = std::sqrt(std::max(threshold_ * threshold_ - made.along_squared, 0.0));
    made.half_arc = across < math::kPi * made.mean_radius ? across / made.mean_radius : math::kPi;
    return made;
  }

  static double distance_squared(const Candidate& one, double azimuth) {
    const double across = one.mean_radius * angle_between(azimuth, one.azimuth);
    return across * across + one.along_squared;
  }

  void scan() {
    candidates_.clear();
    const double reach = threshold_ / length_ * (1.0 + 1e-12);
    for (const RingList::Entry& entry : order_.entries()) {
      const double s = profile_.s_from_material(time_, entry.material);
      if (s - ring_ > reach) {
        break;
      }
      if (ring_ - s > reach) {
        continue;
      }
      candidates_.push_back(candidate(primordia_[entry.primordium].azimuth, radius_now(entry.primordium, s), s));
    }
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& a, const Candidate& b) { return a.azimuth < b.azimuth; });
    const double threshold_squared = threshold_ * threshold_;
    std::size_t next = 0;  // the candidate to ask first: the one after the last that said no
    for (std::size_t i = 0; i < scan_.size();) {
      bool free = true;
      for (std::size_t k = 0; k < candidates_.size(); ++k) {
        const std::size_t at = (next + k) % candidates_.size();
        const Candidate& one = candidates_[at];
        if (distance_squared(one, scan_[i]) < threshold_squared) {
          free = false;
          next = at;
          if (one.half_arc >= math::kPi) {
            return;
          }
          // All angles up to the end of its arc are forbidden too. Two less than fit, so that rounding has no say.
          const double left = detail::one_turn(one.azimuth + one.half_arc - scan_[i]);
          const std::size_t jump = static_cast<std::size_t>(left / params_.angular_step_rad);
          i += left < 2.0 * one.half_arc && jump > 3 ? jump - 2 : 1;
          break;
        }
      }
      if (free) {
        insert(scan_[i]);
        ++i;
      }
    }
  }

  double radius_now(std::uint32_t index, double s) const {
    return primordia_[index].born == step_ ? primordia_[index].radius : profile_.radius(time_, s);
  }

  struct Near {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t index = 0;
  };

  /// The nearest two; of three equally near ones the oldest does not count.
  std::array<std::uint32_t, 2> nearest_two(double azimuth) const {
    std::array<Near, 3> nearest;
    for (const RingList::Entry& entry : order_.entries()) {
      const double s = primordia_[entry.primordium].born == step_ ? primordia_[entry.primordium].s
                                                                  : profile_.s_from_material(time_, entry.material);
      const double along = length_ * std::abs(ring_ - s);
      if (along > nearest[2].distance) {
        if (s > ring_) {
          break;
        }
        continue;
      }
      Near one{std::sqrt(distance_squared(
                   candidate(primordia_[entry.primordium].azimuth, radius_now(entry.primordium, s), s), azimuth)),
               entry.primordium};
      for (Near& place : nearest) {
        if (one.distance < place.distance || (one.distance == place.distance && one.index < place.index)) {
          std::swap(one, place);
        }
      }
    }
    if (nearest[2].distance - nearest[0].distance < kNearEnoughToTie) {
      std::size_t oldest = 0;
      for (std::size_t k = 1; k < 3; ++k) {
        if (primordia_[nearest[k].index].born < primordia_[nearest[oldest].index].born) {
          oldest = k;
        }
      }
      if (oldest < 2) {
        nearest[oldest] = oldest == 0 ? nearest[1] : nearest[2];
        nearest[1] = nearest[2];
      }
    }
    return {nearest[0].index, nearest[1].index};
  }

  void insert(double azimuth) {
    const std::uint32_t index = static_cast<std::uint32_t>(primordia_.size());
    Primordium one;
    one.s = ring_;
    one.azimuth = azimuth;
    one.radius = profile_.radius(time_, ring_);  // of this step, where the scan's is of the step before
    one.born = step_;
    one.u = profile_.material_from_s(time_, ring_);
    if (index >= 2) {
      const auto [first, second] = nearest_two(azimuth);
      const double ahead = detail::one_turn(primordia_[first].azimuth - azimuth);
      one.left = ahead >= math::kPi ? first : second;
      one.right = ahead >= math::kPi ? second : first;
    }
    primordia_.push_back(one);
    primordia_[one.left].right = index;
    primordia_[one.right].left = index;
    order_.insert(index, one.u);
    unsettled_.push_back(index);
    const Candidate now = candidate(azimuth, one.radius, ring_);
    candidates_.insert(std::upper_bound(candidates_.begin(), candidates_.end(), now,
                                        [](const Candidate& a, const Candidate& b) { return a.azimuth < b.azimuth; }),
                       now);
    RingPrimordium record;
    record.born = moment(one.s, azimuth);
    record.material = one.u;
    record.threshold = threshold_;
    record.neighbours = {one.left, one.right};
    record_.push_back(record);
  }

  void finish() {
    for (std::size_t i = 0; i < primordia_.size(); ++i) {
      record_[i].last = moment(profile_.s_from_material(time_, primordia_[i].u), primordia_[i].azimuth);
      if (!primordia_[i].stable) {
        record_[i].stable = record_[i].last;
      }
    }
  }

  const GrowingProfile& profile_;
  const ActiveRingParams& params_;
  const Progress& progress_;
  std::vector<double> scan_;  ///< the angles of a scan
  std::uint32_t step_ = 0;
  double step_size_ = 0.0;
  double time_ = 0.0;
  double before_ = 0.0;  ///< time of the step before
  double length_ = 0.0;
  double ring_ = 0.0;  ///< of the step before while a step runs, and so are the next two
  double ring_radius_ = 0.0;
  double threshold_ = 0.0;
  std::vector<Primordium> primordia_;
  std::vector<std::uint32_t> unsettled_;  ///< those that may still move, in order of birth
  RingList order_;
  std::vector<Candidate> candidates_;
  std::vector<RingPrimordium> record_;
};

}  // namespace

std::vector<double> published_clock(const GrowingProfile& profile, double step) {
  std::vector<double> times{0.0};
  double size = step;
  while (times.back() < 1.0) {
    if (profile.ring(times.back()) < 0.01 && size > 0.1 * step) {
      size *= 0.993;
    }
    times.push_back(std::min(1.0, times.back() + size));
  }
  return times;
}

Expected<std::vector<RingPrimordium>> grow_active_ring_as_published(const GrowingProfile& profile,
                                                                    const ActiveRingParams& params,
                                                                    const Progress& progress) {
  if (auto error = check(params, profile)) {
    return unexpected(*error);
  }
  return PublishedRing(profile, params, progress).run();
}

}  // namespace anthesis
