#include "vein_growth.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "vein_visibility.h"

namespace anthesis {
namespace veins {
namespace {

constexpr std::uint32_t kMostVertices = 5'000'000;
constexpr int kMostSteps = 500;
constexpr double kFarthest = 1e6;  // mm: a tip that is farther off has lost its way
constexpr int kMostClimbs = 10;

Vec3 random_direction(Rng& rng) {
  const double azimuth = math::kTurnRad * rng.uniform();
  const double z = 1.0 - 2.0 * rng.uniform();
  const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
  const math::SinCos sc = math::sin_cos(azimuth);
  return {radius * sc.cos, radius * sc.sin, z};
}

double random_in(Rng& rng, const std::array<double, 2>& range) {
  return range[0] < range[1] ? rng.uniform(range[0], range[1]) : range[0];
}

/// The first frame whose time is greater than `time`; `last` + 1 if there is none.
std::uint32_t frame_after(double time, std::uint32_t last) {
  std::uint32_t frame = 0;
  while (frame <= last && !(static_cast<double>(frame) / last > time)) {
    ++frame;
  }
  return frame;
}

}  // namespace

VeinGrowth::VeinGrowth(const VeinParams& params, const HeadGrowth& growth, std::span<const VeinPrimordium> primordia,
                       const VeinOptions& options)
    : params_(params),
      growth_(growth),
      primordia_(primordia),
      options_(options),
      last_(static_cast<std::uint32_t>(growth.frames - 1)) {
  first_start_ = frame_after(params_.first_start, last_);
  first_colonisation_ = params_.colonisation.enabled ? frame_after(params_.colonisation.window[0], last_) : last_ + 1;
  births_.resize(primordia_.size());
  for (std::uint32_t i = 0; i < births_.size(); ++i) {
    births_[i] = i;
  }
  std::stable_sort(births_.begin(), births_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return primordia_[a].birth_frame < primordia_[b].birth_frame;
  });
  strands_.resize(primordia_.size());
}

Expected<Vasculature> VeinGrowth::run() {
  make_ring();
  std::size_t snapshot = 0;
  for (;;) {
    if (!report(options_.progress, "veins", time_of(frame_))) {
      return unexpected(Error{ErrorCode::kCancelled, "", "cancelled"});
    }
    joinable_known_ = false;
    if (needs_resistance()) {
      settle(network_, frame_);
    }
    while (born_ < births_.size() && primordia_[births_[born_]].birth_frame == frame_) {
      bear(births_[born_++]);
    }
    if (frame_ >= first_start_) {
      start_due();
    }
    reticulate();
    if (frame_ >= first_colonisation_) {
      add_attraction_points();
      colonise();
    }
    if (network_.size() > kMostVertices) {
      return unexpected(Error{ErrorCode::kTooLarge, "vasculature",
                              "must have at most " + std::to_string(kMostVertices) + " vertices, has more in frame " +
                                  std::to_string(frame_)});
    }
    std::uint32_t next = last_ + 1;
    if (frame_ < last_) {
      const bool all = frame_ == stride_end_;
      if (all) {
        network_.split(params_.split_length_mm);
        // Full strides end at multiples of themselves, so that nothing shifts those after it.
        stride_end_ = std::min(last_, (frame_ / options_.stride + 1) * options_.stride);
      }
      plan_motion(all);
      next = std::clamp(next_event(), frame_ + 1, stride_end_);
    }
    for (; snapshot < options_.frames.size() && options_.frames[snapshot] < next; ++snapshot) {
      if (options_.at_frame && options_.frames[snapshot] >= frame_) {
        options_.at_frame(options_.frames[snapshot], at(options_.frames[snapshot]));
      }
    }
    if (frame_ == last_) {
      return at(last_);
    }
    go_to(next);
  }
}

/// Whether in this frame strands look for a way to the ring.
bool VeinGrowth::needs_resistance() const {
  if (params_.reticulation.rule != ReticulationRule::kNone && !unreticulated_.empty() &&
      strands_[unreticulated_.front()].start_frame + params_.reticulation.delay_frames <= frame_) {
    return true;
  }
  return frame_ >= first_start_ && (std::any_of(waiting_.begin(), waiting_.end(),
                                                [&](std::size_t p) { return strands_[p].start_frame <= frame_; }) ||
                                    (born_ < births_.size() && primordia_[births_[born_]].birth_frame == frame_));
}

/// The next frame in which something happens; may be beyond the last.
std::uint32_t VeinGrowth::next_event() const {
  std::uint32_t next = last_;
  if (born_ < births_.size()) {
    next = std::min(next, primordia_[births_[born_]].birth_frame);
  }
  for (const std::size_t p : waiting_) {
    next = std::min(next, std::max(strands_[p].start_frame, first_start_));
  }
  if (params_.reticulation.rule != ReticulationRule::kNone && !unreticulated_.empty()) {
    next = std::min(next, strands_[unreticulated_.front()].start_frame + params_.reticulation.delay_frames);
  }
  if (frame_ < first_colonisation_) {
    next = std::min(next, first_colonisation_);
  } else if (!attraction_points_.empty() || time_of(frame_ + 1) < params_.colonisation.window[1]) {
    next = frame_ + 1;
  }
  return next;
}

/// Where vertices and attraction points will be at the end of the stride: of all, or of those that are new.
void VeinGrowth::plan_motion(bool all) {
  const std::size_t first = all ? 0 : motions_.size();
  const std::size_t first_point = all ? 0 : planned_points_;
  const std::size_t vertices = network_.size() - first;
  motions_.resize(network_.size());
  planned_points_ = attraction_points_.size();
  std::vector<Vec2> section(vertices + attraction_points_.size() - first_point);
  std::vector<double> radius(section.size());
  const auto motion = [&](std::size_t i) -> Motion& {
    return i < vertices ? motions_[first + i] : attraction_points_[first_point + i - vertices].motion;
  };
  for (std::size_t i = 0; i < section.size(); ++i) {
    const Vec3 p =
        i < vertices ? network_.position[first + i] : attraction_points_[first_point + i - vertices].position;
    radius[i] = std::sqrt(p.x * p.x + p.y * p.y);
    section[i] = {radius[i], p.z};
    motion(i).from = p;
    motion(i).frame = frame_;
  }
  if (section.empty()) {
    return;
  }
  growth_.move(frame_, stride_end_, section);
  for (std::size_t i = 0; i < section.size(); ++i) {
    const Vec3 p = motion(i).from;
    const double stretch = radius[i] > 0.0 ? section[i].x / radius[i] : 1.0;  // on the axis it stays there
    motion(i).goal = {p.x * stretch, p.y * stretch, section[i].y};
  }
}

Vec3 VeinGrowth::moved(const Motion& motion, std::uint32_t frame) const {
  const double share = static_cast<double>(frame - motion.frame) / (stride_end_ - motion.frame);
  return lerp(motion.from, motion.goal, share);
}

/// Takes the vertices from the present frame to a later one of the stride.
void VeinGrowth::advance(VeinNetwork& network, std::uint32_t frame) const {
  for (std::uint32_t v = 0; v < network.size(); ++v) {
    network.position[v] = moved(motions_[v], frame);
    network.age[v] += static_cast<int>(frame - frame_);
  }
}

void VeinGrowth::go_to(std::uint32_t frame) {
  advance(network_, frame);
  for (AttractionPoint& point : attraction_points_) {
    point.position = moved(point.motion, frame);
  }
  frame_ = frame;
}

void VeinGrowth::settle(VeinNetwork& network, std::uint32_t frame) const {
  const double time = time_of(frame);
  network.sort();
  network.update_resistance(ring_, params_.ground_resistivity.at(time),
                            static_cast<int>(params_.maturation_frames.at(time)), params_.mature_resistivity);
  network.relabel();
}

Vasculature VeinGrowth::at(std::uint32_t frame) const {
  VeinNetwork network = network_;
  if (frame > frame_) {
    advance(network, frame);
  }
  settle(network, frame);
  const Diameters widths = diameters(network, params_, ring_);
  const double factor = params_.diameter_course.at(time_of(frame));
  const auto faded_in = [&](std::uint32_t v) {
    if (params_.fade_in_frames == 0) {
      return 1.0;
    }
    const double age = std::clamp(static_cast<double>(network.age[v]) / params_.fade_in_frames, 0.0, 1.0);
    return age * age * (3.0 - 2.0 * age);
  };
  Vasculature result;
  result.ring_vertices = ring_;
  result.most_attraction_points = most_attraction_points_;
  for (const AttractionPoint& point : attraction_points_) {
    result.attraction_points.push_back(frame > frame_ ? moved(point.motion, frame) : point.position);
  }
  result.vertices.resize(network.size());
  for (std::uint32_t v = 0; v < network.size(); ++v) {
    result.vertices[v] = {network.position[v],
                          network.parent[v],
                          network.kind[v],
                          network.age[v],
                          factor * faded_in(v) * widths.vertices[v],
                          network.resistivity[v],
                          network.resistance[v],
                          network.primordium[v]};
  }
  for (std::size_t w = 0; w < network.second_ways.size(); ++w) {
    const SecondWay& way = network.second_ways[w];
    result.second_connections.push_back(
        {way.from, way.to, way.primordium, factor * faded_in(way.to) * widths.second_ways[w]});
  }
  for (const Strand& strand : strands_) {
    result.primordia.push_back(strand.surface);
  }
  return result;
}

// ---- births and starts ----------------------------------------------------------------------------------------------

void VeinGrowth::make_ring() {
  const Vec2 rim = growth_.outline(0).back();
  const double radius = std::max(params_.ring_radius * rim.x - params_.ring_inset_mm, 0.0);
  const int mature = std::max(1, static_cast<int>(params_.maturation_frames.at(0.0)));
  ring_ = static_cast<std::uint32_t>(params_.ring_vertices);
  for (std::uint32_t i = 0; i < ring_; ++i) {
    const math::SinCos sc = math::sin_cos(math::kTurnRad * i / ring_);
    NewVertex vertex;
    vertex.position = {radius * sc.cos, radius * sc.sin, rim.y};
    vertex.age = mature;
    vertex.resistivity = params_.mature_resistivity;
    vertex.resistance = 0.0;
    network_.add(vertex);
  }
}

VeinGrowth::Place VeinGrowth::place_on_outline(std::size_t frame, double s) const {
  const std::span<const Vec2> outline = growth_.outline(frame);
  double whole = 0.0;
  for (std::size_t i = 1; i < outline.size(); ++i) {
    whole += length(outline[i] - outline[i - 1]);
  }
  double rest = s * whole;
  Place place{outline.front(), {0.0, -1.0}};
  for (std::size_t i = 1; i < outline.size(); ++i) {
    const Vec2 chord = outline[i] - outline[i - 1];
    const double size = length(chord);
    if (size <= 0.0) {
      continue;  // young outlines repeat points
    }
    const double share = std::min(rest / size, 1.0);
    place = {outline[i - 1] + share * chord, Vec2{chord.y, -chord.x} / size};
    if (rest <= size) {
      break;
    }
    rest -= size;
  }
  return place;
}

void VeinGrowth::bear(std::size_t p) {
  const VeinPrimordium& primordium = primordia_[p];
  const VeinInitial& initial = initial_of(p);
  Rng rng(options_.seed, primordium.id, RandomPurpose::kVeinBirth);
  const double factor = random_in(rng, initial.depth_range);
  const int choices = initial.delay_frames[1] - initial.delay_frames[0] + 1;
  const int delay = initial.delay_frames[0] + std::min(static_cast<int>(rng.uniform() * choices), choices - 1);

  const Place place = place_on_outline(frame_, primordium.s);
  const math::SinCos azimuth = math::sin_cos(primordium.azimuth_rad);
  const auto turned = [&](Vec2 v) { return Vec3{v.x * azimuth.cos, v.x * azimuth.sin, v.y}; };
  const double depth =
      initial.depth_mm * factor * (initial.depth_follows_course ? params_.depth_course.at(time_of(frame_)) : 1.0);
  NewVertex vertex;
  vertex.position = turned(place.position);
  vertex.momentum = depth * turned(place.inward) - Vec3{0.0, 0.0, initial.sinking_mm};
  vertex.kind = initial.kind;
  vertex.age = -delay;
  vertex.factor = initial.initial_resistivity_factor;
  vertex.primordium = primordium.id;
  strands_[p].surface = network_.add(vertex);
  strands_[p].start_frame = frame_ + static_cast<std::uint32_t>(delay);
  waiting_.push_back(p);
}

void VeinGrowth::start_due() {
  std::vector<std::size_t> due;
  std::erase_if(waiting_, [&](std::size_t p) {
    if (strands_[p].start_frame > frame_) {
      return false;
    }
    due.push_back(p);
    return true;
  });
  for (const std::size_t p : due) {
    grow_initial(p);
  }
  for (const std::size_t p : due) {
    connect(p);
    unreticulated_.push_back(p);
  }
}

Vec3 VeinGrowth::deviated(Vec3 step, const VeinJitter& jitter, Rng& rng) const {
  if (jitter.probability <= 0.0 || rng.uniform() >= jitter.probability) {
    return step;
  }
  const Vec3 along = normalized(step);
  const Vec3 random = random_direction(rng);
  const Vec3 across = random - dot(random, along) * along;
  return params_.deviation == DeviationRule::kProjected ? step + jitter.strength * across
                                                        : step + rng.uniform(0.0, jitter.strength) * normalized(across);
}

/// Straight in from the surface. The strand starts now, so the primordium's age counts from here.
void VeinGrowth::grow_initial(std::size_t p) {
  Strand& strand = strands_[p];
  const VeinInitial& initial = initial_of(p);
  Rng rng(options_.seed, primordia_[p].id, RandomPurpose::kVeinInitial);
  strand.start_frame = frame_;
  network_.age[strand.surface] = 0;
  const Vec3 depth = network_.momentum[strand.surface];
  const Vec3 direction = normalized(depth);
  const double steps = std::ceil(length(depth) / params_.step_mm);
  std::uint32_t outer = strand.surface;
  for (double i = 0.0; i < steps; i += 1.0) {
    Vec3 step = deviated(direction, initial.jitter, rng);
    if (params_.deviated_initial_is_unit) {
      step = normalized(step);
    }
    NewVertex vertex;
    vertex.position = network_.position[outer] + params_.step_mm * step;
    vertex.momentum = depth;
    vertex.kind = initial.kind;
    vertex.factor = initial.initial_resistivity_factor;
    vertex.primordium = primordia_[p].id;
    const std::uint32_t inner = network_.add(vertex);
    network_.parent[outer] = inner;
    outer = inner;
  }
  strand.innermost = outer;
  network_.kind[outer] = initial.strand;
  network_.factor[outer] = initial.resistivity_factor;
}

// ---- minimum resistance ---------------------------------------------------------------------------------------------

double VeinGrowth::ground() const {
  return params_.ground_resistivity.at(time_of(frame_));
}

void VeinGrowth::prepare_joinable() {
  if (joinable_known_) {
    return;
  }
  joinable_known_ = true;
  joinable_.clear();
  for (std::uint32_t v = 0; v < network_.size(); ++v) {
    if (network_.resistance[v] < kInfinite && network_.age[v] > 0) {
      joinable_.push_back(v);
    }
  }
  joinable_grid_.build(network_.position, network_.resistance, joinable_, params_.merge_distance_mm);
}

/// Resistance from `p` through ground to `v` and on through strands (O24 eqs. 7 to 13).
double VeinGrowth::score(Vec3 p, std::uint32_t v, double ground, double oldest) const {
  constexpr double kOnAxis = 1e-5;
  constexpr double kAvoided = 99999.0;
  const Vec3 way = network_.position[v] - p;
  const double distance = length(way);
  double resistivity = ground;
  const double from_axis = std::sqrt(p.x * p.x + p.y * p.y);
  if (from_axis > kOnAxis && distance > 0.0) {
    const double radial = (way.x * p.x + way.y * p.y) / (from_axis * distance);
    if (radial < params_.inward_limit) {
      resistivity *= kAvoided;
    } else if (params_.sector_weight > 0.0) {
      const double across = (way.y * p.x - way.x * p.y) / from_axis;
      if (params_.sector_rule == SectorRule::kSquaredDistance) {
        resistivity *= 1.0 + params_.sector_weight * across * across;
      } else {
        const double cosine = across / distance;
        const double factor = 1.0 + params_.sector_weight * cosine * cosine;
        resistivity *= factor * factor * (factor * factor);
      }
    }
  }
  if (params_.age_weight > 0.0) {
    // Never below 0: with a low resistivity of the ground, eq. 10 would reward a detour to the oldest strand.
    resistivity = std::max(resistivity + params_.age_weight * (oldest / network_.age[v] - params_.age_offset), 0.0);
  }
  return resistivity * distance + params_.vein_weight * network_.resistance[v];
}

/// The vertex to connect to from `p`; kNoVertex if none may be joined.
std::uint32_t VeinGrowth::choose(Vec3 p, const std::vector<char>* excluded) {
  prepare_joinable();
  const double ground = this->ground();
  const bool by_age = params_.age_weight > 0.0;
  const auto allowed = [&](std::uint32_t v) { return excluded == nullptr || !(*excluded)[v]; };
  std::vector<std::uint32_t> kept;
  if (excluded != nullptr && (by_age || params_.visible_only)) {
    std::copy_if(joinable_.begin(), joinable_.end(), std::back_inserter(kept), allowed);
  }
  const std::vector<std::uint32_t>& candidates = excluded != nullptr ? kept : joinable_;

  std::uint32_t best = kNoVertex;
  double least = kInfinite;
  const auto consider = [&](std::uint32_t v, double oldest) {
    const double value = score(p, v, ground, oldest);
    if (value < least || (value == least && v < best)) {
      least = value;
      best = v;
    }
  };
  double oldest = 0.0;
  std::vector<std::pair<std::uint32_t, double>> visible;
  if (by_age) {
    visit_visible(p, network_.position, candidates, math::radians(params_.shielding_angle_deg),
                  [&](std::uint32_t v, double d) {
                    visible.emplace_back(v, d);
                    oldest = std::max(oldest, static_cast<double>(network_.age[v]));
                    return true;
                  });
  }
  if (params_.visible_only) {
    if (by_age) {
      for (const auto& [v, d] : visible) {
        if (d < params_.merge_distance_mm) {
          return v;
        }
        consider(v, oldest);
      }
      return best;
    }
    visit_visible(p, network_.position, candidates, math::radians(params_.shielding_angle_deg),
                  [&](std::uint32_t v, double d) {
                    if (d < params_.merge_distance_mm) {
                      best = v;
                      return false;
                    }
                    consider(v, 0.0);
                    return ground * d < least;  // no farther one can be better
                  });
    return best;
  }
  std::uint32_t near = kNoVertex;
  joinable_grid_.within(p, params_.merge_distance_mm, [&](std::uint32_t v, double) {
    if (allowed(v)) {
      near = std::min(near, v);
    }
  });
  if (near != kNoVertex) {
    return near;
  }
  const double lowest = by_age ? std::max(ground - params_.age_weight * params_.age_offset, 0.0) : ground;
  joinable_grid_.below(
      p,
      [&](double square, double resistance) { return lowest * std::sqrt(square) + params_.vein_weight * resistance; },
      [&] { return least; },
      [&](std::uint32_t v) {
        if (allowed(v)) {
          consider(v, oldest);
        }
      });
  return best;
}

/// The vertex within the merge distance that a tip joins; kNoVertex if there is none.
std::uint32_t VeinGrowth::merge_partner(Vec3 p, const std::vector<char>* excluded) const {
  std::uint32_t found = kNoVertex;
  double nearest = kInfinite;
  joinable_grid_.within(p, params_.merge_distance_mm, [&](std::uint32_t v, double square) {
    if (excluded != nullptr && (*excluded)[v]) {
      return;
    }
    bool better = found == kNoVertex;
    switch (params_.join) {
      case JoinRule::kThere:
        better = better || square < nearest || (square == nearest && v < found);
        break;
      case JoinRule::kBelow:  // as published, the first in storage
        better = better || v < found;
        break;
      case JoinRule::kForward:  // as published, the last in storage
        better = better || v > found;
        break;
    }
    if (better) {
      found = v;
      nearest = square;
    }
  });
  return found;
}

VeinGrowth::Path VeinGrowth::find_path(Vec3 p, Vec3 momentum, const VeinJitter& jitter, Rng& rng,
                                       const std::vector<char>* excluded) {
  constexpr double kSlowing = 0.1;
  constexpr double kLargest = 50.0;  // a momentum beyond 90 would grow faster than it is slowed
  Path path;
  if (const double size = length(momentum); size > kLargest) {
    momentum = (kLargest / size) * momentum;
  }
  std::uint32_t target = choose(p, excluded);
  if (target == kNoVertex) {
    return path;
  }
  for (int i = 0; i < kMostSteps; ++i) {
    if (dot(momentum, momentum) > 1.0) {
      momentum = kSlowing * momentum;
    }
    std::uint32_t near = kNoVertex;
    if (params_.retarget) {
      target = i == 0 ? target : choose(p, excluded);
      near = length(network_.position[target] - p) <= params_.merge_distance_mm ? target : kNoVertex;
    } else {
      near = merge_partner(p, excluded);
    }
    if (near != kNoVertex) {
      path.found = near;
      const auto below = [&](std::uint32_t v) {
        const std::uint32_t parent = network_.parent[v];
        return parent != kNoVertex && (excluded == nullptr || !(*excluded)[parent]) ? parent : kNoVertex;
      };
      if (params_.join == JoinRule::kBelow && below(near) != kNoVertex) {
        path.found = below(near);
      } else if (params_.join == JoinRule::kForward) {
        const Vec3 ahead = momentum == Vec3{} ? network_.position[target] - p : momentum;
        for (int climb = 0;
             climb < kMostClimbs && below(path.found) != kNoVertex && !network_.forward_of(p, path.found, ahead);
             ++climb) {
          path.found = below(path.found);
        }
      }
      return path;
    }
    Vec3 step = normalized(network_.position[target] - p) + momentum;
    if (params_.drift > 0.0) {
      step.z -= rng.uniform(0.0, params_.drift);
    }
    momentum = length(momentum) * step;
    step = deviated(step, jitter, rng);
    p += params_.step_mm * step;
    if (!(dot(p, p) <= kFarthest * kFarthest)) {
      path.points.clear();
      break;
    }
    path.points.push_back(p);
  }
  path.found = target;  // a strand that lost its way goes straight to its target
  return path;
}

NewVertex VeinGrowth::strand_vertex(std::size_t p, Vec3 position) const {
  NewVertex vertex;
  vertex.position = position;
  vertex.kind = initial_of(p).strand;
  vertex.factor = initial_of(p).resistivity_factor;
  vertex.primordium = primordia_[p].id;
  return vertex;
}

void VeinGrowth::connect(std::size_t p) {
  std::uint32_t tip = strands_[p].innermost;
  Rng rng(options_.seed, primordia_[p].id, RandomPurpose::kVeinStrand);
  const Path path = find_path(network_.position[tip], params_.momentum * network_.momentum[tip],
                              initial_of(p).strand_jitter, rng, nullptr);
  for (const Vec3 point : path.points) {
    const std::uint32_t next = network_.add(strand_vertex(p, point));
    network_.parent[tip] = next;
    tip = next;
  }
  network_.parent[tip] = path.found;
}

// ---- reticulation ---------------------------------------------------------------------------------------------------

void VeinGrowth::reticulate() {
  if (params_.reticulation.rule == ReticulationRule::kNone) {
    return;
  }
  std::vector<std::size_t> due;
  std::erase_if(unreticulated_, [&](std::size_t p) {
    if (strands_[p].start_frame + static_cast<std::uint32_t>(params_.reticulation.delay_frames) > frame_) {
      return false;
    }
    due.push_back(p);
    return true;
  });
  for (const std::size_t p : due) {
    if (params_.reticulation.rule == ReticulationRule::kLeastResistance) {
      reticulate_by_resistance(p);
    } else {
      reticulate_by_neighbour(p);
    }
  }
}

/// A second way from the inner end of the initial, which shares nothing with the first and comes by no vertex that
/// this one supplies.
void VeinGrowth::reticulate_by_resistance(std::size_t p) {
  const std::uint32_t start = strands_[p].innermost;
  if (!(network_.resistance[start] < kInfinite)) {
    return;
  }
  std::vector<char> excluded(network_.size(), 0);
  excluded[start] = 1;
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::uint32_t v : network_.order) {
      bool hit = network_.parent[v] != kNoVertex && excluded[network_.parent[v]];
      for (std::uint32_t w = network_.second[v]; w != kNoVertex && !hit; w = network_.second_ways[w].next) {
        hit = excluded[network_.second_ways[w].to];
      }
      if (hit && !excluded[v]) {
        excluded[v] = 1;
        changed = true;
      }
    }
  }
  for (std::uint32_t v = start; v != kNoVertex; v = network_.parent[v]) {
    excluded[v] = 1;
  }
  const Vec3 from = network_.position[start];
  const std::uint32_t target = choose(from, &excluded);
  if (target == kNoVertex) {
    return;
  }
  const double ground = this->ground();
  const double resistance = ground * length(network_.position[target] - from) + network_.resistance[target];
  if (resistance > params_.reticulation.ratio_limit * network_.resistance[start]) {
    return;
  }
  Rng rng(options_.seed, primordia_[p].id, RandomPurpose::kVeinReticulation);
  const Path path = find_path(from, {}, initial_of(p).strand_jitter, rng, &excluded);
  std::uint32_t below = path.found;
  for (auto point = path.points.rbegin(); point != path.points.rend(); ++point) {
    NewVertex vertex = strand_vertex(p, *point);
    vertex.parent = below;
    below = network_.add(vertex);
  }
  network_.add_second_way({start, below, start, primordia_[p].id});
}

/// The vertex of a strand that is `depth` below the surface, or its last before the ring.
std::uint32_t VeinGrowth::vertex_at_depth(std::uint32_t surface, double depth) const {
  std::uint32_t point = surface;
  for (double walked = 0.0; walked <= depth;) {
    const std::uint32_t below = network_.parent[point];
    if (below == kNoVertex || below < ring_) {
      break;
    }
    walked += length(network_.position[below] - network_.position[point]);
    point = below;
  }
  return point;
}

/// Of the nearest points where second strands may end, but for the one nearest along the strands, which is joined
/// already, the oldest; kNoVertex if there is none.
std::uint32_t VeinGrowth::oldest_neighbour(std::uint32_t point) const {
  constexpr std::size_t kNeighbours = 3;
  struct Neighbour {
    double distance;
    std::uint32_t vertex;
  };
  std::vector<Neighbour> neighbours;
  for (const std::uint32_t v : reticulation_points_) {
    const double distance = length(network_.position[v] - network_.position[point]);
    if (distance <= params_.reticulation.neighbourhood_mm && v != point) {
      neighbours.push_back({distance, v});
    }
  }
  std::stable_sort(neighbours.begin(), neighbours.end(),
                   [](const Neighbour& a, const Neighbour& b) { return a.distance < b.distance; });
  neighbours.resize(std::min(neighbours.size(), kNeighbours), Neighbour{});

  std::size_t joined = neighbours.size();
  int fewest = -1;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const int edges = network_.edges_between(point, neighbours[i].vertex);
    if (edges >= 0 && (fewest < 0 || edges < fewest)) {
      fewest = edges;
      joined = i;
    }
  }
  std::uint32_t oldest = kNoVertex;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (i != joined && (oldest == kNoVertex || network_.age[neighbours[i].vertex] > network_.age[oldest])) {
      oldest = neighbours[i].vertex;
    }
  }
  return oldest;
}

void VeinGrowth::reticulate_by_neighbour(std::size_t p) {
  constexpr double kFreeShare = 0.6;  // of the distance, beyond which a second strand joins nothing else
  const VeinReticulation& rules = params_.reticulation;
  prepare_joinable();
  Rng rng(options_.seed, primordia_[p].id, RandomPurpose::kVeinReticulation);

  // A little deeper than the initial.
  const double depth = length(network_.momentum[strands_[p].surface]) * rng.uniform(1.05, 1.1);
  const std::uint32_t point = vertex_at_depth(strands_[p].surface, depth);
  const std::uint32_t end = oldest_neighbour(point);
  reticulation_points_.push_back(point);
  if (end == kNoVertex) {
    return;
  }
  const double distance = length(network_.position[end] - network_.position[point]);
  const double resistance = distance * (ground() + network_.resistivity[end]) + network_.resistance[end];
  if (!std::isfinite(network_.resistance[point]) || distance > rules.reach_mm ||
      resistance - network_.resistance[point] > rules.difference_limit) {
    return;
  }

  // From the old point to the new one, as published.
  const double own = network_.resistance[end];
  const VeinJitter jitter = initial_of(p).strand_jitter;
  std::uint32_t reached = point;
  std::uint32_t tip = end;
  for (int i = 0; i < kMostSteps; ++i) {
    const Vec3 rest = network_.position[point] - network_.position[tip];
    if (length(rest) <= params_.merge_distance_mm) {
      break;
    }
    if (length(rest) <= kFreeShare * distance) {
      std::uint32_t other = kNoVertex;
      joinable_grid_.within(network_.position[tip], params_.merge_distance_mm, [&](std::uint32_t v, double) {
        if (network_.resistance[v] > own && (other == kNoVertex || v < other)) {
          other = v;
        }
      });
      if (other != kNoVertex) {
        reached = other;
        break;
      }
    }
    NewVertex vertex;
    vertex.position = network_.position[tip] + params_.step_mm * normalized(deviated(normalized(rest), jitter, rng));
    vertex.parent = tip;
    vertex.kind = initial_of(p).strand;
    vertex.age = network_.age[end];
    vertex.factor = network_.factor[end];
    vertex.resistivity = network_.resistivity[end];
    vertex.resistance = own;
    vertex.primordium = primordia_[p].id;
    tip = network_.add(vertex);
  }
  if (!network_.leads(tip, reached)) {
    network_.add_second_way({reached, tip, point, primordia_[p].id});
  }
}

// ---- colonisation ---------------------------------------------------------------------------------------------------

void VeinGrowth::add_attraction_points() {
  const VeinColonisation& rules = params_.colonisation;
  const double time = time_of(frame_);
  if (time >= rules.window[1]) {
    return;
  }
  constexpr int kMostRejections = 1000;
  Rng rng(options_.seed, frame_, RandomPurpose::kVeinSource);
  const Place place = place_on_outline(frame_, std::clamp(rules.s.at(time), 0.0, 1.0));
  VertexGrid grid;
  std::vector<std::uint32_t> all(attraction_points_.size());
  std::vector<Vec3> positions(attraction_points_.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    all[i] = i;
    positions[i] = attraction_points_[i].position;
  }
  grid.build(positions, {}, std::move(all), rules.spacing_mm);
  std::vector<AttractionPoint> accepted;
  for (int rejected = 0; rejected < kMostRejections && std::cmp_less(accepted.size(), rules.points_per_frame);) {
    const math::SinCos azimuth = math::sin_cos(math::kTurnRad * rng.uniform());
    const Vec2 p = place.position + random_in(rng, rules.depth_mm) * place.inward;
    const Vec3 point = {p.x * azimuth.cos, p.x * azimuth.sin, p.y};
    bool free = true;  // of the attraction points of earlier frames
    grid.within(point, rules.spacing_mm, [&](std::uint32_t, double) { free = false; });
    if (free) {
      accepted.push_back({point, {}});
      rejected = 0;
    } else {
      ++rejected;
    }
  }
  attraction_points_.insert(attraction_points_.end(), accepted.begin(), accepted.end());
  most_attraction_points_ = std::max(most_attraction_points_, attraction_points_.size());
}

void VeinGrowth::colonise() {
  if (attraction_points_.empty()) {
    return;
  }
  const VeinColonisation& rules = params_.colonisation;
  std::vector<std::uint32_t> growing;
  for (std::uint32_t v = 0; v < network_.size(); ++v) {
    if (network_.age[v] >= 0 && network_.kind[v] != VeinKind::kFloret) {
      growing.push_back(v);
    }
  }
  VertexGrid grid;
  grid.build(network_.position, {}, std::move(growing), rules.kill_distance_mm);
  if (grid.empty()) {
    return;
  }
  std::vector<std::uint32_t> nearest(attraction_points_.size());
  parallel_for(attraction_points_.size(),
               [&](std::size_t i) { nearest[i] = grid.nearest(attraction_points_[i].position); });

  struct Pull {
    std::uint32_t vertex;
    std::uint32_t point;
  };
  std::vector<Pull> pulls;
  std::vector<AttractionPoint> left;
  std::size_t planned = 0;
  for (std::uint32_t i = 0; i < attraction_points_.size(); ++i) {
    if (length(attraction_points_[i].position - network_.position[nearest[i]]) <= rules.kill_distance_mm) {
      continue;
    }
    pulls.push_back({nearest[i], static_cast<std::uint32_t>(left.size())});
    planned += i < planned_points_;
    left.push_back(attraction_points_[i]);
  }
  planned_points_ = planned;
  attraction_points_ = std::move(left);
  std::stable_sort(pulls.begin(), pulls.end(), [](const Pull& a, const Pull& b) { return a.vertex < b.vertex; });
  const double time = time_of(frame_);
  const double step = rules.step_mm * (2.0 - time * time * (3.0 - 2.0 * time));
  for (std::size_t i = 0; i < pulls.size();) {
    const std::uint32_t from = pulls[i].vertex;
    Vec3 sum;
    for (; i < pulls.size() && pulls[i].vertex == from; ++i) {
      sum += normalized(attraction_points_[pulls[i].point].position - network_.position[from]);
    }
    if (sum == Vec3{}) {
      continue;
    }
    Rng rng(options_.seed, (static_cast<std::uint64_t>(frame_) << 32) | from, RandomPurpose::kVeinColonisation);
    NewVertex vertex;
    vertex.position = network_.position[from] + step * deviated(normalized(sum), rules.jitter, rng);
    vertex.parent = from;
    vertex.kind = VeinKind::kAdaxial;
    vertex.factor = rules.resistivity_factor;
    network_.add(vertex);
  }
}

}  // namespace veins

void make_births_ascend(std::vector<VeinPrimordium>& primordia) {
  std::stable_sort(primordia.begin(), primordia.end(),
                   [](const VeinPrimordium& a, const VeinPrimordium& b) { return a.id < b.id; });
  for (std::size_t i = 1; i < primordia.size(); ++i) {
    if (primordia[i].birth_frame < primordia[i - 1].birth_frame) {
      primordia[i].birth_frame = primordia[i - 1].birth_frame + 1;
    }
  }
}

namespace {

std::optional<Error> check_primordia(std::span<const VeinPrimordium> primordia) {
  std::set<std::uint32_t> ids;
  for (std::size_t i = 0; i < primordia.size(); ++i) {
    const std::string where = "primordia[" + std::to_string(i) + "].";
    if (!(primordia[i].s >= 0.0 && primordia[i].s <= 1.0)) {
      return invalid_parameter(where + "s", "must be between 0 and 1", primordia[i].s);
    }
    if (!std::isfinite(primordia[i].azimuth_rad)) {
      return invalid_parameter(where + "azimuth_rad", "must be finite", primordia[i].azimuth_rad);
    }
    if (!ids.insert(primordia[i].id).second) {
      return invalid_parameter(where + "id", "must be given once", primordia[i].id);
    }
  }
  return std::nullopt;
}

}  // namespace

Expected<Vasculature> grow_veins(const VeinParams& params, const HeadGrowth& growth,
                                 std::span<const VeinPrimordium> primordia, const VeinOptions& options) {
  if (auto error = check(params)) {
    return unexpected(*error);
  }
  if (auto error = check_primordia(primordia)) {
    return unexpected(*error);
  }
  if (growth.frames < 2 || growth.frames > 1'000'000) {
    return unexpected(
        invalid_parameter("growth.frames", "must be between 2 and 1000000", static_cast<double>(growth.frames)));
  }
  if (options.stride < 1) {
    return unexpected(invalid_parameter("stride", "must be at least 1", options.stride));
  }
  const std::span<const Vec2> outline = growth.outline(0);
  if (outline.size() < 2 || outline.front() == outline.back()) {
    return unexpected(invalid_parameter("growth.outline", "must have some length", "none"));
  }
  if (const double radius = params.ring_radius * outline.back().x;
      params.ring_vertices > 1 && params.ring_inset_mm > 0.0 && !(params.ring_inset_mm < radius)) {
    return unexpected(invalid_parameter("ring_inset_mm", "must be less than the ring's radius of " + to_text(radius),
                                        params.ring_inset_mm));
  }
  return veins::VeinGrowth(params, growth, primordia, options).run();
}

}  // namespace anthesis
