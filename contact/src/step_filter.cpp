#include "step_filter.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "anthesis/base/parallel.h"
#include "anthesis/contact/growing_sheets.h"

namespace anthesis {
namespace {

// Of the room between two things each may use this share: together less than all of it.
constexpr double kShareOfRoom = 0.45;

// Two vertices that nobody saw near each other keep this much, more than half the least gap, each.
constexpr double kHalfGap_mm = 0.51 * kLeastGap_mm;

}  // namespace

void StepFilter::Shares::reset(std::size_t count) {
  share.assign(count, 1.0);
  changed.assign(count, 1);
  changes.assign(count, 0);
}

bool StepFilter::Shares::cut(std::uint32_t index, double to) {
  if (to >= share[index]) {
    return false;
  }
  share[index] = to;
  changes[index] = 1;
  return true;
}

/// What each vertex does beyond its body's ride, no farther than it looked around.
void StepFilter::split(std::span<const MovingBody> bodies, std::span<const double> reach,
                       std::span<const double> within_reach, std::span<const Vec3> from, std::span<const Vec3> to) {
  own_.resize(from.size());
  parallel_for(bodies.size(), [&](std::size_t b) {
    const MovingBody& body = bodies[b];
    const double ride = length(body.ride_mm);
    for (std::size_t i = body.first_vertex; i < body.end_vertex; ++i) {
      if (!body.relaxes) {
        own_[i] = {};
        continue;
      }
      own_[i] = to[i] - from[i] - body.ride_mm;
      const double most = std::max(0.0, std::min(within_reach[i], reach[i] - ride) - kHalfGap_mm);
      const double size = length(own_[i]);
      if (size > most) {
        own_[i] = (most / size) * own_[i];
      }
    }
  });
}

/// Whether the contact cut anything. Sets `held` when the two would meet.
bool StepFilter::check(const Contact& contact, bool& held, std::span<const MovingBody> bodies,
                       std::span<const Vec3> from) {
  const int firsts = contact.edges ? 2 : 1;
  const bool within = contact.first_body == contact.second_body;
  std::array<double, 4> height;  // of each vertex along the normal, from the first one's
  double nearest_first = 0.0;
  double nearest_second = 0.0;
  for (int k = 0; k < 4; ++k) {
    height[k] = dot(contact.normal, from[contact.vertices[k]] - from[contact.vertices[0]]);
    (k < firsts ? nearest_first : nearest_second) += contact.weights[k] * height[k];
  }
  nearest_second = -nearest_second;
  // How far each vertex lies behind the nearest point of its own side, and what it would do along the normal.
  std::array<double, 4> behind;
  std::array<double, 4> own;
  for (int k = 0; k < 4; ++k) {
    behind[k] = std::max(0.0, k < firsts ? height[k] - nearest_first : nearest_second - height[k]);
    own[k] = dot(contact.normal, own_[contact.vertices[k]]);
  }
  const double first_ride = within ? 0.0 : dot(contact.normal, bodies[contact.first_body].ride_mm);
  const double second_ride = within ? 0.0 : dot(contact.normal, bodies[contact.second_body].ride_mm);
  const double room = std::max(0.0, contact.gap_mm - kLeastGap_mm);
  double first_low = std::numeric_limits<double>::infinity();
  double second_high = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 4; ++k) {
    const double moved = own_shares_.share[contact.vertices[k]] * own[k];
    if (k < firsts) {
      first_low = std::min(first_low, behind[k] + moved);
    } else {
      second_high = std::max(second_high, moved - behind[k]);
    }
  }
  first_low += ride_shares_.share[contact.first_body] * first_ride;
  second_high += ride_shares_.share[contact.second_body] * second_ride;
  // A plane between the two that moves along with them: they may close in on each other, not on the plane's place.
  if (second_high - first_low <= 2.0 * kShareOfRoom * room) {
    return false;
  }
  // They would meet: from now on the plane stands still (or rides with the body, for parts of one), and each keeps to
  // its side of it: its ride and its own move to half of that each, where there is a ride.
  held = true;
  bool cut = false;
  const double allowed = kShareOfRoom * room;
  const auto cut_ride = [&](std::uint32_t body, double towards) {
    if (towards > 0.0 && towards * ride_shares_.share[body] > 0.5 * allowed) {
      cut = ride_shares_.cut(body, 0.5 * allowed / towards) || cut;
    }
  };
  if (!within) {
    cut_ride(contact.first_body, -first_ride);
    cut_ride(contact.second_body, second_ride);
  }
  for (int k = 0; k < 4; ++k) {
    const double towards = k < firsts ? -own[k] : own[k];
    const bool rides = !within && (k < firsts ? -first_ride : second_ride) > 0.0;
    const double most = (rides ? 0.5 : 1.0) * allowed + behind[k];
    if (towards * own_shares_.share[contact.vertices[k]] > most) {
      cut = own_shares_.cut(contact.vertices[k], most / towards) || cut;
    }
  }
  return cut;
}

std::uint64_t StepFilter::apply(std::span<const Contact> contacts, std::span<const MovingBody> bodies,
                                std::span<const double> reach, std::span<const double> within_reach,
                                std::span<const Vec3> from, std::span<Vec3> to) {
  split(bodies, reach, within_reach, from, to);
  own_shares_.reset(from.size());
  ride_shares_.reset(bodies.size());
  held_.assign(contacts.size(), 0);
  for (bool again = true; again;) {
    again = false;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const Contact& contact = contacts[c];
      const auto& v = contact.vertices;
      const auto& changed = own_shares_.changed;
      if (held_[c] || !(changed[v[0]] | changed[v[1]] | changed[v[2]] | changed[v[3]] |
                        ride_shares_.changed[contact.first_body] | ride_shares_.changed[contact.second_body])) {
        continue;
      }
      bool held = false;
      again = check(contact, held, bodies, from) || again;
      held_[c] = held;
    }
    for (Shares* shares : {&own_shares_, &ride_shares_}) {
      std::swap(shares->changed, shares->changes);
      std::fill(shares->changes.begin(), shares->changes.end(), std::uint8_t{0});
    }
  }
  std::uint64_t shortened = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const MovingBody& body = bodies[b];
    for (std::size_t i = body.first_vertex; i < body.end_vertex; ++i) {
      const bool cut = own_shares_.share[i] < 1.0 || ride_shares_.share[b] < 1.0;
      shortened += cut ? 1 : 0;
      to[i] = from[i] + (ride_shares_.share[b] * body.ride_mm + own_shares_.share[i] * own_[i]);
    }
  }
  return shortened;
}

}  // namespace anthesis
