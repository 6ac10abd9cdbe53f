#include "anthesis/phyllotaxis/active_ring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "anthesis/base/check.h"
#include "ring_list.h"

namespace anthesis {

namespace detail {

double one_turn(double angle_rad) {
  double turned = angle_rad - math::kTurnRad * std::floor(angle_rad / math::kTurnRad);
  return turned < math::kTurnRad ? turned : 0.0;
}

double angle_between(double a_rad, double b_rad) {
  const double difference = std::abs(a_rad - b_rad);
  return std::min(difference, math::kTurnRad - difference);
}

}  // namespace detail

namespace {

using detail::angle_between;
using detail::one_turn;
using detail::RingList;

constexpr double kLongestOdeStep = 0.0005;  // azimuths then err by 1e-6 rad or so, most where D has a corner
constexpr double kSameAngle = 1e-10;        // gaps narrower than this are closed
constexpr double kSameTime = 1e-14;

struct Primordium {
  double u = 0.0;
  double azimuth = 0.0;  ///< at `since`, not reduced to one turn: gaps are followed across it
  double since = 0.0;
  double until = 1.0;  ///< moves sideways no longer from here on
  std::uint32_t left = 0;
  std::uint32_t right = 0;
  bool moving = false;
};

/// The ring at one time.
struct Ring {
  double time = -1.0;  ///< none
  double s = 0.0;
  double radius = 0.0;
  double length = 0.0;
  double threshold = 0.0;
};

/// What a primordium forbids on the ring.
struct Arc {
  double azimuth = 0.0;  ///< not reduced
  double half = 0.0;     ///< 0: nothing; pi or more: everything
  double begin = 0.0;    ///< azimuth - half, within one turn
  std::uint32_t primordium = 0;
};

/// A stretch of the ring that nobody forbids.
struct Gap {
  std::uint32_t behind = 0;  ///< its arc ends where the gap begins
  std::uint32_t ahead = 0;
  double begin = 0.0;  ///< in one turn from the first azimuth, so that gaps have an order
  double width = 0.0;
  bool whole = false;  ///< nobody forbids anything
};

class ContinuousRing {
 public:
  ContinuousRing(const GrowingProfile& profile, const ActiveRingParams& params, const Progress& progress)
      : profile_(profile), params_(params), progress_(progress) {}

  Expected<std::vector<RingPrimordium>> run() {
    double time = 0.0;
    if (profile_.ring(0.0) > params_.last_ring) {
      insert(ring_at(0.0), params_.first_azimuth_rad, 0, 0);
    }
    std::size_t steps = 0;
    while (time < 1.0 && !error_) {
      const double next = std::min(1.0, static_cast<double>(++steps) * params_.time_step);
      const bool last = profile_.ring(next) <= params_.last_ring;
      const double end = last ? time_of_last_ring(time, next) : next;
      for (std::uint32_t i : unsettled_) {
        find_end(i, time, end);
      }
      advance(time, end);
      time = end;
      std::erase_if(unsettled_, [&](std::uint32_t i) { return settle(i, time); });
      if (last) {
        let_settle(time);
        break;
      }
    }
    if (error_) {
      return unexpected(*error_);
    }
    for (std::size_t i = 0; i < primordia_.size(); ++i) {
      record_[i].last = moment(1.0, primordia_[i].u, primordia_[i].azimuth);
      if (primordia_[i].moving) {
        record_[i].stable = record_[i].last;
      }
    }
    return std::move(record_);
  }

 private:
  double threshold(double time) {
    if (frozen_ > 0.0) {
      return frozen_;
    }
    const double value = params_.threshold(time);
    if (!(value > 0.0) && !error_) {
      error_ = invalid_parameter("threshold", "must be > 0", value);
    }
    return error_ ? 1.0 : value;
  }

  /// Many primordia are asked about at the same few times: the last eight answers are kept.
  Ring ring_at(double time) {
    for (const Ring& known : rings_) {
      if (known.time == time) {
        return known;
      }
    }
    Ring& ring = rings_[next_ring_++ % rings_.size()];
    ring = {time, profile_.ring(time), 0.0, profile_.length(time), threshold(time)};
    ring.radius = profile_.radius(time, ring.s);
    if (math::kTurnRad * ring.radius > kMostAroundRing * ring.threshold && !error_) {
      error_ = invalid_parameter("threshold", "must let at most 2000 primordia stand round the ring", ring.threshold);
    }
    return ring;
  }

  RingMoment moment(double time, double u, double azimuth) const {
    const double s = profile_.s_from_material(time, u);
    return {0, time, s, one_turn(azimuth), kind_of(profile_, params_, time, s)};
  }

  // ---- sideways movement --------------------------------------------------------------------------------------------

  /// Rate of the azimuth of primordium `one` at (time, azimuth). It moves towards the older of its two neighbours, on
  /// whose side it keeps; that one no longer moves, for it has a younger neighbour.
  double rate(const Primordium& one, double time, double azimuth) {
    const bool to_left = one.left < one.right;
    const Primordium& other = primordia_[to_left ? one.left : one.right];
    const double s = profile_.s_from_material(time, one.u);
    const double other_s = profile_.s_from_material(time, other.u);
    const double mean_radius = 0.5 * (profile_.radius(time, s) + profile_.radius(time, other_s));
    const double across = mean_radius * angle_between(one_turn(azimuth), one_turn(other.azimuth));
    const Ring ring = ring_at(time);
    const double along = ring.length * (s - other_s);
    const double distance = std::sqrt(across * across + along * along);
    if (!(distance > 0.0 && mean_radius > 0.0)) {
      return 0.0;
    }
    const double a = across / distance;
    const double towards = params_.relaxation * a * a * (distance - ring.threshold) / mean_radius;
    return to_left ? -towards : towards;
  }

  double azimuth_at(const Primordium& one, double time) {
    const double end = std::min(time, one.until);
    if (!one.moving || end <= one.since) {
      return one.azimuth;
    }
    // Runge and Kutta's fourth order, always from the last whole step on: a pure function of time between events.
    const double span = end - one.since;
    const int steps = static_cast<int>(std::ceil(span / kLongestOdeStep - 1e-9));
    const double h = span / steps;
    double azimuth = one.azimuth;
    for (int i = 0; i < steps; ++i) {
      const double t = one.since + i * h;
      const double k1 = rate(one, t, azimuth);
      const double k2 = rate(one, t + 0.5 * h, azimuth + 0.5 * h * k1);
      const double k3 = rate(one, t + 0.5 * h, azimuth + 0.5 * h * k2);
      const double k4 = rate(one, t + h, azimuth + h * k3);
      azimuth += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return azimuth;
  }

  /// When a moving primordium leaves the mobile zone, if within (from, to].
  void find_end(std::uint32_t index, double from, double to) {
    Primordium& one = primordia_[index];
    const auto outside = [&](double time) {
      return profile_.s_from_material(time, one.u) >= params_.mobile_zone * profile_.ring(time);
    };
    if (!one.moving || one.until < 1.0 || !outside(to)) {
      return;
    }
    double low = std::max(from, one.since);
    double high = to;
    if (outside(low)) {
      high = low;
    }
    while (high - low > kSameTime) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) {
        break;
      }
      (outside(middle) ? high : low) = middle;
    }
    one.until = high;
  }

  void stop(std::uint32_t index, double time) {
    Primordium& one = primordia_[index];
    if (!one.moving) {
      return;
    }
    const double end = std::min(time, one.until);
    one.azimuth = azimuth_at(one, end);
    one.since = end;
    one.moving = false;
    record_[index].stable = moment(end, one.u, one.azimuth);
  }

  /// Brings a primordium to a time; true if it has come to rest.
  bool settle(std::uint32_t index, double time) {
    Primordium& one = primordia_[index];
    if (one.moving && one.until <= time) {
      stop(index, time);
    }
    if (one.moving) {
      one.azimuth = azimuth_at(one, time);
      one.since = time;
    }
    return !one.moving;
  }

  /// No more primordia appear; those that still move come to their end.
  void let_settle(double time) {
    while (time < 1.0 && !unsettled_.empty() && !error_) {
      const double end = std::min(1.0, time + params_.time_step);
      for (const std::uint32_t i : unsettled_) {
        find_end(i, time, end);
      }
      time = end;
      std::erase_if(unsettled_, [&](std::uint32_t i) { return settle(i, time); });
    }
  }

  // ---- arcs and gaps ------------------------------------------------------------------------------------------------

  Arc arc(const Ring& ring, std::uint32_t index) {
    const Primordium& one = primordia_[index];
    Arc arc;
    arc.primordium = index;
    arc.azimuth = azimuth_at(one, ring.time);
    const double s = profile_.s_from_material(ring.time, one.u);
    const double along = ring.length * (ring.s - s);
    const double rest = ring.threshold * ring.threshold - along * along;
    if (rest > 0.0) {
      const double mean_radius = 0.5 * (ring.radius + profile_.radius(ring.time, s));
      const double across = std::sqrt(rest);
      constexpr double kMost = 1e3;  // finite on the axis too; not cut at pi, for openings are looked for with it
      arc.half = across < kMost * mean_radius ? across / mean_radius : kMost;
    }
    return arc;
  }

  void find_arcs(const Ring& ring) {
    arcs_.clear();
    const double reach = ring.threshold / ring.length;
    for (const RingList::Entry& entry : order_.entries()) {
      const double s = profile_.s_from_material(ring.time, entry.material);
      if (s - ring.s >= reach) {
        break;
      }
      if (ring.s - s < reach) {
        arcs_.push_back(arc(ring, entry.primordium));
      }
    }
  }

  /// Gaps of the ring between the arcs.
  void find_gaps(const Ring& ring) {
    gaps_.clear();
    find_arcs(ring);
    if (arcs_.empty()) {
      const std::uint32_t newest = static_cast<std::uint32_t>(primordia_.size() - 1);
      gaps_.push_back({newest, newest, 0.0, math::kTurnRad, true});
      return;
    }
    double covered = -math::kTurnRad;
    std::uint32_t behind = 0;
    for (Arc& arc : arcs_) {
      if (arc.half >= math::kPi) {
        return;
      }
      arc.begin = one_turn(arc.azimuth - arc.half - params_.first_azimuth_rad);
      // What reaches over the end of the turn covers its beginning.
      const double end = arc.begin + 2.0 * arc.half - math::kTurnRad;
      if (end > covered) {
        covered = end;
        behind = arc.primordium;
      }
    }
    std::sort(arcs_.begin(), arcs_.end(), [](const Arc& a, const Arc& b) {
      return a.begin != b.begin ? a.begin < b.begin : a.primordium < b.primordium;
    });
    for (const Arc& arc : arcs_) {
      if (arc.begin > covered + kSameAngle) {
        gaps_.push_back({behind, arc.primordium, one_turn(covered), arc.begin - covered, false});
      }
      if (arc.begin + 2.0 * arc.half > covered) {
        covered = arc.begin + 2.0 * arc.half;
        behind = arc.primordium;
      }
    }
  }

  /// Width of the gap between two arcs, negative where they overlap, `turns` being what makes it continuous in time.
  double width(double time, const Gap& gap, double turns) {
    const Ring ring = ring_at(time);
    const Arc behind = arc(ring, gap.behind);
    const Arc ahead = gap.ahead == gap.behind ? behind : arc(ring, gap.ahead);
    return ahead.azimuth - behind.azimuth + turns - ahead.half - behind.half;
  }

  /// The time in [low, high] at which a gap open at `high` opens; `low` if it was open there.
  double opening(const Gap& gap, double low, double high) {
    double at_high = width(high, gap, 0.0);
    const double turns = math::kTurnRad * std::round((gap.width - at_high) / math::kTurnRad);
    at_high += turns;
    double at_low = width(low, gap, turns);
    if (at_low >= -kSameAngle || at_high <= 0.0) {
      return low;
    }
    int last_side = 0;
    // False position, halving the weight of an end that stays (the Illinois rule).
    for (int round = 0; round < 100 && high - low > kSameTime; ++round) {
      double middle = high - (high - low) * (at_high / (at_high - at_low));
      if (!(middle > low && middle < high)) {
        middle = 0.5 * (low + high);
      }
      const double here = width(middle, gap, turns);
      if (std::abs(here) < 1e-14) {
        return middle;
      }
      if (here < 0.0) {
        low = middle;
        at_low = here;
        at_high *= last_side == -1 ? 0.5 : 1.0;
        last_side = -1;
      } else {
        high = middle;
        at_high = here;
        at_low *= last_side == 1 ? 0.5 : 1.0;
        last_side = 1;
      }
    }
    return high;
  }

  /// Inserts all primordia of (from, to] one by one, each where and when the ring first becomes free.
  void advance(double from, double to) {
    double low = from;  // all is forbidden until here
    while (!error_ && low < to) {
      find_gaps(ring_at(to));
      if (gaps_.empty()) {
        return;
      }
      low = insert_first(low, to);
      if (!error_ && !report(progress_, "primordia", low)) {
        error_ = Error{ErrorCode::kCancelled, "", "cancelled"};
      }
    }
  }

  /// Narrows (low, high] down to the first opening, inserts there and returns its time. `gaps_` are those at `high`.
  double insert_first(double low, double high) {
    constexpr int kMostRounds = 200;  // halving takes 40; the rest is for arcs that jump
    for (int round = 0; round < kMostRounds && high - low > kSameTime && !error_; ++round) {
      Gap first = gaps_.front();
      double time = high;
      for (const Gap& gap : gaps_) {
        const double opened = gap.whole ? high : opening(gap, low, high);
        if (opened < time || (opened == time && gap.begin < first.begin)) {
          time = opened;
          first = gap;
        }
      }
      if (!first.whole) {
        const Ring ring = ring_at(time);
        find_gaps(ring);
        const bool others = std::any_of(gaps_.begin(), gaps_.end(), [&](const Gap& gap) {
          return gap.behind != first.behind || gap.ahead != first.ahead;
        });
        const double azimuth = end_of(ring, first.behind);
        if ((time <= low || !others) && free_of_others(azimuth, first)) {
          insert(ring, azimuth, first.behind, first.ahead);
          return time;
        }
        if (!gaps_.empty() && low < time && time < high) {
          high = time;  // others opened before
          continue;
        }
        if (gaps_.empty() && low < time) {
          low = time;  // these two arcs parted where a third still stood
        }
      }
      const double middle = 0.5 * (low + high);
      find_gaps(ring_at(middle));
      if (gaps_.empty()) {
        low = middle;
        find_gaps(ring_at(high));
      } else {
        high = middle;
      }
    }
    if (error_ || gaps_.empty()) {
      return high;
    }
    // A gap that had a width at once, as where the threshold jumps: its beginning.
    const Ring ring = ring_at(high);
    const Gap gap = gaps_.front();
    insert(ring, gap.whole ? params_.first_azimuth_rad : end_of(ring, gap.behind), gap.behind, gap.ahead);
    return high;
  }

  double end_of(const Ring& ring, std::uint32_t primordium) {
    const Arc one = arc(ring, primordium);
    return one.azimuth + one.half;
  }

  /// Whether the meeting point of two arcs is free of all others in `arcs_`.
  bool free_of_others(double azimuth, const Gap& gap) const {
    return std::none_of(arcs_.begin(), arcs_.end(), [&](const Arc& one) {
      return one.primordium != gap.behind && one.primordium != gap.ahead &&
             angle_between(one_turn(azimuth), one_turn(one.azimuth)) < one.half - kSameAngle;
    });
  }

  void insert(const Ring& ring, double azimuth, std::uint32_t behind, std::uint32_t ahead) {
    if (primordia_.size() >= params_.most_primordia) {
      error_ = Error{ErrorCode::kTooLarge, "threshold",
                     "must not let more primordia appear than " + std::to_string(params_.most_primordia)};
      return;
    }
    const std::uint32_t index = static_cast<std::uint32_t>(primordia_.size());
    Primordium one;
    one.u = std::max(0.0, profile_.material_from_s(ring.time, ring.s) - params_.lag);
    one.azimuth = azimuth;
    one.since = ring.time;
    one.left = behind;
    one.right = ahead;
    one.moving = index > 0;
    RingPrimordium record;
    record.born = {0, ring.time, ring.s, one_turn(azimuth), kind_of(profile_, params_, ring.time, ring.s)};
    record.stable = record.born;
    record.material = one.u;
    record.threshold = ring.threshold;
    record.neighbours = {behind, ahead};
    if (index > 0) {
      stop(behind, ring.time);
      stop(ahead, ring.time);
    }
    primordia_.push_back(one);
    record_.push_back(record);
    order_.insert(index, one.u);
    if (one.moving) {
      unsettled_.push_back(index);
      find_end(index, ring.time, std::min(1.0, ring.time + params_.time_step));
    }
    if (primordia_.size() > params_.threshold_frozen_above && !(frozen_ > 0.0)) {
      frozen_ = ring.threshold;
      rings_.fill({});
    }
  }

  double time_of_last_ring(double low, double high) const {
    while (high - low > kSameTime) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) {
        break;
      }
      (profile_.ring(middle) <= params_.last_ring ? high : low) = middle;
    }
    return high;
  }

  const GrowingProfile& profile_;
  const ActiveRingParams& params_;
  const Progress& progress_;
  std::vector<Primordium> primordia_;
  std::vector<RingPrimordium> record_;
  std::vector<std::uint32_t> unsettled_;
  RingList order_;
  std::vector<Arc> arcs_;
  std::vector<Gap> gaps_;
  std::array<Ring, 8> rings_{};
  std::size_t next_ring_ = 0;
  double frozen_ = 0.0;  ///< the threshold once it stands still
  std::optional<Error> error_;
};

}  // namespace

std::optional<Error> check(const ActiveRingParams& params, const GrowingProfile& profile) {
  if (!params.threshold) {
    return invalid_parameter("threshold", "must be a function", "none");
  }
  if (auto error = check_number("relaxation", params.relaxation, 0.0, 1e9)) {
    return error;
  }
  if (auto error = check_number("mobile_zone", params.mobile_zone, 1e-9, 1e9)) {
    return error;
  }
  if (auto error = check_number("lag", params.lag, 0.0, 0.1)) {
    return error;
  }
  if (auto error = check_number("last_ring", params.last_ring, 0.0, 1.0)) {
    return error;
  }
  if (!(params.first_azimuth_rad >= 0.0 && params.first_azimuth_rad < math::kTurnRad)) {
    return invalid_parameter("first_azimuth_rad", "must be in [0, 2 pi)", params.first_azimuth_rad);
  }
  if (!(params.time_step >= 1e-6 && params.time_step <= 0.1)) {
    return invalid_parameter("time_step", "must be between 1e-06 and 0.1", params.time_step);
  }
  if (!(params.angular_step_rad >= 1e-6 && params.angular_step_rad <= 1.0)) {
    return invalid_parameter("angular_step_rad", "must be between 1e-06 and 1", params.angular_step_rad);
  }
  for (const auto& [where, number] :
       {std::pair{"bract_landmark", params.bract_landmark}, std::pair{"trans_landmark", params.trans_landmark}}) {
    if (number > profile.landmarks()) {
      return invalid_parameter(where, "must be one of the profile's " + std::to_string(profile.landmarks()),
                               static_cast<double>(number));
    }
  }
  return std::nullopt;
}

PrimordiumKind kind_of(const GrowingProfile& profile, const ActiveRingParams& params, double time, double s) {
  if (params.bract_landmark > 0 && s > profile.landmark(time, params.bract_landmark)) {
    return PrimordiumKind::kBract;
  }
  if (params.trans_landmark > 0 && s > profile.landmark(time, params.trans_landmark)) {
    return PrimordiumKind::kTransFloret;
  }
  return PrimordiumKind::kFloret;
}

Expected<std::vector<RingPrimordium>> grow_active_ring(const GrowingProfile& profile, const ActiveRingParams& params,
                                                       const Progress& progress) {
  if (auto error = check(params, profile)) {
    return unexpected(*error);
  }
  return ContinuousRing(profile, params, progress).run();
}

}  // namespace anthesis
