#include "lattice.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace anthesis::detail {
namespace {

constexpr std::size_t kMostSides = 384;  ///< for choosing among trials; least squares uses them all
constexpr std::size_t kMostTrials = 64;

double squared(double x) {
  return x * x;
}

/// Moves the lattice so that it fits the sides that are near to its vectors, in the sense of least squares.
Lattice refit(const Lattice& lattice, std::span<const Vec2> sides) {
  double aa = 0.0;
  double ab = 0.0;
  double bb = 0.0;
  Vec2 va;
  Vec2 vb;
  for (const Vec2 side : sides) {
    const Vec2 c = lattice.coordinates(side);
    const double p = std::nearbyint(c.x);
    const double q = std::nearbyint(c.y);
    if (squared(c.x - p) + squared(c.y - q) > squared(0.35)) {
      continue;
    }
    aa += p * p;
    ab += p * q;
    bb += q * q;
    va += p * side;
    vb += q * side;
  }
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > 0.5)) {
    return lattice;
  }
  return {(bb * va - ab * vb) / determinant, (aa * vb - ab * va) / determinant};
}

}  // namespace

Steps Lattice::nearest(Vec2 v) const {
  const Vec2 c = coordinates(v);
  return {static_cast<std::int32_t>(std::lround(std::clamp(c.x, -1e6, 1e6))),
          static_cast<std::int32_t>(std::lround(std::clamp(c.y, -1e6, 1e6)))};
}

Lattice reduced(Vec2 a, Vec2 b) {
  for (int guard = 0; guard < 200; ++guard) {
    if (dot(a, a) > dot(b, b)) {
      std::swap(a, b);
    }
    const double whole = std::nearbyint(dot(a, b) / dot(a, a));
    if (whole == 0.0 || !std::isfinite(whole)) {
      break;
    }
    b = b - whole * a;
  }
  const auto outwards = [](Vec2 v) { return v.y < 0.0 || (v.y == 0.0 && v.x < 0.0) ? -v : v; };
  return {outwards(a), outwards(b)};
}

double agreement(const Lattice& lattice, std::span<const Vec2> sides) {
  double sum = 0.0;
  for (const Vec2 side : sides) {
    const Vec2 c = lattice.coordinates(side);
    sum += squared(c.x - std::nearbyint(c.x)) + squared(c.y - std::nearbyint(c.y));
  }
  return sides.empty() ? 0.0 : 1.0 - 6.0 * sum / static_cast<double>(sides.size());
}

Lattice fit_lattice(std::span<const Vec2> sides, std::span<const std::array<Vec2, 2>> trials, double area) {
  std::vector<Vec2> sample;
  const std::size_t wanted = std::min(sides.size(), kMostSides);
  for (std::size_t i = 0; i < wanted; ++i) {
    sample.push_back(sides[i * sides.size() / wanted]);
  }
  Lattice best;
  double best_agreement = -1e9;
  const std::size_t tried = std::min(trials.size(), kMostTrials);
  for (std::size_t i = 0; i < tried; ++i) {
    const std::array<Vec2, 2>& trial = trials[i * trials.size() / tried];
    // A lattice with small cells fits anything: the cell has to be an organ's share of the surface.
    const double share = std::abs(cross(trial[0], trial[1])) / area;
    if (!(share > 0.6 && share < 1.7)) {
      continue;
    }
    const Lattice lattice = reduced(trial[0], trial[1]);
    const double agrees = agreement(lattice, sample);
    if (agrees > best_agreement) {
      best_agreement = agrees;
      best = lattice;
    }
  }
  if (best_agreement == -1e9) {
    return best;
  }
  for (int round = 0; round < 3; ++round) {
    const Lattice next = refit(best, sides);
    const double share = std::abs(cross(next.a, next.b)) / area;
    if (!(share > 0.6 && share < 1.7)) {
      break;
    }
    best = reduced(next.a, next.b);
  }
  return best;
}

}  // namespace anthesis::detail
