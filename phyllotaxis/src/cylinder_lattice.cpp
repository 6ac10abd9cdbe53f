#include "anthesis/phyllotaxis/cylinder_lattice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "anthesis/base/assert.h"
#include "anthesis/base/check.h"
#include "anthesis/base/math.h"

namespace anthesis {
namespace {

/// Numerators of p/m and q/n with |n p - m q| = 1, and the interval between them at or below half a turn.
struct Neighbours {
  std::int64_t p = 0;
  std::int64_t q = 1;
};

Neighbours neighbours(std::int64_t m, std::int64_t n) {
  // Euclid on (n, m) gives u with u n = 1 mod m.
  std::int64_t a = n % m;
  std::int64_t b = m;
  std::int64_t u = 1;
  std::int64_t v = 0;
  while (a != 0) {
    const std::int64_t k = b / a;
    b -= k * a;
    v -= k * u;
    std::swap(a, b);
    std::swap(u, v);
  }
  const std::int64_t inverse = ((v % m) + m) % m;
  Neighbours result;
  result.p = (m - inverse) % m;
  result.q = (n * result.p + 1) / m;
  // Above half a turn: the mirror image. Compare p/m + q/n with 1.
  if (result.p * n + result.q * m > m * n) {
    result = {m - result.p, n - result.q};
  }
  return result;
}

Fraction reduced(std::int64_t numerator, std::int64_t denominator) {
  const std::int64_t divisor = std::gcd(numerator, denominator);
  return {numerator / divisor, denominator / divisor};
}

/// The touching lattice whose contact directions m and n have the angle pi - sigma between them, c = cos(sigma) in
/// [-1/2, 1/2]. All follows from |v_m| = |v_n| and the area of the cell, which is the rise:
/// 1 / diameter^2 = m^2 + n^2 + 2 m n c.
TouchingLattice lattice_at(std::int64_t m, std::int64_t n, double c) {
  const auto [p, q] = neighbours(m, n);
  const double area = static_cast<double>(m * m + n * n) + static_cast<double>(2 * m * n) * c;
  TouchingLattice result;
  const double turns = (static_cast<double>(p * m + q * n) + static_cast<double>(p * n + q * m) * c) / area;
  result.divergence_rad = turns * math::kTurnRad;
  result.rise = std::sqrt((1.0 - c) * (1.0 + c)) / area;
  result.radius = 0.5 / std::sqrt(area);
  result.opposed = static_cast<double>(m) + static_cast<double>(n) * c >= 0.0;
  return result;
}

constexpr double kTie = 1e-12;

}  // namespace

std::optional<Error> check(const CylinderLattice& lattice) {
  if (!std::isfinite(lattice.divergence_rad)) {
    return invalid_parameter("divergence_rad", "must be finite", lattice.divergence_rad);
  }
  if (auto error = check_number("rise", lattice.rise, 1e-9, 1e6)) {
    return error;
  }
  return check_whole("jugacy", lattice.jugacy, 1, 1000);
}

std::array<int, 2> ContactParastichies::pair() const {
  return {std::min(families[0].count, families[1].count), std::max(families[0].count, families[1].count)};
}

ContactParastichies contact_parastichies(const CylinderLattice& lattice) {
  ANTHESIS_ASSERT(!check(lattice));
  // A whorl of J is one organ on a J-th of the cylinder.
  const double jugacy = lattice.jugacy;
  const double turns = jugacy * (lattice.divergence_rad / math::kTurnRad);
  const double divergence = turns - std::floor(turns);
  const double rise = jugacy * lattice.rise;

  // A step by its whole numbers: once around `rounds` times, `index` organs up. Its length never inherits rounding.
  struct Step {
    std::int64_t rounds;
    std::int64_t index;
    Vec2 vector;
  };
  const auto step = [&](std::int64_t rounds, std::int64_t index) {
    const double k = static_cast<double>(index);
    return Step{rounds, index, {static_cast<double>(rounds) + k * divergence, k * rise}};
  };
  Step a = step(1, 0);
  Step b = step(0, 1);
  for (int i = 0; i < 200; ++i) {  // Gauss's reduction ends long before
    if (dot(b.vector, b.vector) < dot(a.vector, a.vector)) {
      std::swap(a, b);
    }
    const double k = std::floor(dot(a.vector, b.vector) / dot(a.vector, a.vector) + 0.5);
    const auto whole = static_cast<std::int64_t>(k);
    const Step shorter = step(b.rounds - whole * a.rounds, b.index - whole * a.index);
    if (whole == 0 || !(dot(shorter.vector, shorter.vector) < dot(b.vector, b.vector))) {
      break;
    }
    b = shorter;
  }
  const std::int64_t sign = dot(a.vector, b.vector) > 0.0 ? -1 : 1;
  const Step third = step(b.rounds + sign * a.rounds, b.index + sign * a.index);

  ContactParastichies result;
  std::size_t i = 0;
  for (const Step& s : {a, b, third}) {
    const double up = s.index < 0 ? -1.0 : 1.0;
    result.families[i++] = {static_cast<int>(std::abs(s.index)) * lattice.jugacy, up * s.vector.x / jugacy,
                            length(s.vector) / jugacy};
  }
  // Three elements: exchanges keep the order of near ties well defined where a sort with a tolerance would not be.
  const auto exchange = [&](std::size_t j, std::size_t k) {
    LatticeFamily& low = result.families[j];
    LatticeFamily& high = result.families[k];
    const bool tie = std::abs(low.distance - high.distance) <= kTie * high.distance;
    if (tie ? high.count < low.count : high.distance < low.distance) {
      std::swap(low, high);
    }
  };
  exchange(0, 1);
  exchange(1, 2);
  exchange(0, 1);
  return result;
}

std::optional<Error> check_parastichy_pair(int m, int n) {
  if (auto error = check_whole("m", m, 1, 10000)) {
    return error;
  }
  if (auto error = check_whole("n", n, m, 10000)) {
    return error;
  }
  if (std::gcd(m, n) != 1) {
    return invalid_parameter("n", "must have no common divisor with m, " + std::to_string(m), n);
  }
  return std::nullopt;
}

std::array<Fraction, 2> opposed_interval(int m, int n) {
  ANTHESIS_ASSERT(!check_parastichy_pair(m, n));
  const auto [p, q] = neighbours(m, n);
  const Fraction of_m{p, m};
  const Fraction of_n{q, n};
  return p * n < q * m ? std::array{of_m, of_n} : std::array{of_n, of_m};
}

HexagonalLattice hexagonal_lattice(int m, int n) {
  ANTHESIS_ASSERT(!check_parastichy_pair(m, n));
  const auto [p, q] = neighbours(m, n);
  const std::int64_t a = m;
  const std::int64_t b = n;
  const std::int64_t norm = a * a + a * b + b * b;
  Fraction turns = reduced(2 * (p * a + q * b) + p * b + q * a, 2 * norm);
  if (2 * turns.numerator > turns.denominator) {
    turns.numerator = turns.denominator - turns.numerator;
  }
  return {turns, norm};
}

std::array<double, 2> touching_radii(int m, int n) {
  ANTHESIS_ASSERT(!check_parastichy_pair(m, n));
  const double squares = static_cast<double>(m) * m + static_cast<double>(n) * n;
  const double product = static_cast<double>(m) * n;
  return {0.5 / std::sqrt(squares + product), 0.5 / std::sqrt(squares - product)};
}

TouchingLattice touching_lattice(int m, int n, double radius) {
  const auto [narrow, wide] = touching_radii(m, n);
  const double r = std::clamp(radius, narrow, wide);
  const double squares = static_cast<double>(m) * m + static_cast<double>(n) * n;
  const double c = (0.25 / (r * r) - squares) / (2.0 * m * n);
  return lattice_at(m, n, std::clamp(c, -0.5, 0.5));
}

std::optional<Error> check(const DiagramParams& params) {
  if (auto error = check_number("least_radius", params.least_radius, 0.001, 0.5)) {
    return error;
  }
  return check_number("arc_samples", static_cast<double>(params.arc_samples), 2.0, 1000.0);
}

Expected<std::vector<LatticeArc>> van_iterson_diagram(const DiagramParams& params) {
  if (auto error = check(params)) {
    return unexpected(*error);
  }
  std::vector<LatticeArc> arcs;
  std::vector<std::array<int, 2>> generation = {{1, 1}};
  while (!generation.empty()) {
    std::vector<std::array<int, 2>> next;
    for (const std::array<int, 2>& pair : generation) {
      const int m = pair[0];
      const int n = pair[1];
      const auto [narrow, wide] = touching_radii(m, n);
      if (wide <= params.least_radius) {
        continue;
      }
      LatticeArc arc{m, n, {}, 0};
      // Even steps of the angle between the contact directions; the arc is a circle in (divergence, rise), and its
      // border of opposition, where n is vertical, gets a point of its own.
      const double border = -static_cast<double>(m) / n;
      double before = -1.0;
      for (std::size_t i = 0; i < params.arc_samples; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(params.arc_samples - 1);
        double c = std::clamp(math::cos(math::kPi * (2.0 - share) / 3.0), -0.5, 0.5);
        if (i == 0 || i + 1 == params.arc_samples) {
          c = i == 0 ? -0.5 : 0.5;
        }
        if (before > -1.0 && before < border && c > border) {
          arc.points.push_back(lattice_at(m, n, border));
          arc.points.back().opposed = true;
        }
        arc.points.push_back(lattice_at(m, n, c));
        before = c;
      }
      if (narrow < params.least_radius) {
        while (arc.points.back().radius < params.least_radius) {
          arc.points.pop_back();
        }
        arc.points.push_back(touching_lattice(m, n, params.least_radius));
      }
      while (arc.first_opposed < arc.points.size() && !arc.points[arc.first_opposed].opposed) {
        ++arc.first_opposed;
      }
      arcs.push_back(std::move(arc));
      next.push_back({n, m + n});
      if (m != n) {
        next.push_back({m, m + n});
      }
    }
    generation = std::move(next);
  }
  return arcs;
}

FibonacciLattice fibonacci_lattice(double radius) {
  FibonacciLattice result;
  const double r = std::clamp(radius, 1e-4, 0.5);
  while (r < touching_radii(result.m, result.n)[0]) {
    result.m = std::exchange(result.n, result.m + result.n);
  }
  result.lattice = touching_lattice(result.m, result.n, r);
  return result;
}

PatternMeasure measure_pattern(std::span<const Vec2> unrolled, std::size_t first, std::size_t last) {
  ANTHESIS_ASSERT(first + 1 < last && last <= unrolled.size());
  PatternMeasure result;
  const auto wrapped = [](double turns) { return turns - std::floor(turns + 0.5); };  // to [-1/2, 1/2)

  Vec2 sum;
  for (std::size_t i = first + 1; i < last; ++i) {
    const math::SinCos step = math::sin_cos(math::kTurnRad * wrapped(unrolled[i].x - unrolled[i - 1].x));
    sum += Vec2{step.cos, step.sin};
  }
  const double angle = math::atan2(sum.y, sum.x);
  result.divergence_rad = angle < 0.0 ? angle + math::kTurnRad : angle;
  double squares = 0.0;
  for (std::size_t i = first + 1; i < last; ++i) {
    const double off = wrapped(unrolled[i].x - unrolled[i - 1].x - result.divergence_rad / math::kTurnRad);
    squares += off * off;
  }
  result.deviation_rad = math::kTurnRad * std::sqrt(squares / static_cast<double>(last - first - 1));

  std::map<std::array<std::size_t, 2>, std::size_t> pairs;
  double distances = 0.0;
  std::size_t counted = 0;
  for (std::size_t i = first; i < last; ++i) {
    std::array<double, 2> nearest = {1e300, 1e300};
    std::array<std::size_t, 2> difference = {0, 0};
    for (std::size_t j = 0; j < unrolled.size(); ++j) {
      if (j == i) {
        continue;
      }
      // The step from the older to the younger organ leans left or right, whichever end is looked at.
      const double x = wrapped(j > i ? unrolled[j].x - unrolled[i].x : unrolled[i].x - unrolled[j].x);
      const double y = unrolled[j].y - unrolled[i].y;
      const double squared = x * x + y * y;
      // A vertical step, and one that is half-way around, leans both ways.
      const bool both = std::abs(x) < kTie || std::abs(std::abs(x) - 0.5) < kTie;
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        if ((both || (x > 0.0) == (side == 1)) && squared < nearest[side]) {
          nearest[side] = squared;
          difference[side] = j > i ? j - i : i - j;
        }
      }
    }
    if (difference[0] == 0 || difference[1] == 0) {
      continue;
    }
    std::sort(difference.begin(), difference.end());
    ++pairs[difference];
    distances += std::sqrt(std::min(nearest[0], nearest[1]));
    ++counted;
  }
  std::size_t most = 0;
  for (const auto& [pair, count] : pairs) {
    if (count > most) {
      most = count;
      result.m = static_cast<int>(pair[0]);
      result.n = static_cast<int>(pair[1]);
    }
  }
  if (counted > 0) {
    result.agreement = static_cast<double>(most) / static_cast<double>(counted);
    result.distance = distances / static_cast<double>(counted);
  }
  return result;
}

}  // namespace anthesis
