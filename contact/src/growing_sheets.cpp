#include "anthesis/contact/growing_sheets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"
#include "anthesis/contact/continuous.h"
#include "anthesis/contact/detector.h"
#include "anthesis/contact/elastic_batch.h"
#include "step_filter.h"

namespace anthesis {
namespace {

constexpr int kMaxPieces = 400;          // of one step: beyond that, longer moves
constexpr double kLongestRide_mm = 0.1;  // that what a body stands on may move in one pass
constexpr double kOverRelaxation = 1.3;  // of contacts: their corrections are averaged, which is slow
constexpr double kWithinShare = 0.1;     // of its mean edge that parts of an organ keep between them at most
constexpr double kCrowdedShare = 0.7;    // of the spacing: what is nearer to something that moves wakes
constexpr double kLeaningShare = 1.2;    // of the spacing: what is nearer may lean on the other
constexpr double kPressedShare = 0.3;    // of the spacing: a sleeper that something wants to move into so far wakes
constexpr double kSlackShare = 0.2;      // of the thickness that relaxation may move a vertex beyond its growth
constexpr double kStillShare = 0.03;     // of its mean edge that an organ at rest moves at most
constexpr double kRoomToMove = 1.05;     // relaxation may add to growth
constexpr std::size_t kChunk = 2048;     // contacts that are looked at together
constexpr double kSmallestScale = 1.0 / 1024.0;

/// What a body does in a pass.
enum class Role : std::uint8_t {
  kRests,    ///< nothing
  kRides,    ///< it moves as one piece with what it stands on
  kRelaxes,  ///< it grows, bends and gives way
};

double mean_edge_mm(const Sheet& sheet, std::span<const Vec3> places) {
  double sum = 0.0;
  for (const auto& [a, b] : sheet.edges) {
    sum += length(places[b] - places[a]);
  }
  return sheet.edges.empty() ? 0.0 : sum / static_cast<double>(sheet.edges.size());
}

struct Box {
  Vec3 low{1e300, 1e300, 1e300};
  Vec3 high{-1e300, -1e300, -1e300};
};

Box box_of(std::span<const Vec3> places) {
  Box box;
  for (const Vec3 p : places) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

bool overlap(const Box& a, const Box& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

}  // namespace

struct GrowingSheets::State {
  std::vector<Sheet> sheets;
  GrowingOptions options;
  Detector detector;
  std::vector<ElasticBatch> batches;  ///< by sheet

  std::vector<GrowingBody> bodies;
  std::vector<std::uint32_t> first;  ///< vertex of each body, and the end of the last
  std::vector<std::uint8_t> awake;
  std::vector<std::uint8_t> bent;  ///< by body, as far as passes have seen them: not as its target is
  std::vector<double> edge;        ///< mean edge of each body's target
  std::vector<Vec3> positions;
  std::vector<Vec3> targets;

  // What the next pass is to do, by body.
  std::vector<Vec3> next;           ///< by vertex: the targets after it
  std::vector<std::uint8_t> moves;  ///< by body: its target moves beyond its ride
  std::vector<Vec3> ride;           ///< by body

  // Work space of a pass, kept to save allocations.
  std::vector<Role> role;
  std::vector<Vec3> proposal;
  std::vector<ContactBody> scene;
  std::vector<MovingBody> moving;
  std::vector<Vec3> carried;           ///< by vertex: where growth alone would have taken it
  std::vector<Vec3> way;               ///< by vertex: what growth wants of it beyond its ride
  std::vector<double> wanted;          ///< by vertex: how far beside its way it would have gone in the last pass
  std::vector<double> wanted_in_all;   ///< and how far beyond its ride
  std::vector<double> reach;           ///< by vertex: how far it looks for others, besides its way and ride
  std::vector<double> within_reach;    ///< and for parts of its own body
  std::vector<double> within_spacing;  ///< by body: what its own parts want to keep between them
  std::vector<Contact> contacts;
  std::vector<double> spacing;  ///< that each contact wants to keep
  /// When a contact is to be looked at: once its bodies together have moved so far. Until then it cannot press.
  struct Alarm {
    double due_mm = 0.0;
    std::uint32_t first_body = 0;
    std::uint32_t second_body = 0;
  };
  std::vector<Alarm> alarms;     ///< by contact
  std::vector<double> short_by;  ///< by contact: how much nearer the two are than they want to be, or 0
  /// Contacts one after the other that are of the same bodies.
  struct Run {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
    std::uint32_t first_body = 0;
    std::uint32_t second_body = 0;
  };
  std::vector<std::vector<Run>> runs;             ///< by chunk
  std::vector<std::vector<Run>> runs_of;          ///< by body that is not fixed
  std::vector<double> clock;                      ///< by body: how far its vertices have moved in this pass, at most
  std::vector<Vec3> seen;                         ///< by vertex: where it was when the clock was set
  std::vector<Vec3> push;                         ///< by vertex: sum of what its contacts want
  std::vector<std::uint32_t> pushes;              ///< by vertex: how many do; 0 between sweeps
  std::vector<double> moved;                      ///< by body: longest move of the pass beyond growth
  std::vector<std::uint8_t> pressed;              ///< by body: asleep, and something wants to be where it is
  std::vector<double> travelled;                  ///< by body: longest move of the pass beyond its ride
  std::vector<std::vector<std::uint32_t>> woken;  ///< bodies, by chunk of contacts
  StepFilter filter;

  State(std::vector<Sheet> all, const GrowingOptions& chosen)
      : sheets(std::move(all)), options(chosen), detector(sheets), first{0} {
    for (const Sheet& sheet : sheets) {
      batches.emplace_back(sheet);
    }
  }

  std::size_t vertex_count(std::size_t body) const { return first[body + 1] - first[body]; }
  /// What counts as no move: the residual, less for organs that are still tiny.
  double still(std::size_t body) const { return std::min(options.residual_mm, kStillShare * edge[body]); }
  template <class V>
  auto of(std::size_t body, V& places) const {
    return std::span(places).subspan(first[body], vertex_count(body));
  }
  std::vector<std::uint32_t> crossed_by(std::size_t body, bool& itself) const;
  bool mobile(std::size_t body) const { return role[body] == Role::kRelaxes && !bodies[body].fixed; }
  void pass(GrowthStep& step);
  void carry();
  void find_contacts();
  void relax();
  double missing(std::size_t contact) const;
  void set_alarms();
  void advance_clocks();
  void look_for_pressure();
  void push_apart(std::uint32_t body);
  void press(std::uint32_t contact, std::uint32_t body);
  double take_up();
};

GrowingSheets::GrowingSheets(std::vector<Sheet> sheets, const GrowingOptions& options)
    : state_(std::make_unique<State>(std::move(sheets), options)) {}
GrowingSheets::GrowingSheets(GrowingSheets&&) noexcept = default;
GrowingSheets& GrowingSheets::operator=(GrowingSheets&&) noexcept = default;
GrowingSheets::~GrowingSheets() = default;

void GrowingSheets::set_thickness(std::size_t index, double thickness_mm) {
  state_->bodies[index].thickness_mm = std::max(thickness_mm, 2.0 * kLeastGap_mm);
}

std::size_t GrowingSheets::body_count() const {
  return state_->bodies.size();
}
const GrowingBody& GrowingSheets::body(std::size_t index) const {
  return state_->bodies[index];
}
std::uint32_t GrowingSheets::first_vertex(std::size_t index) const {
  return state_->first[index];
}
std::span<const Sheet> GrowingSheets::sheets() const {
  return state_->sheets;
}
std::span<const Vec3> GrowingSheets::positions_mm() const {
  return state_->positions;
}
std::span<const Vec3> GrowingSheets::targets_mm() const {
  return state_->targets;
}

/// The bodies that cross the last one, among those whose boxes meet its box.
std::vector<std::uint32_t> GrowingSheets::State::crossed_by(std::size_t body, bool& itself) const {
  const Box own = box_of(of(body, positions));
  std::vector<Vec3> places;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> owner;
  for (std::size_t other = 0; other <= body; ++other) {
    if (other != body && !overlap(own, box_of(of(other, positions)))) {
      continue;
    }
    for (const Triangle& t : sheets[bodies[other].sheet].triangles) {
      const std::array<Vec3, 3> corners{positions[first[other] + t[0]], positions[first[other] + t[1]],
                                        positions[first[other] + t[2]]};
      if (other != body && !overlap(own, box_of(corners))) {
        continue;
      }
      const auto corner = static_cast<std::uint32_t>(places.size());
      places.insert(places.end(), corners.begin(), corners.end());
      triangles.push_back({corner, corner + 1, corner + 2});
      owner.push_back(static_cast<std::uint32_t>(other));
    }
  }
  std::vector<std::uint32_t> found;
  itself = false;
  const auto report = find_crossings(places, triangles, triangles.size());
  for (const Crossing& crossing : report->crossings) {
    const std::uint32_t a = owner[crossing.first];
    const std::uint32_t b = owner[crossing.second];
    if (a == body && b == body) {
      itself = true;
    } else if (a == body || b == body) {
      found.push_back(a == body ? b : a);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

GrowingSheets::Entry GrowingSheets::enter(const GrowingBody& body, std::span<const Vec3> positions_mm,
                                          Vec3 attachment_mm) {
  State& state = *state_;
  ANTHESIS_ASSERT(body.sheet < state.sheets.size());
  ANTHESIS_ASSERT(positions_mm.size() == state.sheets[body.sheet].vertex_count);
  const std::size_t index = state.bodies.size();
  state.bodies.push_back(body);
  state.positions.insert(state.positions.end(), positions_mm.begin(), positions_mm.end());
  state.first.push_back(static_cast<std::uint32_t>(state.positions.size()));
  Entry entry;
  for (double scale = 1.0; scale >= kSmallestScale; scale *= 0.5) {
    for (std::size_t i = 0; i < positions_mm.size(); ++i) {
      state.positions[state.first[index] + i] =
          scale == 1.0 ? positions_mm[i] : attachment_mm + scale * (positions_mm[i] - attachment_mm);
    }
    entry.in_place = state.crossed_by(index, entry.crosses_itself);
    if (entry.crosses_itself) {
      break;
    }

    if (entry.in_place.empty()) {
      entry.scale = scale;
      state.awake.push_back(1);
      state.targets.insert(state.targets.end(), state.positions.begin() + state.first[index], state.positions.end());
      return entry;
    }
  }
  state.bodies.pop_back();
  state.first.pop_back();
  state.positions.resize(state.first.back());
  return entry;
}

Expected<GrowthStep> GrowingSheets::advance(std::span<const Vec3> targets_mm, const Progress& progress) {
  State& state = *state_;
  ANTHESIS_ASSERT(targets_mm.size() == state.positions.size());
  const std::size_t count = state.bodies.size();
  // What carries the bodies, the growth of what they stand on, moves all of them together, in as many pieces as the
  // longest carriage wants. What they do beyond that takes as many pieces as each wants, a multiple of those; slow
  // bodies rest in between.
  std::vector<Vec3> carriage(count);
  std::vector<double> own(count, 0.0);
  state.edge.resize(count);
  parallel_for(count, [&](std::size_t b) {
    const Sheet& sheet = state.sheets[state.bodies[b].sheet];
    state.edge[b] = mean_edge_mm(sheet, targets_mm.subspan(state.first[b]));
    for (const std::uint32_t i : sheet.attached) {
      carriage[b] += targets_mm[state.first[b] + i] - state.targets[state.first[b] + i];
    }
    carriage[b] = carriage[b] / std::max(1.0, static_cast<double>(sheet.attached.size()));
    for (std::size_t i = state.first[b]; i < state.first[b + 1]; ++i) {
      own[b] = std::max(own[b], length(targets_mm[i] - state.targets[i] - carriage[b]));
    }
  });
  double longest_carriage = 0.0;
  for (std::size_t b = 0; b < count; ++b) {
    longest_carriage = std::max(longest_carriage, length(carriage[b]));
  }
  const auto pieces_of = [](double way, double most) {
    return static_cast<int>(std::clamp(std::ceil(way / most), 1.0, static_cast<double>(kMaxPieces)));
  };
  const int rides = pieces_of(longest_carriage, kLongestRide_mm);
  std::vector<int> pieces(count, rides);
  int rounds = longest_carriage > 0.0 ? rides : 0;
  for (std::size_t b = 0; b < count; ++b) {
    const GrowingBody& body = state.bodies[b];
    if (!body.fixed) {
      pieces[b] = pieces_of(own[b], std::max(state.options.piece * state.edge[b], 0.5 * body.thickness_mm));
    }
    rounds = std::max(rounds, own[b] > 0.0 ? pieces[b] : 0);
  }
  const std::vector<Vec3> begin = state.targets;
  state.next = state.targets;
  state.wanted_in_all = state.wanted;  // a snapshot knows no more
  GrowthStep step;
  for (int round = 0; round < rounds; ++round) {
    if (!report(progress, "collisions", static_cast<double>(round) / (rounds + state.options.settling_passes))) {
      return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
    }
    // Shares of the way after this round; 0 to 1, whole at the end.
    const auto share_after = [&](int r, int of) { return static_cast<double>(std::int64_t{r} * of / rounds) / of; };
    const double ride = share_after(round + 1, rides);
    const double ride_now = ride - share_after(round, rides);
    state.ride.assign(count, Vec3{});
    state.moves.assign(count, 0);
    parallel_for(count, [&](std::size_t b) {
      const double share = share_after(round + 1, pieces[b]);
      state.moves[b] = share != share_after(round, pieces[b]) && own[b] > 0.0;
      const bool is_carried = ride_now > 0.0 && carriage[b] != Vec3{};
      if (is_carried && state.bodies[b].fixed) {
        state.moves[b] = 1;  // what pushes the others moves vertex by vertex
      } else if (is_carried) {
        state.ride[b] = ride_now * carriage[b];
      }
      if (state.moves[b] || is_carried) {
        for (std::size_t i = state.first[b]; i < state.first[b + 1]; ++i) {
          state.next[i] = round + 1 == rounds
                              ? targets_mm[i]
                              : begin[i] + share * (targets_mm[i] - begin[i] - carriage[b]) + ride * carriage[b];
        }
      }
    });
    state.pass(step);
  }
  state.ride.assign(count, Vec3{});
  state.moves.assign(count, 0);
  for (int k = 0; k < state.options.settling_passes && std::count(state.awake.begin(), state.awake.end(), 1) > 0; ++k) {
    if (!report(progress, "collisions", static_cast<double>(rounds + k) / (rounds + state.options.settling_passes))) {
      return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
    }
    state.pass(step);
  }
  return step;
}

/// One pass: targets go on to `next`, and bodies with them; those that move by themselves or were not at rest relax
/// under contact; what comes of it is cut short so that nothing crosses.
void GrowingSheets::State::pass(GrowthStep& step) {
  carry();
  find_contacts();
  relax();
  // Where relaxation led to in this pass it will lead to in the next one: look as far then, within limits.
  parallel_for(bodies.size(), [&](std::size_t b) {
    const double most = options.piece * edge[b];
    for (std::size_t i = first[b]; i < first[b + 1]; ++i) {
      const Vec3 own = mobile(b) ? proposal[i] - positions[i] - ride[b] : Vec3{};
      wanted[i] = std::min(most, length(beside_way(own, way[i])));
      wanted_in_all[i] = std::min(most, length(own));
    }
  });
  step.shortened += filter.apply(contacts, moving, {way, reach, within_reach}, positions, proposal);
  step.residual_mm = take_up();
  step.contacts += contacts.size();
  ++step.passes;
}

/// Moves bodies along with their targets, decides what each does in this pass, and how far it has to look around.
void GrowingSheets::State::carry() {
  const std::size_t count = bodies.size();
  proposal = positions;
  role.resize(count);
  scene.resize(count);
  moving.resize(count);
  within_spacing.resize(count);
  carried.resize(positions.size());
  wanted.resize(positions.size(), 0.0);
  wanted_in_all.resize(positions.size(), 0.0);
  way.resize(positions.size());
  reach.resize(positions.size());
  within_reach.resize(positions.size());
  parallel_for(count, [&](std::size_t b) {
    const bool rides = ride[b] != Vec3{};
    role[b] = moves[b] || awake[b] ? Role::kRelaxes : rides ? Role::kRides : Role::kRests;
    for (std::size_t i = first[b]; (moves[b] || rides) && i < first[b + 1]; ++i) {
      proposal[i] += moves[b] ? next[i] - targets[i] : ride[b];
      targets[i] = next[i];
    }
    std::copy(proposal.begin() + first[b], proposal.begin() + first[b + 1], carried.begin() + first[b]);
    const double slack = kSlackShare * bodies[b].thickness_mm;
    // Parts of one organ lie nearer to each other than organs do; only small ones must not stick to themselves.
    within_spacing[b] = std::min(bodies[b].thickness_mm, kWithinShare * edge[b]);
    const double least_reach = 0.5 * bodies[b].thickness_mm + slack;
    const double least_within = bodies[b].fixed ? least_reach : 0.5 * within_spacing[b] + slack;
    const bool relaxes = role[b] == Role::kRelaxes;
    // The parts of what only rides keep their distances.
    scene[b] = {bodies[b].sheet, first[b], least_reach, {}, role[b] != Role::kRests, relaxes && !bodies[b].fixed, true};
    scene[b].ride_mm = ride[b];
    scene[b].within_less_mm = least_reach - least_within;
    moving[b] = {first[b], first[b + 1], ride[b], relaxes};
    if (!relaxes) {
      return;
    }
    for (std::size_t i = first[b]; i < first[b + 1]; ++i) {
      if (bodies[b].fixed) {
        // What it could not do before it makes up for, little by little.
        const Vec3 behind = targets[i] - proposal[i];
        const double size = length(behind);
        proposal[i] += size > kLongestRide_mm ? std::max(0.5, kLongestRide_mm / size) * behind : behind;
      }
      way[i] = proposal[i] - positions[i] - ride[b];
      const double before = moves[b] ? wanted[i] : wanted_in_all[i];
      const double beside = kRoomToMove * before + (kRoomToMove - 1.0) * length(way[i]);
      within_reach[i] = least_within + beside;
      reach[i] = least_reach + beside;
    }
    scene[b].vertex_reach_mm = of(b, reach);
    scene[b].vertex_way_mm = of(b, way);
  });
}

/// Takes the proposal for the new state and finds out who is awake after it. Returns the longest move beyond growth.
double GrowingSheets::State::take_up() {
  const std::size_t count = bodies.size();
  moved.assign(count, 0.0);
  travelled.assign(count, 0.0);
  bent.resize(count, 0);
  parallel_for(count, [&](std::size_t b) {
    if (role[b] == Role::kRests) {
      return;
    }
    double bend = 0.0;
    for (std::size_t i = first[b]; i < first[b + 1]; ++i) {
      moved[b] = std::max(moved[b], length(proposal[i] - carried[i]));
      travelled[b] = std::max(travelled[b], length(proposal[i] - positions[i] - ride[b]));
      bend = std::max(bend, length(proposal[i] - targets[i]));
      positions[i] = proposal[i];
    }
    bent[b] = bend > still(b);
  });
  double longest = 0.0;
  for (std::size_t b = 0; b < count; ++b) {
    // What growth alone would have taken to the same place is at rest.
    awake[b] = moved[b] > still(b) || pressed[b];
    longest = std::max(longest, moved[b]);
  }
  // A body wakes when it is crowded by one that moves or rides, and when one leaves that it leans on.
  const auto wakes = [&](std::uint32_t sleeper, std::uint32_t other, double nearness) {
    if (bodies[sleeper].fixed || awake[sleeper]) {
      return false;
    }
    const bool stirs = travelled[other] > still(other);
    const bool crowded = nearness < kCrowdedShare && (stirs || role[other] == Role::kRides);
    return crowded || (nearness < kLeaningShare && stirs && bent[sleeper]);
  };
  woken.resize((contacts.size() + kChunk - 1) / kChunk);
  parallel_for(woken.size(), [&](std::size_t chunk) {
    woken[chunk].clear();
    for (std::size_t c = chunk * kChunk; c < std::min(contacts.size(), (chunk + 1) * kChunk); ++c) {
      const Contact& contact = contacts[c];
      const double nearness = contact.gap_mm / spacing[c];
      if (contact.first_body == contact.second_body || nearness >= kLeaningShare) {
        continue;
      }
      if (wakes(contact.first_body, contact.second_body, nearness)) {
        woken[chunk].push_back(contact.first_body);
      }
      if (wakes(contact.second_body, contact.first_body, nearness)) {
        woken[chunk].push_back(contact.second_body);
      }
    }
  });
  for (const std::vector<std::uint32_t>& found : woken) {
    for (const std::uint32_t b : found) {
      awake[b] = 1;
    }
  }
  return longest;
}

void GrowingSheets::State::find_contacts() {
  detector.find_near(positions, scene, contacts);
  spacing.resize(contacts.size());
  parallel_for((contacts.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    for (std::size_t c = chunk * kChunk; c < std::min(contacts.size(), (chunk + 1) * kChunk); ++c) {
      const Contact& contact = contacts[c];
      if (contact.first_body != contact.second_body) {
        spacing[c] = 0.5 * (bodies[contact.first_body].thickness_mm + bodies[contact.second_body].thickness_mm);
        continue;
      }
      spacing[c] = within_spacing[contact.first_body];
      if (contact.gap_mm < 1.5 * spacing[c]) {
        // Parts of one organ may be meant to lie nearer than its thickness: a pointed tip, a narrow tube.
        std::array<Vec3, 4> rest;
        for (int k = 0; k < 4; ++k) {
          rest[k] = targets[contact.vertices[k]];
        }
        const Nearest nearest = contact.edges ? nearest_edge_edge(rest) : nearest_vertex_triangle(rest);
        spacing[c] = std::min(spacing[c], 0.9 * nearest.distance);
      }
    }
  });
}

void GrowingSheets::State::relax() {
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    std::vector<std::uint32_t> chosen;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies[b].sheet == s && mobile(b)) {
        chosen.push_back(first[b]);
      }
    }
    batches[s].set_rest(targets, chosen);
  }
  pressed.assign(bodies.size(), 0);
  push.resize(positions.size());
  pushes.resize(positions.size(), 0);
  set_alarms();
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    for (ElasticBatch& batch : batches) {
      batch.load(proposal);
      batch.settle(1);
      batch.store(proposal);
    }
    advance_clocks();
    look_for_pressure();
    parallel_for(bodies.size(), [&](std::size_t b) { push_apart(static_cast<std::uint32_t>(b)); });
  }
}

/// How much nearer than they want to be the two of a contact would be; negative if they are farther apart.
inline double GrowingSheets::State::missing(std::size_t index) const {
  const Contact& contact = contacts[index];
  Vec3 apart{};
  for (int k = 0; k < 4; ++k) {
    apart += contact.weights[k] * proposal[contact.vertices[k]];
  }
  return spacing[index] - dot(contact.normal, apart);
}

/// All contacts are to be looked at first of all, but for those between bodies that stay where they are.
void GrowingSheets::State::set_alarms() {
  alarms.resize(contacts.size());
  short_by.resize(contacts.size());
  runs.resize((contacts.size() + kChunk - 1) / kChunk);
  parallel_for(runs.size(), [&](std::size_t chunk) {
    runs[chunk].clear();
    for (std::size_t c = chunk * kChunk; c < std::min(contacts.size(), (chunk + 1) * kChunk); ++c) {
      const auto [low, high] = std::minmax(contacts[c].first_body, contacts[c].second_body);
      const bool matters = mobile(low) || mobile(high);
      alarms[c] = {matters ? 0.0 : std::numeric_limits<double>::infinity(), low, high};
      short_by[c] = 0.0;
      if (runs[chunk].empty() || runs[chunk].back().first_body != low || runs[chunk].back().second_body != high) {
        runs[chunk].push_back({static_cast<std::uint32_t>(c), 0, low, high});
      }
      runs[chunk].back().end = static_cast<std::uint32_t>(c + 1);
    }
  });
  runs_of.resize(bodies.size());
  for (std::vector<Run>& of_body : runs_of) {
    of_body.clear();
  }
  for (const std::vector<Run>& of_chunk : runs) {
    for (const Run& run : of_chunk) {
      if (!bodies[run.first_body].fixed) {
        runs_of[run.first_body].push_back(run);
      }
      if (run.first_body != run.second_body && !bodies[run.second_body].fixed) {
        runs_of[run.second_body].push_back(run);
      }
    }
  }
  clock.assign(bodies.size(), 0.0);
  seen = proposal;
}

void GrowingSheets::State::advance_clocks() {
  parallel_for(bodies.size(), [&](std::size_t b) {
    double farthest = 0.0;
    for (std::size_t i = first[b]; mobile(b) && i < first[b + 1]; ++i) {
      const Vec3 way_of_vertex = proposal[i] - seen[i];
      farthest = std::max(farthest, dot(way_of_vertex, way_of_vertex));
      seen[i] = proposal[i];
    }
    clock[b] += std::sqrt(farthest);
  });
}

/// Which contacts press. A point of a primitive moves no farther than its corners: so a contact that lacks some way to
/// pressing cannot press before its bodies have moved that far together.
void GrowingSheets::State::look_for_pressure() {
  parallel_for((contacts.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    for (std::size_t c = chunk * kChunk; c < std::min(contacts.size(), (chunk + 1) * kChunk); ++c) {
      const double now = clock[alarms[c].first_body] + clock[alarms[c].second_body];
      if (now >= alarms[c].due_mm) {
        const double lacking = missing(c);
        short_by[c] = std::max(lacking, 0.0);
        alarms[c].due_mm = now - std::min(lacking, 0.0);
      }
    }
  });
}

/// Each contact that is too near moves its four vertices apart along its normal; where a vertex has several, it moves
/// by their mean. Means do not depend on the order: what is symmetric stays so.
void GrowingSheets::State::push_apart(std::uint32_t body) {
  const bool gives_way = mobile(body);
  for (const Run& run : runs_of[body]) {
    for (std::uint32_t c = run.begin; c < run.end; ++c) {
      if (short_by[c] > 0.0 && gives_way) {
        press(c, body);
      } else if (short_by[c] > kPressedShare * spacing[c]) {
        pressed[body] = 1;
      }
    }
  }
  for (std::size_t i = first[body]; gives_way && i < first[body + 1]; ++i) {
    if (pushes[i] > 0) {
      proposal[i] += (kOverRelaxation / pushes[i]) * push[i];
      pushes[i] = 0;
    }
  }
}

/// Adds what a contact wants of the vertices of a body.
void GrowingSheets::State::press(std::uint32_t index, std::uint32_t body) {
  const Contact& contact = contacts[index];
  const int firsts = contact.edges ? 2 : 1;
  const std::array<bool, 2> gives_way = {mobile(contact.first_body), mobile(contact.second_body)};
  double weight = 0.0;
  for (int k = 0; k < 4; ++k) {
    weight += gives_way[k < firsts ? 0 : 1] ? contact.weights[k] * contact.weights[k] : 0.0;
  }
  for (int k = 0; k < 4; ++k) {
    const std::uint32_t vertex = contact.vertices[k];
    if (body != (k < firsts ? contact.first_body : contact.second_body) || contact.weights[k] == 0.0) {
      continue;
    }
    if (pushes[vertex]++ == 0) {
      push[vertex] = {};
    }
    push[vertex] += (short_by[index] / weight * contact.weights[k]) * contact.normal;
  }
}

Expected<CrossingReport> GrowingSheets::audit(const Progress& progress) const {
  const State& state = *state_;
  std::vector<Triangle> triangles;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    for (const Triangle& t : state.sheets[state.bodies[b].sheet].triangles) {
      triangles.push_back({state.first[b] + t[0], state.first[b] + t[1], state.first[b] + t[2]});
    }
  }
  return find_crossings(state.positions, triangles, 1000, progress);
}

GrowingSheets::Snapshot GrowingSheets::snapshot() const {
  return {state_->bodies, state_->positions, state_->targets, state_->awake, state_->bent, state_->wanted};
}

void GrowingSheets::restore(Snapshot snapshot) {
  State& state = *state_;
  state.bodies = std::move(snapshot.bodies);
  state.positions = std::move(snapshot.positions_mm);
  state.targets = std::move(snapshot.targets_mm);
  state.awake = std::move(snapshot.awake);
  state.bent = std::move(snapshot.bent);
  state.wanted = std::move(snapshot.wanted_mm);
  state.detector = Detector(state.sheets);  // it remembers where sleeping bodies are
  state.first = {0};
  for (const GrowingBody& body : state.bodies) {
    state.first.push_back(state.first.back() + static_cast<std::uint32_t>(state.sheets[body.sheet].vertex_count));
  }
  ANTHESIS_ASSERT(state.first.back() == state.positions.size());
}

}  // namespace anthesis
