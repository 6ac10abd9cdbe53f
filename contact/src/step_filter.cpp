#include "step_filter.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
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

Vec3 beside_way(Vec3 move, Vec3 way) {
  const double square = dot(way, way);
  return square > 0.0 ? move - std::clamp(dot(move, way) / square, 0.0, 1.0) * way : move;
}

/// What each vertex does beyond its body's ride, no farther beside its way than it looked around.
void StepFilter::split(std::span<const MovingBody> bodies, const Lookout& lookout, std::span<const Vec3> from,
                       std::span<const Vec3> to) {
  own_.resize(from.size());
  parallel_for(bodies.size(), [&](std::size_t b) {
    const MovingBody& body = bodies[b];
    for (std::size_t i = body.first_vertex; i < body.end_vertex; ++i) {
      if (!body.relaxes) {
        own_[i] = {};
        continue;
      }
      own_[i] = to[i] - from[i] - body.ride_mm;
      const Vec3 beside = beside_way(own_[i], lookout.way_mm.empty() ? Vec3{} : lookout.way_mm[i]);
      const double most = std::max(0.0, std::min(lookout.within_reach_mm[i], lookout.reach_mm[i]) - kHalfGap_mm);
      const double size = length(beside);
      if (size > most) {
        own_[i] = (own_[i] - beside) + (most / size) * beside;
      }
    }
  });
}

/// Where the vertices of a contact are along its normal, and what they would do.
StepFilter::Along StepFilter::along(const Contact& contact, std::span<const MovingBody> bodies,
                                    std::span<const Vec3> from) const {
  const int firsts = contact.edges ? 2 : 1;
  std::array<double, 4> height;  // from the first vertex's
  double nearest_first = 0.0;
  double nearest_second = 0.0;
  for (int k = 0; k < 4; ++k) {
    height[k] = dot(contact.normal, from[contact.vertices[k]] - from[contact.vertices[0]]);
    (k < firsts ? nearest_first : nearest_second) += contact.weights[k] * height[k];
  }
  nearest_second = -nearest_second;
  Along line;
  for (int k = 0; k < 4; ++k) {
    line.behind[k] = std::max(0.0, k < firsts ? height[k] - nearest_first : nearest_second - height[k]);
    line.own[k] = dot(contact.normal, own_[contact.vertices[k]]);
  }
  if (contact.first_body != contact.second_body) {
    line.first_ride = dot(contact.normal, bodies[contact.first_body].ride_mm);
    line.second_ride = dot(contact.normal, bodies[contact.second_body].ride_mm);
  }
  line.room = std::max(0.0, contact.gap_mm - kLeastGap_mm);
  return line;
}

/// Whether the two would meet, or come so near that it cannot be ruled out: there is no plane between them that moves
/// along with them. They may close in on each other, not on the plane's place.
bool StepFilter::would_meet(const Contact& contact, const Along& line) const {
  const int firsts = contact.edges ? 2 : 1;
  double first_low = std::numeric_limits<double>::infinity();
  double second_high = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 4; ++k) {
    const double moved = own_shares_.share[contact.vertices[k]] * line.own[k];
    if (k < firsts) {
      first_low = std::min(first_low, line.behind[k] + moved);
    } else {
      second_high = std::max(second_high, moved - line.behind[k]);
    }
  }
  first_low += ride_shares_.share[contact.first_body] * line.first_ride;
  second_high += ride_shares_.share[contact.second_body] * line.second_ride;
  return second_high - first_low > 2.0 * kShareOfRoom * line.room;
}

/// From now on the plane stands still (or rides with the body, for parts of one), and each keeps to its side of it: its
/// ride and its own move to half of that each, where there is a ride. Returns whether anything was cut.
bool StepFilter::hold(const Contact& contact, const Along& line) {
  const int firsts = contact.edges ? 2 : 1;
  bool cut = false;
  const double allowed = kShareOfRoom * line.room;
  const auto cut_ride = [&](std::uint32_t body, double towards) {
    if (towards > 0.0 && towards * ride_shares_.share[body] > 0.5 * allowed) {
      cut = ride_shares_.cut(body, 0.5 * allowed / towards) || cut;
    }
  };
  cut_ride(contact.first_body, -line.first_ride);
  cut_ride(contact.second_body, line.second_ride);
  for (int k = 0; k < 4; ++k) {
    const double towards = k < firsts ? -line.own[k] : line.own[k];
    const bool rides = (k < firsts ? -line.first_ride : line.second_ride) > 0.0;
    const double most = (rides ? 0.5 : 1.0) * allowed + line.behind[k];
    if (towards * own_shares_.share[contact.vertices[k]] > most) {
      cut = own_shares_.cut(contact.vertices[k], most / towards) || cut;
    }
  }
  return cut;
}

std::uint64_t StepFilter::apply(std::span<const Contact> contacts, std::span<const MovingBody> bodies,
                                const Lookout& lookout, std::span<const Vec3> from, std::span<Vec3> to) {
  split(bodies, lookout, from, to);
  own_shares_.reset(from.size());
  ride_shares_.reset(bodies.size());
  held_.assign(contacts.size(), 0);
  constexpr std::size_t kChunk = 4096;
  meeting_.resize((contacts.size() + kChunk - 1) / kChunk);
  for (bool again = true; again;) {
    // Who would meet with the shares as they are; then, in order, whatever that cuts.
    parallel_for(meeting_.size(), [&](std::size_t chunk) {
      meeting_[chunk].clear();
      for (std::size_t c = chunk * kChunk; c < std::min(contacts.size(), (chunk + 1) * kChunk); ++c) {
        const Contact& contact = contacts[c];
        const auto& v = contact.vertices;
        const auto& changed = own_shares_.changed;
        const bool ask =
            !held_[c] && (changed[v[0]] | changed[v[1]] | changed[v[2]] | changed[v[3]] |
                          ride_shares_.changed[contact.first_body] | ride_shares_.changed[contact.second_body]) != 0;
        if (ask && would_meet(contact, along(contact, bodies, from))) {
          meeting_[chunk].push_back(static_cast<std::uint32_t>(c));
        }
      }
    });
    again = false;
    for (const std::vector<std::uint32_t>& found : meeting_) {
      for (const std::uint32_t c : found) {
        held_[c] = 1;
        again = hold(contacts[c], along(contacts[c], bodies, from)) || again;
      }
    }
    for (Shares* shares : {&own_shares_, &ride_shares_}) {
      std::swap(shares->changed, shares->changes);
      std::fill(shares->changes.begin(), shares->changes.end(), std::uint8_t{0});
    }
  }
  shortened_.assign(bodies.size(), 0);
  parallel_for(bodies.size(), [&](std::size_t b) {
    const MovingBody& body = bodies[b];
    for (std::size_t i = body.first_vertex; i < body.end_vertex; ++i) {
      shortened_[b] += own_shares_.share[i] < 1.0 || ride_shares_.share[b] < 1.0 ? 1 : 0;
      to[i] = from[i] + (ride_shares_.share[b] * body.ride_mm + own_shares_.share[i] * own_[i]);
    }
  });
  return std::accumulate(shortened_.begin(), shortened_.end(), std::uint64_t{0});
}

}  // namespace anthesis
