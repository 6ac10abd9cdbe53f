#include "anthesis/phyllotaxis/parastichies.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "lattice.h"
#include "unrolled.h"

namespace anthesis {
namespace {

using detail::Cell;
using detail::Lattice;
using detail::Steps;
using detail::Unrolled;

constexpr std::size_t kFewestOrgans = 8;
constexpr double kRingRows = 1.0;          ///< height of a ring
constexpr double kLatticeRows = 0.8;       ///< to either side of its middle, for the lattice
constexpr std::size_t kLatticeOrgans = 8;  ///< at least so many to either side
constexpr std::size_t kEvenOrgans = 16;    ///< at least so many in the belt in which parastichies should be even
constexpr double kLongestSide = 3.0;       ///< in spacings; longer ones bridge the ends of the pattern
constexpr double kDoubtful = 0.3;          ///< a side this far from whole steps, or farther, leaves a count open
constexpr std::int64_t kMostOpen = 3;      ///< by so many at most
constexpr double kFewestVotes = 0.15;      ///< share of loops below which a count is no candidate
constexpr double kVoteWorth = 0.2;         ///< of all loops' agreement, in units of evenness
constexpr int kPhaseSteps = 4;             ///< to either side, of a third of a turn, so that no peak falls between
constexpr double kPhaseStep = math::kTurnRad / 3.0;
constexpr double kIrregularPenalty =
    0.4;                                 ///< how much longer the steps of a pair may be that shows where others do not
constexpr double kSwitchPenalty = 0.08;  ///< how much shorter they must be for the pair to change
constexpr double kClusterRows = 2.0;     ///< a dislocation reaches no farther along the surface
constexpr double kLongDiagonal = 1.2;    ///< over the mean of the four sides; 1.41 in a square, 1 in a rhombus of 60

std::int64_t cross(Steps x, Steps y) {
  return std::int64_t{x.a} * y.b - std::int64_t{x.b} * y.a;
}

double wrapped(double angle_rad) {
  const double rest = angle_rad - math::kTurnRad * std::nearbyint(angle_rad / math::kTurnRad);
  return rest <= -math::kPi ? rest + math::kTurnRad : rest;
}

/// One direction of a lattice.
struct Direction {
  Steps steps;
  Vec2 vector;  ///< outwards
  std::int64_t winding = 0;
  double evenness = 0.0;
  ParastichyTurn turn = ParastichyTurn::kStraight;

  std::uint32_t number() const { return static_cast<std::uint32_t>(std::abs(winding)); }
};

/// Two directions that make up the lattice and turn in opposite senses.
struct Pair {
  std::uint8_t first = 0;  ///< indices into Ring::directions, the smaller number first
  std::uint8_t second = 1;
  double cost = 0.0;        ///< length of the two steps over that of the shortest two, less one
  double regularity = 0.0;  ///< the lesser evenness
};

/// A belt around the surface, a row of organs high, and the lattice there.
struct Ring {
  std::size_t low = 0;  ///< first rank
  std::size_t high = 0;
  Lattice lattice;
  Steps closing;  ///< steps that lead once around the axis
  std::array<Direction, 4> directions;
  std::vector<Pair> pairs;
  std::size_t chosen = 0;

  std::size_t organs() const { return high - low; }
  bool found() const { return !pairs.empty(); }
  const Pair& pair() const { return pairs[chosen]; }
  const Direction& first() const { return directions[pair().first]; }
  const Direction& second() const { return directions[pair().second]; }
  const Direction& third() const {
    // Of four directions the pair leaves two: one of them may be twice the pair's own.
    const Direction* best = nullptr;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const Direction& direction = directions[i];
      if (i != pair().first && i != pair().second && std::abs(cross(direction.steps, first().steps)) == 1 &&
          std::abs(cross(direction.steps, second().steps)) == 1 &&
          (best == nullptr || length(direction.vector) < length(best->vector))) {
        best = &direction;
      }
    }
    return best != nullptr ? *best : first();
  }
};

ParastichyTurn turn_of(Vec2 step) {
  if (std::abs(step.x) < 0.01 * length(step)) {
    return ParastichyTurn::kStraight;
  }
  return (step.x > 0.0) == (step.y >= 0.0) ? ParastichyTurn::kCounterClockwise : ParastichyTurn::kClockwise;
}

double longest_side(const Cell& cell) {
  return std::max({length(cell.side[0]), length(cell.side[1]), length(cell.side[2])});
}

std::uint32_t middle_rank(const Cell& cell) {
  const auto [low, high] = std::minmax({cell.rank[0], cell.rank[1], cell.rank[2]});
  return cell.rank[0] + cell.rank[1] + cell.rank[2] - low - high;
}

class Analysis {
 public:
  explicit Analysis(std::span<const PatternOrgan> organs) : unrolled_(detail::unroll(organs)) {}

  void run(double least_regularity) {
    sort_cells();
    time_.push_back(0.0);
    for (std::size_t i = 1; i < unrolled_.size(); ++i) {
      const double area = unrolled_.spacing[i - 1] * unrolled_.spacing[i - 1];
      time_.push_back(time_.back() + math::kTurnRad * (unrolled_.place[i].y - unrolled_.place[i - 1].y) / area);
    }
    lay_rings();
    parallel_for(rings_.size(), [this](std::size_t i) { measure(rings_[i]); });
    join_ends();
    choose_pairs(least_regularity);
  }

  const Unrolled& unrolled() const { return unrolled_; }
  std::span<const Ring> rings() const { return rings_; }

 private:
  /// The organs of a ring and of half a ring to either side, for asking how evenly parastichies are spread.
  struct Belt {
    std::span<const Vec2> place;
    std::vector<double> time;    ///< from the middle
    std::vector<Vec2> turn;      ///< exp(i kPhaseStep) over the belt, at each organ
    std::vector<Vec2> backward;  ///< kPhaseSteps of them back
    double organs_per_u = 1.0;
  };

  void sort_cells() {
    std::sort(unrolled_.cells.begin(), unrolled_.cells.end(), [](const Cell& x, const Cell& y) {
      return std::pair(middle_rank(x), x.rank) < std::pair(middle_rank(y), y.rank);
    });
    first_cell_.assign(unrolled_.size() + 1, 0);
    for (const Cell& cell : unrolled_.cells) {
      ++first_cell_[middle_rank(cell) + 1];
    }
    std::partial_sum(first_cell_.begin(), first_cell_.end(), first_cell_.begin());
  }

  /// Number of organs in so many rows about rank `i`.
  std::size_t organs_in_rows(std::size_t i, double rows) const {
    return static_cast<std::size_t>(std::min(1e9, rows * math::kTurnRad / unrolled_.spacing[i]));
  }

  void lay_rings() {
    const std::size_t n = unrolled_.size();
    for (std::size_t low = 0; low < n;) {
      Ring ring;
      ring.low = low;
      ring.high = std::min(n, low + std::max<std::size_t>(4, organs_in_rows(low, kRingRows)));
      low = ring.high;
      if (!rings_.empty() && 2 * (ring.high - ring.low) < rings_.back().high - rings_.back().low) {
        rings_.back().high = ring.high;
      } else {
        rings_.push_back(ring);
      }
    }
  }

  std::span<const Cell> cells_between(std::size_t low, std::size_t high) const {
    return std::span(unrolled_.cells).subspan(first_cell_[low], first_cell_[high] - first_cell_[low]);
  }

  void measure(Ring& ring) const {
    const std::size_t n = unrolled_.size();
    const std::size_t centre = (ring.low + ring.high) / 2;
    const double spacing = unrolled_.spacing[centre];
    const std::size_t reach = std::max(kLatticeOrgans, organs_in_rows(centre, kLatticeRows));
    const std::size_t low = centre > reach ? centre - reach : 0;
    const std::size_t high = std::min(n, centre + reach);
    std::vector<Vec2> sides;
    std::vector<std::array<Vec2, 2>> trials;
    for (const Cell& cell : cells_between(low, high)) {
      if (longest_side(cell) > kLongestSide * spacing) {
        continue;  // at the ends the triangulation bridges what is no neighbourhood
      }
      sides.insert(sides.end(), cell.side.begin(), cell.side.end());
      trials.push_back({cell.side[0], -cell.side[2]});
    }
    ring.lattice = detail::fit_lattice(sides, trials, spacing * spacing);
    if (!(dot(ring.lattice.a, ring.lattice.a) > 0.0)) {
      return;
    }
    const Belt belt = belt_of(ring);
    if (count_loops(ring, reach, belt)) {
      describe(ring, belt);
    }
  }

  /// Steps around the axis, for the loops that separate the organs up to each rank from those above.
  ///
  /// The loop below a level is made of the lower side of each cell that stands on it with its tip above: no loop need
  /// be followed, it is enough to add.
  bool count_loops(Ring& ring, std::size_t reach, const Belt& belt) const {
    const std::size_t levels = ring.high - ring.low;
    struct Sum {
      std::int64_t a = 0;
      std::int64_t b = 0;
      std::int64_t open_a = 0;  ///< sides whose step is in doubt
      std::int64_t open_b = 0;
      double azimuth = 0.0;
    };
    std::vector<Sum> change(levels + 1);
    for (const Cell& cell : cells_between(ring.low > 3 * reach ? ring.low - 3 * reach : 0, ring.high)) {
      const std::size_t tip =
          static_cast<std::size_t>(std::max_element(cell.rank.begin(), cell.rank.end()) - cell.rank.begin());
      const std::size_t from = std::max<std::size_t>(middle_rank(cell), ring.low) - ring.low;
      if (cell.rank[tip] <= ring.low + from) {
        continue;
      }
      const std::size_t to = std::min<std::size_t>(cell.rank[tip], ring.high) - ring.low;
      const Vec2 side = cell.side[(tip + 1) % 3];
      const Vec2 exact = ring.lattice.coordinates(side);
      const Steps steps = ring.lattice.nearest(side);
      const Sum sum = {steps.a, steps.b, std::abs(exact.x - steps.a) > kDoubtful,
                       std::abs(exact.y - steps.b) > kDoubtful, side.x};
      for (const auto& [at, sign] : {std::pair(from, 1), std::pair(to, -1)}) {
        change[at].a += sign * sum.a;
        change[at].b += sign * sum.b;
        change[at].open_a += sign * sum.open_a;
        change[at].open_b += sign * sum.open_b;
        change[at].azimuth += sign * sum.azimuth;
      }
    }
    std::map<std::int64_t, std::size_t> votes_a;
    std::map<std::int64_t, std::size_t> votes_b;
    std::size_t all = 0;
    Sum sum;
    const auto vote = [](std::map<std::int64_t, std::size_t>& votes, std::int64_t count, std::int64_t open) {
      open = std::min(open, kMostOpen);
      for (std::int64_t k = count - open; k <= count + open; ++k) {
        ++votes[k];
      }
    };
    for (std::size_t i = 0; i < levels; ++i) {
      sum.a += change[i].a;
      sum.b += change[i].b;
      sum.open_a += change[i].open_a;
      sum.open_b += change[i].open_b;
      sum.azimuth += change[i].azimuth;
      if (std::abs(sum.azimuth - math::kTurnRad) < 1e-6) {  // else the loop runs off the end of the pattern
        ++all;
        vote(votes_a, sum.a, sum.open_a);
        vote(votes_b, sum.b, sum.open_b);
      }
    }
    if (all == 0) {
      return false;
    }
    // Where loops disagree or are in doubt, that count wins whose parastichies are spread most evenly.
    const auto elect = [&](const std::map<std::int64_t, std::size_t>& votes, Vec2 along) {
      std::map<std::int64_t, double> candidates;
      for (const auto& [count, voters] : votes) {
        const double share = static_cast<double>(voters) / static_cast<double>(all);
        if (share >= kFewestVotes) {
          candidates[count] = share;
        }
      }
      double best = -1.0;
      std::int64_t elected = 0;
      for (const auto& [count, share] : candidates) {
        const double coherence = candidates.size() > 1 ? coherences(belt, count, 1, along)[0] : 1.0;
        if (coherence + kVoteWorth * share > best) {
          best = coherence + kVoteWorth * share;
          elected = count;
        }
      }
      return static_cast<std::int32_t>(elected);
    };
    ring.closing.a = elect(votes_a, ring.lattice.b);
    ring.closing.b = elect(votes_b, ring.lattice.a);
    return true;
  }

  Belt belt_of(const Ring& ring) const {
    const std::size_t half =
        std::max((ring.organs() + 1) / 2, ring.organs() < kEvenOrgans ? (kEvenOrgans - ring.organs() + 1) / 2 : 0);
    const std::size_t low = ring.low > half ? ring.low - half : 0;
    const std::size_t high = std::min(unrolled_.size(), ring.high + half);
    const double spacing = unrolled_.spacing[(ring.low + ring.high) / 2];
    const double whole = std::max(time_[high - 1] - time_[low], 1e-9);
    Belt belt;
    belt.place = std::span(unrolled_.place).subspan(low, high - low);
    belt.organs_per_u = math::kTurnRad / (spacing * spacing);
    for (std::size_t i = low; i < high; ++i) {
      const double t = time_[i] - 0.5 * (time_[high - 1] + time_[low]);
      const auto [sin, cos] = math::sin_cos(kPhaseStep / whole * t);
      const auto [back_sin, back_cos] = math::sin_cos(-kPhaseSteps * kPhaseStep / whole * t);
      belt.time.push_back(t);
      belt.turn.push_back({cos, sin});
      belt.backward.push_back({back_cos, back_sin});
    }
    return belt;
  }

  /// For each whole number w from `first` on, the largest modulus of the mean of exp(i (w azimuth + k t)) over the
  /// belt, k near the value for which it does not change in the direction `along`: 1 for w parastichies spread
  /// perfectly evenly, about 1/sqrt(organs) for organs at random. t grows with the number of organs: in it the phase of
  /// a pattern of constant divergence is straight on any surface.
  static std::vector<double> coherences(const Belt& belt, std::int64_t first, std::size_t count, Vec2 along) {
    std::vector<double> result(count, 0.0);
    if (std::abs(along.y) < 1e-9 * std::abs(along.x)) {
      return result;
    }
    const double slope = along.x / (along.y * belt.organs_per_u);
    using Sums = std::array<Vec2, 2 * kPhaseSteps + 1>;
    std::vector<Sums> sums(count);
    const auto times = [](Vec2 a, Vec2 b) { return Vec2{a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x}; };
    for (std::size_t i = 0; i < belt.place.size(); ++i) {
      const double angle = belt.place[i].x - slope * belt.time[i];
      const auto [sin, cos] = math::sin_cos(angle);
      const auto [first_sin, first_cos] = math::sin_cos(static_cast<double>(first) * angle);
      Vec2 base = times({first_cos, first_sin}, belt.backward[i]);
      for (Sums& sum : sums) {
        Vec2 phase = base;
        for (Vec2& one : sum) {
          one += phase;
          phase = times(phase, belt.turn[i]);
        }
        base = times(base, {cos, sin});
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      for (const Vec2 sum : sums[k]) {
        result[k] = std::max(result[k], length(sum) / static_cast<double>(belt.place.size()));
      }
    }
    return result;
  }

  /// Coherence over that of the best rival, a number of parastichies one or two off: bunched parastichies have theirs
  /// shared out among such (sidebands).
  static double evenness(const Belt& belt, const Direction& direction) {
    const std::vector<double> around = coherences(belt, direction.winding - 2, 5, direction.vector);
    double rival = 0.0;
    for (std::size_t k = 0; k < 5; ++k) {
      const std::int64_t winding = direction.winding - 2 + static_cast<std::int64_t>(k);
      // None at all, and each counted twice, are spread evenly always.
      if (winding * direction.winding > 0 && winding % direction.winding != 0) {
        rival = std::max(rival, around[k]);
      }
    }
    return std::sqrt(std::max(0.0, around[2] * around[2] - rival * rival));
  }

  static void describe(Ring& ring, const Belt& belt) {
    constexpr std::array<Steps, 4> kSteps = {Steps{1, 0}, Steps{0, 1}, Steps{1, 1}, Steps{1, -1}};
    for (std::size_t i = 0; i < 4; ++i) {
      Direction& direction = ring.directions[i];
      direction.steps = kSteps[i];
      direction.vector = direction.steps.a * ring.lattice.a + direction.steps.b * ring.lattice.b;
      if (direction.vector.y < 0.0 || (direction.vector.y == 0.0 && direction.vector.x < 0.0)) {
        direction.vector = -direction.vector;
        direction.steps = Steps{} - direction.steps;
      }
      direction.winding = cross(direction.steps, ring.closing);
      direction.turn = turn_of(direction.vector);
      direction.evenness = direction.winding == 0 ? 0.0 : evenness(belt, direction);
    }
    const double shortest = length(ring.lattice.a) + length(ring.lattice.b);
    for (std::uint8_t i = 0; i < 4; ++i) {
      for (std::uint8_t k = static_cast<std::uint8_t>(i + 1); k < 4; ++k) {
        const Direction& x = ring.directions[i];
        const Direction& y = ring.directions[k];
        const bool opposed = static_cast<int>(x.turn) * static_cast<int>(y.turn) <= 0 && x.turn != y.turn;
        if (std::abs(cross(x.steps, y.steps)) != 1 || !opposed || x.winding == 0 || y.winding == 0) {
          continue;
        }
        const double cost = (length(x.vector) + length(y.vector)) / shortest - 1.0;
        const double regularity = std::min(x.evenness, y.evenness);
        const bool in_order = x.number() < y.number() || (x.number() == y.number() && x.turn < y.turn);
        ring.pairs.push_back(in_order ? Pair{i, k, cost, regularity} : Pair{k, i, cost, regularity});
      }
    }
  }

  /// Around the ends of a pattern, its last whorl for example, no loop can be closed: they go with the next ring.
  void join_ends() {
    const auto found = [](const Ring& ring) { return ring.found(); };
    const auto first = std::find_if(rings_.begin(), rings_.end(), found);
    if (first == rings_.end()) {
      return;
    }
    const auto last = std::find_if(rings_.rbegin(), rings_.rend(), found);
    first->low = rings_.front().low;
    last->high = rings_.back().high;
    rings_.erase(last.base(), rings_.end());
    rings_.erase(rings_.begin(), first);
  }

  /// The pair of each ring: short steps, regular if any is, and the same as next door unless another is clearly better.
  /// Shortest path through the rings.
  void choose_pairs(double least_regularity) {
    const auto same = [](const Ring& x, const Pair& p, const Ring& y, const Pair& q) {
      const Direction& a = x.directions[p.first];
      const Direction& b = x.directions[p.second];
      const Direction& c = y.directions[q.first];
      const Direction& d = y.directions[q.second];
      return a.number() == c.number() && b.number() == d.number() && a.turn == c.turn && b.turn == d.turn;
    };
    std::vector<std::vector<double>> cost(rings_.size());
    std::vector<std::vector<std::size_t>> from(rings_.size());
    std::vector<std::size_t> best_end(rings_.size(), 0);  ///< of the path up to a ring
    for (std::size_t i = 0; i < rings_.size(); ++i) {
      const Ring& ring = rings_[i];
      for (const Pair& pair : ring.pairs) {
        double least = 0.0;
        std::size_t via = 0;
        if (i > 0 && rings_[i - 1].found()) {
          least = 1e300;
          for (std::size_t k = 0; k < rings_[i - 1].pairs.size(); ++k) {
            const double way =
                cost[i - 1][k] + (same(rings_[i - 1], rings_[i - 1].pairs[k], ring, pair) ? 0.0 : kSwitchPenalty);
            if (way < least) {
              least = way;
              via = k;
            }
          }
        }
        cost[i].push_back(least + pair.cost + (pair.regularity < least_regularity ? kIrregularPenalty : 0.0));
        from[i].push_back(via);
      }
      if (ring.found()) {
        best_end[i] = static_cast<std::size_t>(std::min_element(cost[i].begin(), cost[i].end()) - cost[i].begin());
      }
    }
    for (std::size_t i = rings_.size(); i-- > 0;) {
      const bool last = i + 1 == rings_.size() || !rings_[i + 1].found();
      rings_[i].chosen = last ? best_end[i] : from[i + 1][rings_[i + 1].chosen];
    }
  }

  Unrolled unrolled_;
  std::vector<std::size_t> first_cell_;  ///< by middle rank
  std::vector<double> time_;             ///< by rank: number of organs up to it, smoothed
  std::vector<Ring> rings_;
};

// ---- what the rings say, in the botanist's words

/// Neighbours and what is known of them before their families are.
struct Edge {
  std::uint32_t low = 0;  ///< ranks
  std::uint32_t high = 0;
  Vec2 side;
  bool longest = true;  ///< in each of its cells
  double others = 0.0;  ///< lengths of the other sides of its cells, added
  int cells = 0;
};

/// Each neighbourhood once, by ranks.
std::vector<Edge> edges_of(const Unrolled& unrolled) {
  std::vector<Edge> edges;
  edges.reserve(3 * unrolled.cells.size());
  for (const Cell& cell : unrolled.cells) {
    const std::array<double, 3> size = {length(cell.side[0]), length(cell.side[1]), length(cell.side[2])};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = cell.rank[k];
      const std::uint32_t b = cell.rank[(k + 1) % 3];
      const double other = size[(k + 1) % 3] + size[(k + 2) % 3];
      const bool longest = size[k] > std::max(size[(k + 1) % 3], size[(k + 2) % 3]);
      const bool flip = b < a || (a == b && cell.side[k].x < 0.0);
      edges.push_back({std::min(a, b), std::max(a, b), flip ? -cell.side[k] : cell.side[k], longest, other, 1});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return x.low != y.low ? x.low < y.low : x.high != y.high ? x.high < y.high : x.side.x < y.side.x;
  });
  std::size_t kept = 0;
  for (const Edge& edge : edges) {
    Edge* last = kept > 0 ? &edges[kept - 1] : nullptr;
    // The two cells of a neighbourhood may have measured it at different copies of the organs.
    if (last != nullptr && last->low == edge.low && last->high == edge.high &&
        std::abs(last->side.x - edge.side.x) < 1e-6) {
      last->longest = last->longest && edge.longest;
      last->others += edge.others;
      ++last->cells;
    } else {
      edges[kept++] = edge;
    }
  }
  edges.resize(kept);
  return edges;
}

/// The cells that meet at each organ.
class CellsOfOrgan {
 public:
  explicit CellsOfOrgan(const Unrolled& unrolled) : first_(unrolled.size() + 1, 0), cell_(3 * unrolled.cells.size()) {
    for (const Cell& cell : unrolled.cells) {
      for (const std::uint32_t rank : cell.rank) {
        ++first_[rank + 1];
      }
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < unrolled.cells.size(); ++i) {
      for (const std::uint32_t rank : unrolled.cells[i].rank) {
        cell_[next[rank]++] = i;
      }
    }
  }

  std::span<const std::uint32_t> cells(std::uint32_t rank) const {
    return std::span(cell_).subspan(first_[rank], first_[rank + 1] - first_[rank]);
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> cell_;
};

std::vector<std::uint32_t> ring_by_rank(const Analysis& analysis) {
  std::vector<std::uint32_t> result(analysis.unrolled().size());
  for (std::size_t i = 0; i < analysis.rings().size(); ++i) {
    const Ring& ring = analysis.rings()[i];
    std::fill(result.begin() + static_cast<std::ptrdiff_t>(ring.low),
              result.begin() + static_cast<std::ptrdiff_t>(ring.high), static_cast<std::uint32_t>(i));
  }
  return result;
}

/// What makes rings one region.
struct RegionKey {
  bool regular = false;
  std::uint32_t m = 0;
  std::uint32_t n = 0;
  ParastichyTurn m_turn = ParastichyTurn::kStraight;
  friend bool operator==(const RegionKey&, const RegionKey&) = default;
};

std::vector<RegionKey> keys_of(std::span<const Ring> rings, double least_regularity) {
  std::vector<RegionKey> keys;
  for (const Ring& ring : rings) {
    if (ring.found() && ring.pair().regularity >= least_regularity) {
      keys.push_back({true, ring.first().number(), ring.second().number(), ring.first().turn});
    } else {
      keys.emplace_back();
    }
  }
  // One ring that fails, in a stretch that else agrees, is a blemish and no region.
  for (std::size_t i = 1; i + 1 < keys.size(); ++i) {
    const Ring& ring = rings[i];
    if (!keys[i].regular && keys[i - 1].regular && keys[i - 1] == keys[i + 1] && ring.found() &&
        ring.first().number() == keys[i - 1].m && ring.second().number() == keys[i - 1].n) {
      keys[i] = keys[i - 1];
    }
  }
  // Nor is a regular stretch amid irregular ones that is too short for one loop through all its parastichies.
  for (std::size_t i = 0; i < keys.size();) {
    std::size_t end = i;
    std::size_t organs = 0;
    while (end < keys.size() && keys[end] == keys[i]) {
      organs += rings[end++].organs();
    }
    const bool alone = (i == 0 || !keys[i - 1].regular) && (end == keys.size() || !keys[end].regular);
    if (keys[i].regular && alone && organs < std::size_t{keys[i].m} + keys[i].n) {
      std::fill(keys.begin() + static_cast<std::ptrdiff_t>(i), keys.begin() + static_cast<std::ptrdiff_t>(end),
                RegionKey{});
    }
    i = end;
  }
  return keys;
}

/// The angle from an organ to the next of a lattice that closes around the axis, in [0, pi / jugacy].
double lattice_divergence_rad(const Ring& ring) {
  // Steps (x, y) to the next organ by height: x Q - y P is the greatest common divisor of P and Q.
  const std::int64_t p = ring.closing.a;
  const std::int64_t q = ring.closing.b;
  std::int64_t r0 = q, r1 = -p, x0 = 1, x1 = 0, y0 = 0, y1 = 1;
  while (r1 != 0) {
    const std::int64_t whole = r0 / r1;
    r0 = std::exchange(r1, r0 - whole * r1);
    x0 = std::exchange(x1, x0 - whole * x1);
    y0 = std::exchange(y1, y0 - whole * y1);
  }
  // The lattice was fitted to neighbours; that it closes is known exactly, and (x, y) may be many steps.
  const Vec2 gap =
      Vec2{math::kTurnRad, 0.0} - static_cast<double>(p) * ring.lattice.a - static_cast<double>(q) * ring.lattice.b;
  const double weight = 1.0 / static_cast<double>(p * p + q * q);
  const double step = static_cast<double>(x0) * (ring.lattice.a.x + static_cast<double>(p) * weight * gap.x) +
                      static_cast<double>(y0) * (ring.lattice.b.x + static_cast<double>(q) * weight * gap.x);
  const double sector = math::kTurnRad / static_cast<double>(std::abs(r0));
  return std::abs(step - sector * std::nearbyint(step / sector));
}

struct FamilySums {
  double azimuth = 0.0;
  double distance = 0.0;
  double evenness = 0.0;
  std::map<std::uint32_t, std::size_t> differences;

  void add(const Direction& direction, double radius_mm, double weight) {
    azimuth += weight * direction.vector.x;
    distance += weight * length(direction.vector) * radius_mm;
    evenness += weight * direction.evenness;
  }
};

void finish(ParastichyFamily& family, const FamilySums& sums, double weight) {
  family.step_azimuth_rad = sums.azimuth / weight;
  family.step_mm = sums.distance / weight;
  family.evenness = sums.evenness / weight;
  std::size_t all = 0;
  std::size_t most = 0;
  for (const auto& [difference, count] : sums.differences) {
    all += count;
    if (count > most) {
      most = count;
      family.index_difference = difference;
    }
  }
  family.index_share = all > 0 ? static_cast<double>(most) / static_cast<double>(all) : 0.0;
}

class Report {
 public:
  Report(const Analysis& analysis, std::span<const PatternOrgan> organs, const ParastichyOptions& options)
      : organs_(organs),
        options_(options),
        unrolled_(analysis.unrolled()),
        rings_(analysis.rings()),
        ring_of_(ring_by_rank(analysis)) {}

  void write(Parastichies& result) {
    lay_regions(result);
    link(result);
    find_dislocations(result);
    finish_regions(result);
    for (std::size_t i = 0; i + 1 < result.regions.size(); ++i) {
      result.transitions.push_back(transition(result.regions[i], result.regions[i + 1]));
    }
  }

 private:
  double s_mm(std::size_t rank) const { return organs_[unrolled_.organ[rank]].s_mm; }

  void lay_regions(Parastichies& result) {
    const std::vector<RegionKey> keys = keys_of(rings_, options_.least_regularity);
    for (std::size_t i = 0; i < rings_.size(); ++i) {
      if (i == 0 || !(keys[i] == keys[i - 1])) {
        ParastichyRegion region;
        region.from_mm = i == 0 ? s_mm(0) : 0.5 * (s_mm(rings_[i].low - 1) + s_mm(rings_[i].low));
        if (i > 0) {
          result.regions.back().to_mm = region.from_mm;
        }
        result.regions.push_back(region);
        first_ring_.push_back(i);
        regular_.push_back(keys[i].regular);
      }
      result.regions.back().organs += rings_[i].organs();
      region_of_ring_.push_back(static_cast<std::uint32_t>(result.regions.size() - 1));
    }
    result.regions.back().to_mm = s_mm(unrolled_.size() - 1);
    first_ring_.push_back(rings_.size());
    sums_.resize(result.regions.size());
    for (std::size_t rank = 0; rank < unrolled_.size(); ++rank) {
      ParastichyOrgan& organ = result.organs[unrolled_.organ[rank]];
      organ.u = unrolled_.place[rank].y;
      organ.region = region_of_ring_[ring_of_[rank]];
    }
  }

  void link(Parastichies& result) {
    for (const Edge& edge : edges_of(unrolled_)) {
      const Ring& ring = rings_[ring_of_[edge.low]];
      const double size = length(edge.side);
      if (size > kLongestSide * unrolled_.spacing[edge.low]) {
        continue;
      }
      ParastichyLink link;
      link.organs = {unrolled_.organ[edge.low], unrolled_.organ[edge.high]};
      link.contact = !(edge.longest && size * 2.0 * edge.cells > kLongDiagonal * edge.others);
      const std::uint32_t region = region_of_ring_[ring_of_[edge.low]];
      if (ring.found()) {
        const Steps steps = ring.lattice.nearest(edge.side);
        const std::array<const Direction*, 3> families = {&ring.first(), &ring.second(), &ring.third()};
        for (std::uint8_t k = 0; k < 3; ++k) {
          if (steps != families[k]->steps && steps != Steps{} - families[k]->steps) {
            continue;
          }
          if (k < 2) {
            link.family = static_cast<std::uint8_t>(k + 1);
            link.number = families[k]->number();
          }
          if (options_.in_order_of_birth) {
            const auto [older, younger] = std::minmax(link.organs[0], link.organs[1]);
            ++sums_[region][k].differences[younger - older];
          }
          break;
        }
      }
      for (const std::uint32_t organ : link.organs) {
        ++result.organs[organ].coordination;
        result.organs[organ].contacts += link.contact ? 1 : 0;
      }
      result.links.push_back(link);
    }
  }

  /// Places around which the steps do not add to nothing. Cells that fail this are joined where they share an organ: a
  /// mistaken side has such a cell on either hand, and the two cancel.
  void find_dislocations(Parastichies& result) {
    const std::vector<Cell>& cells = unrolled_.cells;
    const auto bad_in = [&](const Ring& ring, std::uint32_t index) {
      return longest_side(cells[index]) <= kLongestSide * unrolled_.spacing[middle_rank(cells[index])] &&
             around(ring, cells[index]) != Steps{};
    };
    const CellsOfOrgan at(unrolled_);
    std::vector<bool> seen(cells.size(), false);
    for (std::uint32_t start = 0; start < cells.size(); ++start) {
      const std::uint32_t rank = middle_rank(cells[start]);
      const Ring& ring = rings_[ring_of_[rank]];
      if (seen[start] || !ring.found() || !bad_in(ring, start)) {
        continue;
      }
      // All in the lattice of the first, or else a side might count differently for its two cells; but not so far away
      // that another would be right.
      std::vector<std::uint32_t> cluster = {start};
      seen[start] = true;
      for (std::size_t i = 0; i < cluster.size(); ++i) {
        for (const std::uint32_t corner : cells[cluster[i]].rank) {
          for (const std::uint32_t next : at.cells(corner)) {
            const Vec2 away = unrolled_.place[middle_rank(cells[next])] - unrolled_.place[rank];
            if (!seen[next] && std::abs(away.y) < kClusterRows * unrolled_.spacing[rank] && bad_in(ring, next)) {
              seen[next] = true;
              cluster.push_back(next);
            }
          }
        }
      }
      report_cluster(result, ring, cluster);
    }
    std::stable_sort(result.dislocations.begin(), result.dislocations.end(),
                     [](const auto& x, const auto& y) { return x.s_mm < y.s_mm; });
  }

  void report_cluster(Parastichies& result, const Ring& ring, std::span<const std::uint32_t> cluster) {
    const std::vector<Cell>& cells = unrolled_.cells;
    const Vec2 origin = unrolled_.place[cells[cluster[0]].rank[0]];
    const auto from_origin = [&](std::uint32_t rank) {
      const Vec2 away = unrolled_.place[rank] - origin;
      return Vec2{wrapped(away.x), away.y};
    };
    Steps sum;
    Vec2 place;
    for (const std::uint32_t index : cluster) {
      sum = sum + around(ring, cells[index]);
      for (const std::uint32_t rank : cells[index].rank) {
        place += from_origin(rank) / static_cast<double>(3 * cluster.size());
      }
    }
    if (sum == Steps{}) {
      return;
    }
    std::uint32_t nearest = cells[cluster[0]].rank[0];
    for (const std::uint32_t index : cluster) {
      for (const std::uint32_t rank : cells[index].rank) {
        if (length(from_origin(rank) - place) < length(from_origin(nearest) - place)) {
          nearest = rank;
        }
      }
    }
    ParastichyDislocation dislocation;
    dislocation.organ = unrolled_.organ[nearest];
    dislocation.s_mm = s_mm(nearest);
    const double azimuth = wrapped(origin.x + place.x);
    dislocation.azimuth_rad = azimuth < 0.0 ? azimuth + math::kTurnRad : azimuth;
    const std::array<const Direction*, 2> families = {&ring.first(), &ring.second()};
    for (std::size_t k = 0; k < 2; ++k) {
      dislocation.pair[k] = families[k]->number();
      // Steps once around the axis above, less those below, are the steps around the place clockwise.
      const std::int64_t gained = -cross(families[k]->steps, sum);
      dislocation.gained[k] = static_cast<std::int32_t>(families[k]->winding < 0 ? -gained : gained);
    }
    ++result.regions[region_of_ring_[ring_of_[nearest]]].dislocations;
    result.dislocations.push_back(dislocation);
  }

  static Steps around(const Ring& ring, const Cell& cell) {
    return ring.lattice.nearest(cell.side[0]) + ring.lattice.nearest(cell.side[1]) + ring.lattice.nearest(cell.side[2]);
  }

  void finish_regions(Parastichies& result) {
    for (std::size_t r = 0; r < result.regions.size(); ++r) {
      ParastichyRegion& region = result.regions[r];
      const std::span<const Ring> rings = rings_.subspan(first_ring_[r], first_ring_[r + 1] - first_ring_[r]);
      // Regular regions have one pair. In the others the commonest stands for all.
      std::map<std::array<std::uint32_t, 2>, std::size_t> organs_by_pair;
      for (const Ring& ring : rings) {
        if (ring.found()) {
          organs_by_pair[{ring.first().number(), ring.second().number()}] += ring.organs();
        }
      }
      if (organs_by_pair.empty()) {
        region.divergence_rad = std::numeric_limits<double>::quiet_NaN();
        region.plastochron_ratio = std::numeric_limits<double>::quiet_NaN();
        continue;
      }
      const std::array<std::uint32_t, 2> pair =
          std::max_element(organs_by_pair.begin(), organs_by_pair.end(), [](const auto& x, const auto& y) {
            return x.second < y.second;
          })->first;
      double weight = 0.0;
      double all = 0.0;
      double divergence = 0.0;
      double rise = 0.0;
      std::map<std::uint32_t, double> third_weight;
      for (const Ring& ring : rings) {
        if (!ring.found()) {
          all += static_cast<double>(ring.organs());
          continue;
        }
        const auto w = static_cast<double>(ring.organs());
        all += w;
        region.regularity += w * ring.pair().regularity;
        rise += w * std::abs(cross(ring.lattice.a, ring.lattice.b)) / math::kTurnRad;
        if (ring.first().number() != pair[0] || ring.second().number() != pair[1]) {
          continue;
        }
        if (weight == 0.0) {
          region.m.turn = ring.first().turn;
          region.n.turn = ring.second().turn;
        }
        weight += w;
        const double radius_mm = organs_[unrolled_.organ[(ring.low + ring.high) / 2]].radius_mm;
        sums_[r][0].add(ring.first(), radius_mm, w);
        sums_[r][1].add(ring.second(), radius_mm, w);
        sums_[r][2].add(ring.third(), radius_mm, w);
        third_weight[ring.third().number()] += w;
        region.third.turn = ring.third().turn;
        divergence += w * lattice_divergence_rad(ring);
      }
      region.m.number = pair[0];
      region.n.number = pair[1];
      region.third.number =
          std::max_element(third_weight.begin(), third_weight.end(), [](const auto& x, const auto& y) {
            return x.second < y.second;
          })->first;
      finish(region.m, sums_[r][0], weight);
      finish(region.n, sums_[r][1], weight);
      finish(region.third, sums_[r][2], weight);
      region.regularity /= all;
      region.plastochron_ratio = math::exp(rise / all);
      region.divergence_rad = regular_[r] ? divergence / weight : std::numeric_limits<double>::quiet_NaN();
      region.kind = series_of_pair(pair[0], pair[1]);
      if (!regular_[r]) {
        region.kind.series = ParastichySeries::kIrregular;
      }
    }
  }

  ParastichyTransition transition(const ParastichyRegion& inner, const ParastichyRegion& outer) const {
    ParastichyTransition result;
    result.s_mm = outer.from_mm;
    const auto pair = [](const ParastichyRegion& region) {
      return region.kind.series == ParastichySeries::kIrregular ? std::array<std::uint32_t, 2>{}
                                                                : std::array{region.m.number, region.n.number};
    };
    result.inside = pair(inner);
    result.outside = pair(outer);
    const auto [a, b] = result.inside;
    for (const auto& [kept, changed] : {std::pair(a, b), std::pair(b, a)}) {
      for (const std::uint32_t next : {a + b, b - a}) {
        result.continuous |= kept != 0 && next != changed &&
                             (result.outside == std::array{kept, next} || result.outside == std::array{next, kept});
      }
    }
    return result;
  }

  std::span<const PatternOrgan> organs_;
  const ParastichyOptions& options_;
  const Unrolled& unrolled_;
  std::span<const Ring> rings_;
  std::vector<std::uint32_t> ring_of_;  ///< by rank
  std::vector<std::uint32_t> region_of_ring_;
  std::vector<std::size_t> first_ring_;  ///< of each region, and one past the last
  std::vector<bool> regular_;
  std::vector<std::array<FamilySums, 3>> sums_;
};

DivergenceStatistics divergence_of(std::span<const PatternOrgan> organs, std::vector<ParastichyOrgan>& found) {
  DivergenceStatistics result;
  std::vector<double> angles;
  std::size_t before = organs.size();
  std::size_t first = organs.size();
  std::ptrdiff_t balance = 0;
  for (std::size_t i = 0; i < organs.size(); ++i) {
    if (std::isnan(found[i].u)) {
      continue;
    }
    if (before < organs.size()) {
      const double angle = wrapped(organs[i].azimuth_rad - organs[before].azimuth_rad);
      found[i].divergence_rad = angle;
      angles.push_back(angle);
      balance += angle > 0.0 ? 1 : -1;
    } else {
      first = i;
    }
    before = i;
  }
  if (angles.empty()) {
    return result;
  }
  result.turn = balance > 0   ? ParastichyTurn::kCounterClockwise
                : balance < 0 ? ParastichyTurn::kClockwise
                              : ParastichyTurn::kStraight;
  double sine = 0.0;
  double cosine = 0.0;
  for (const double angle : angles) {
    const auto [sin, cos] = math::sin_cos(angle);
    sine += sin;
    cosine += cos;
  }
  const double mean = math::atan2(sine, cosine);
  double squares = 0.0;
  for (const double angle : angles) {
    squares += wrapped(angle - mean) * wrapped(angle - mean);
  }
  const auto count = static_cast<double>(angles.size());
  result.mean_rad = std::abs(mean);
  result.deviation_rad = std::sqrt(squares / count);
  result.plastochron_ratio = math::exp(std::abs(found[before].u - found[first].u) / count);
  return result;
}

}  // namespace

const char* series_name(ParastichySeries series) {
  switch (series) {
    case ParastichySeries::kFibonacci:
      return "fibonacci";
    case ParastichySeries::kLucas:
      return "lucas";
    case ParastichySeries::kMultijugate:
      return "multijugate";
    case ParastichySeries::kWhorled:
      return "whorled";
    case ParastichySeries::kOther:
      return "other";
    case ParastichySeries::kIrregular:
      break;
  }
  return "irregular";
}

SeriesOfPair series_of_pair(std::uint32_t m, std::uint32_t n) {
  SeriesOfPair result;
  if (m > n) {
    std::swap(m, n);
  }
  if (m == 0) {
    return result;
  }
  result.jugacy = std::gcd(m, n);
  std::uint32_t a = m / result.jugacy;
  std::uint32_t b = n / result.jugacy;
  while (b - a < a && b - a > 0 && a > 1) {
    b = std::exchange(a, b - a);
  }
  result.seeds = {a, b};
  if (a == 1 && b == 1) {
    result.series = result.jugacy == 1 ? ParastichySeries::kFibonacci : ParastichySeries::kWhorled;
  } else if (a == 1 && b == 2) {
    result.series = result.jugacy == 1 ? ParastichySeries::kFibonacci : ParastichySeries::kMultijugate;
  } else if (a == 1 && b == 3 && result.jugacy == 1) {
    result.series = ParastichySeries::kLucas;
  } else {
    result.series = ParastichySeries::kOther;
  }
  return result;
}

Parastichies analyse_parastichies(std::span<const PatternOrgan> organs, const ParastichyOptions& options) {
  Parastichies result;
  result.organs.resize(organs.size());
  Analysis analysis(organs);
  const Unrolled& unrolled = analysis.unrolled();
  result.left_out = organs.size() - unrolled.size();
  if (unrolled.size() < kFewestOrgans) {
    return result;
  }
  analysis.run(options.least_regularity);
  Report(analysis, organs, options).write(result);
  if (options.in_order_of_birth) {
    result.divergence = divergence_of(organs, result.organs);
  }
  return result;
}

}  // namespace anthesis
