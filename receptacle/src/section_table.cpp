#include "section_table.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/geometry/arc_length.h"

namespace anthesis::detail {
namespace {

constexpr std::size_t kMostTerms = 13;
constexpr std::size_t kCoarseCells = 1024;

/// T_0 to T_(terms - 1) at x.
void chebyshev(double x, std::size_t terms, std::array<double, kMostTerms>& values) {
  values[0] = 1.0;
  values[1] = x;
  for (std::size_t m = 2; m < terms; ++m) {
    values[m] = 2.0 * x * values[m - 1] - values[m - 2];
  }
}

/// Chebyshev coefficients of the polynomial through the values at the zeros of T_13.
struct Interpolation {
  std::array<double, kMostTerms> node{};
  std::array<std::array<double, kMostTerms>, kMostTerms> share{};  ///< [m][j]
  Interpolation() {
    constexpr double kCount = static_cast<double>(kMostTerms);
    for (std::size_t j = 0; j < kMostTerms; ++j) {
      const double angle = math::kPi * (static_cast<double>(j) + 0.5) / kCount;
      node[j] = math::cos(angle);
      for (std::size_t m = 0; m < kMostTerms; ++m) {
        share[m][j] = (m == 0 ? 1.0 : 2.0) / kCount * math::cos(static_cast<double>(m) * angle);
      }
    }
  }
};

/// One section by its true arc length.
struct ExactSection {
  const BSplineCurve<Vec2>* curve = nullptr;
  ArcLength length;

  Vec2 at(double s) const { return curve->at(length.t_from_s(s)); }
};

struct Coefficients {
  std::array<double, kMostTerms> x{};
  std::array<double, kMostTerms> y{};
};

Coefficients interpolate(const ExactSection& section, double from, double to) {
  static const Interpolation table;
  Coefficients result;
  for (std::size_t j = 0; j < kMostTerms; ++j) {
    const Vec2 point = section.at(0.5 * (from + to) + 0.5 * (to - from) * table.node[j]);
    for (std::size_t m = 0; m < kMostTerms; ++m) {
      result.x[m] += table.share[m][j] * point.x;
      result.y[m] += table.share[m][j] * point.y;
    }
  }
  return result;
}

/// Halves an interval until all sections are met on it to 1e-11 of their length.
void add_breaks(std::span<const ExactSection> sections, double from, double to, int depth,
                std::vector<double>& breaks) {
  constexpr int kDeepest = 8;
  constexpr double kTolerance = 1e-11;
  bool met = true;
  for (std::size_t k = 0; k < sections.size() && met; ++k) {
    const Coefficients c = interpolate(sections[k], from, to);
    const double rest = std::abs(c.x[kMostTerms - 1]) + std::abs(c.x[kMostTerms - 2]) + std::abs(c.y[kMostTerms - 1]) +
                        std::abs(c.y[kMostTerms - 2]);
    met = rest <= kTolerance * sections[k].length.total_mm();
  }
  if (met || depth >= kDeepest) {
    breaks.push_back(to);
    return;
  }
  const double middle = 0.5 * (from + to);
  add_breaks(sections, from, middle, depth + 1, breaks);
  add_breaks(sections, middle, to, depth + 1, breaks);
}

void make_exact(std::span<const DigitisedSection> given, SectionTable& table) {
  std::vector<ExactSection> sections;
  std::vector<double> joints;
  for (const DigitisedSection& section : given) {
    const ExactSection& exact = sections.emplace_back(ExactSection{&section.profile, ArcLength(section.profile)});
    for (const double t : section.profile.knots()) {
      joints.push_back(exact.length.s_from_t(t));
    }
  }
  std::sort(joints.begin(), joints.end());
  constexpr double kSamePlace = 1e-9;
  table.breaks = {0.0};
  for (const double joint : joints) {
    const double from = table.breaks.back();
    if (joint > from + kSamePlace) {
      add_breaks(sections, from, joint > 1.0 - kSamePlace ? 1.0 : joint, 0, table.breaks);
    }
  }
  table.terms = kMostTerms;
  for (const ExactSection& section : sections) {
    for (std::size_t i = 0; i + 1 < table.breaks.size(); ++i) {
      const Coefficients c = interpolate(section, table.breaks[i], table.breaks[i + 1]);
      table.x.insert(table.x.end(), c.x.begin(), c.x.end());
      table.y.insert(table.y.end(), c.y.begin(), c.y.end());
    }
  }
}

/// The published lookup table of a curve: 100 points at equal shares of the length of 1,000 chords to a piece. The last
/// chord of the last piece is missing there, and so it is here.
std::vector<Vec2> published_points(const BSplineCurve<Vec2>& curve) {
  constexpr int kSteps = 1000;
  constexpr std::size_t kPoints = 100;
  const std::vector<double> knots = curve.knots();
  std::vector<Vec2> dense;
  for (std::size_t piece = 0; piece + 1 < knots.size(); ++piece) {
    for (int i = 0; i < kSteps; ++i) {
      dense.push_back(curve.at(knots[piece] + (knots[piece + 1] - knots[piece]) * i / kSteps));
    }
  }
  std::vector<double> so_far(dense.size(), 0.0);
  for (std::size_t i = 1; i < dense.size(); ++i) {
    so_far[i] = so_far[i - 1] + length(dense[i] - dense[i - 1]);
  }
  std::vector<Vec2> points;
  std::size_t chord = 0;
  for (std::size_t i = 0; i + 1 < kPoints; ++i) {
    const double target = so_far.back() * static_cast<double>(i) / (kPoints - 1);
    while (chord + 2 < dense.size() && so_far[chord + 1] < target) {
      ++chord;
    }
    const double step = so_far[chord + 1] - so_far[chord];
    const double share = step > 0.0 ? std::clamp((target - so_far[chord]) / step, 0.0, 1.0) : 0.0;
    points.push_back(lerp(dense[chord], dense[chord + 1], share));
  }
  points.push_back(dense.back());
  return points;
}

void make_published(std::span<const DigitisedSection> given, SectionTable& table) {
  table.terms = 2;
  for (const DigitisedSection& section : given) {
    const std::vector<Vec2> points = published_points(section.profile);
    if (table.breaks.empty()) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        table.breaks.push_back(static_cast<double>(i) / static_cast<double>(points.size() - 1));
      }
    }
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const Vec2 middle = 0.5 * (points[i] + points[i + 1]);
      const Vec2 half = 0.5 * (points[i + 1] - points[i]);
      table.x.insert(table.x.end(), {middle.x, half.x});
      table.y.insert(table.y.end(), {middle.y, half.y});
    }
  }
}

void make_coarse(SectionTable& table) {
  table.coarse.resize(kCoarseCells);
  std::size_t interval = 0;
  for (std::size_t cell = 0; cell < kCoarseCells; ++cell) {
    const double s = static_cast<double>(cell) / kCoarseCells;
    while (interval + 2 < table.breaks.size() && table.breaks[interval + 1] <= s) {
      ++interval;
    }
    table.coarse[cell] = interval;
  }
}

/// Gauss's rule on every interval: the length itself, to rounding for curves without corners.
void make_exact_pieces(SectionTable& table) {
  const GaussTable& gauss = gauss_table();
  const std::size_t intervals = table.intervals();
  table.pieces = intervals * GaussTable::kNodes;
  for (std::size_t k = 0; k < table.sections; ++k) {
    for (std::size_t i = 0; i < intervals; ++i) {
      const double* x = &table.x[(k * intervals + i) * table.terms];
      const double* y = &table.y[(k * intervals + i) * table.terms];
      for (std::size_t j = 0; j < GaussTable::kNodes; ++j) {
        // T_m' = m U_(m-1)
        double before = 0.0;
        double here = 1.0;
        Vec2 slope;
        for (std::size_t m = 1; m < table.terms; ++m) {
          const double degree = static_cast<double>(m);
          slope += Vec2{degree * here * x[m], degree * here * y[m]};
          const double next = 2.0 * gauss.node[j] * here - before;
          before = here;
          here = next;
        }
        table.dx.push_back(gauss.weight[j] * slope.x);
        table.dy.push_back(gauss.weight[j] * slope.y);
      }
    }
  }
}

/// The published sum of 2,000 chords.
void make_published_pieces(SectionTable& table) {
  constexpr std::size_t kChords = 2000;
  table.pieces = kChords;
  for (std::size_t k = 0; k < table.sections; ++k) {
    BasisFunctions only;
    only.first = static_cast<int>(k);
    only.count = 1;
    only.weight[0] = 1.0;
    Vec2 before = table.blend(only, 0.0);
    for (std::size_t i = 1; i <= kChords; ++i) {
      const Vec2 here = table.blend(only, static_cast<double>(i) / kChords);
      table.dx.push_back(here.x - before.x);
      table.dy.push_back(here.y - before.y);
      before = here;
    }
  }
}

}  // namespace

const GaussTable& gauss_table() {
  static const GaussTable table = [] {
    GaussTable made;
    constexpr std::size_t n = GaussTable::kNodes;
    for (std::size_t j = 0; j < n; ++j) {
      double x = -math::cos(math::kPi * (static_cast<double>(j) + 0.75) / (n + 0.5));
      std::array<double, n + 1> p{};
      double slope = 0.0;
      for (int round = 0; round < 10; ++round) {  // Newton; six rounds would do
        p[0] = 1.0;
        p[1] = x;
        for (std::size_t m = 2; m <= n; ++m) {
          const double degree = static_cast<double>(m);
          p[m] = ((2.0 * degree - 1.0) * x * p[m - 1] - (degree - 1.0) * p[m - 2]) / degree;
        }
        slope = static_cast<double>(n) * (x * p[n] - p[n - 1]) / (x * x - 1.0);
        x -= p[n] / slope;
      }
      made.node[j] = x;
      made.weight[j] = 2.0 / ((1.0 - x * x) * slope * slope);
      for (std::size_t m = 0; m < n; ++m) {
        made.legendre[m][j] = (static_cast<double>(m) + 0.5) * made.weight[j] * p[m];
      }
    }
    return made;
  }();
  return table;
}

std::size_t SectionTable::interval_of(double s) const {
  const double cell = std::clamp(s, 0.0, 1.0) * kCoarseCells;
  std::size_t interval = coarse[std::min(static_cast<std::size_t>(cell), kCoarseCells - 1)];
  while (interval + 2 < breaks.size() && breaks[interval + 1] <= s) {
    ++interval;
  }
  return interval;
}

Vec2 SectionTable::blend(const BasisFunctions& weights, double s) const {
  s = std::clamp(s, 0.0, 1.0);
  const std::size_t interval = interval_of(s);
  std::array<double, kMostTerms> t;
  chebyshev(local(interval, s), terms, t);
  Vec2 sum;
  for (int k = 0; k < weights.count; ++k) {
    const std::size_t at = ((static_cast<std::size_t>(weights.first) + k) * intervals() + interval) * terms;
    Vec2 point;
    for (std::size_t m = 0; m < terms; ++m) {
      point += Vec2{t[m] * x[at + m], t[m] * y[at + m]};
    }
    sum += weights.weight[k] * point;
  }
  return sum;
}

double SectionTable::length(const BasisFunctions& weights) const {
  // Three sections at most have a share (degree 2). Four running sums in a fixed order: one would wait for itself.
  std::array<const double*, 3> px{};
  std::array<const double*, 3> py{};
  std::array<double, 3> share{};
  for (int k = 0; k < 3; ++k) {
    const int section = k < weights.count ? weights.first + k : weights.first;
    px[k] = &dx[static_cast<std::size_t>(section) * pieces];
    py[k] = &dy[static_cast<std::size_t>(section) * pieces];
    share[k] = k < weights.count ? weights.weight[k] : 0.0;
  }
  std::array<double, 4> sums{};
  for (std::size_t i = 0; i < pieces; ++i) {
    const double vx = share[0] * px[0][i] + share[1] * px[1][i] + share[2] * px[2][i];
    const double vy = share[0] * py[0][i] + share[1] * py[1][i] + share[2] * py[2][i];
    sums[i % 4] += std::sqrt(vx * vx + vy * vy);
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

SectionTable make_section_table(std::span<const DigitisedSection> sections, double scale, SectionLookup lookup) {
  SectionTable table;
  table.sections = sections.size();
  if (lookup == SectionLookup::kExact) {
    make_exact(sections, table);
  } else {
    make_published(sections, table);
  }
  for (std::size_t i = 0; i < table.x.size(); ++i) {
    table.x[i] *= scale;
    table.y[i] *= scale;
  }
  make_coarse(table);
  if (lookup == SectionLookup::kExact) {
    make_exact_pieces(table);
  } else {
    make_published_pieces(table);
  }
  return table;
}

}  // namespace anthesis::detail
