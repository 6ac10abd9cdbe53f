#include "generator_curve.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"

namespace anthesis {
namespace {

constexpr int kOrganDegree = 5;
constexpr int kDeepestSplit = 12;

/// Coefficients of the powers of x out of Bezier control points over [0, 1].
template <class Value, std::size_t N>
void powers_of(const std::array<Value, N>& control, int degree, std::array<Value, N>& power) {
  std::array<Value, N> difference = control;
  double choose = 1.0;
  for (int k = 0; k <= degree; ++k) {
    power[k] = choose * difference[0];
    for (int i = 0; i + k < degree; ++i) {
      difference[i] = difference[i + 1] - difference[i];
    }
    choose = choose * (degree - k) / (k + 1);
  }
}

/// Cuts a Bezier curve at x: `left` and `right` are its parts.
template <class Value, std::size_t N>
void cut(const std::array<Value, N>& control, int degree, double x, std::array<Value, N>& left,
         std::array<Value, N>& right) {
  std::array<Value, N> d = control;
  for (int r = 0; r <= degree; ++r) {
    left[r] = d[0];
    right[degree - r] = d[degree - r];
    for (int i = 0; i < degree - r; ++i) {
      d[i] = (1.0 - x) * d[i] + x * d[i + 1];
    }
  }
}

template <class Value, std::size_t N>
void raise_degree(std::array<Value, N>& control, int degree, int wanted) {
  for (int d = degree; d < wanted; ++d) {
    control[d + 1] = control[d];
    for (int i = d; i > 0; --i) {
      const double share = static_cast<double>(i) / (d + 1);
      control[i] = share * control[i - 1] + (1.0 - share) * control[i];
    }
  }
}

/// Bezier coefficients of the polynomial of degree kOrganDegree through values at the points i / kOrganDegree.
std::array<double, kMaxDegree + 1> interpolate(const std::array<double, kOrganDegree + 1>& value) {
  constexpr int kN = kOrganDegree;
  // Newton's forward differences give the powers of k = kN x through binomials; then powers to Bezier form.
  std::array<double, kN + 1> difference = value;
  std::array<double, kN + 1> power{};       // of x
  std::array<double, kN + 1> falling{1.0};  // k (k - 1) ... / i! as powers of x
  for (int i = 0; i <= kN; ++i) {
    for (int j = 0; j <= i; ++j) {
      power[j] += difference[0] * falling[j];
    }
    for (int j = 0; j + i < kN; ++j) {
      difference[j] = difference[j + 1] - difference[j];
    }
    if (i < kN) {
      std::array<double, kN + 1> next{};
      for (int j = 0; j <= i; ++j) {
        next[j] -= falling[j] * i / (i + 1);
        next[j + 1] += falling[j] * kN / (i + 1);
      }
      falling = next;
    }
  }
  std::array<double, kMaxDegree + 1> control{};
  for (int j = 0; j <= kN; ++j) {
    double share = 1.0;  // (j choose i) / (kN choose i)
    for (int i = 0; i <= j; ++i) {
      control[j] += share * power[i];
      share = i < j ? share * (j - i) / (kN - i) : 0.0;
    }
  }
  return control;
}

template <std::size_t N>
double bezier_value(std::array<double, N> control, int degree, double x) {
  for (int r = degree; r > 0; --r) {
    for (int i = 0; i < r; ++i) {
      control[i] = (1.0 - x) * control[i] + x * control[i + 1];
    }
  }
  return control[0];
}

}  // namespace

void GeneratorCurve::build(const SurfaceOfRevolution& surface, const FunctionGraph* radius_mm) {
  const BSplineCurve<Vec2>& profile = surface.profile_mm();
  degree_ = profile.degree;
  const std::vector<double> knots = profile.knots();
  const std::vector<Vec2> controls = profile.bezier_controls();
  low_mm_ = high_mm_ = controls.front();
  for (const Vec2 c : controls) {
    low_mm_ = {std::min(low_mm_.x, c.x), std::min(low_mm_.y, c.y)};
    high_mm_ = {std::max(high_mm_.x, c.x), std::max(high_mm_.y, c.y)};
    extent_mm_ = std::max({extent_mm_, std::abs(c.x), std::abs(c.y)});
  }
  organ_degree_ = radius_mm == nullptr ? 0 : kOrganDegree;
  least_organ_mm_ = radius_mm == nullptr ? 0.0 : (*radius_mm)(0.0);

  struct Part {
    double from;
    double to;
    std::array<Vec2, kMaxDegree + 1> control;
    int depth;
  };
  std::vector<Part> waiting;  // the next towards the tip on top
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    Part part{knots[i + 1], knots[i], {}, 0};
    for (int k = 0; k <= degree_; ++k) {
      part.control[k] = controls[i * (degree_ + 1) + (degree_ - k)];
    }
    // The radius by place has knots of its own, where it must be cut to converge.
    if (radius_mm != nullptr) {
      std::vector<double> cuts;
      for (const double s : radius_mm->breaks()) {
        const double t = s > 0.0 && s < 1.0 ? surface.t_from_s(s) : -1.0;
        if (t > knots[i] && t < knots[i + 1]) {
          cuts.push_back(t);
        }
      }
      std::sort(cuts.begin(), cuts.end());
      // From the tip upwards, so that the parts come to lie on top of each other in order.
      for (const double t : cuts) {
        Part tip = part;
        cut(part.control, degree_, (part.from - t) / (part.from - part.to), part.control, tip.control);
        tip.from = t;
        part.to = t;
        waiting.push_back(tip);
      }
    }
    waiting.push_back(part);
  }
  while (!waiting.empty()) {
    Part part = waiting.back();
    waiting.pop_back();
    Piece piece;
    piece.from = part.from;
    piece.width = part.to - part.from;
    piece.control = part.control;
    bool fits = true;
    bool is_negative = false;  // an error that the caller reports
    if (radius_mm != nullptr) {
      const auto radius_at = [&](double x) { return (*radius_mm)(surface.s_from_t(part.from + x * piece.width)); };
      std::array<double, kOrganDegree + 1> value;
      for (int i = 0; i <= kOrganDegree; ++i) {
        value[i] = radius_at(static_cast<double>(i) / kOrganDegree);
      }
      piece.organ_control = interpolate(value);
      const auto first = piece.organ_control.begin();
      is_negative = !(*std::min_element(value.begin(), value.end()) > 0.0);
      fits = is_negative || *std::min_element(first, first + kOrganDegree + 1) > 0.0;
      for (const double x : {0.08, 0.3, 0.5, 0.71, 0.93}) {
        fits &= is_negative ||
                std::abs(bezier_value(piece.organ_control, kOrganDegree, x) - radius_at(x)) <= 1e-12 * value[0];
      }
    }
    finish(piece);
    // Even pieces make the bounds sharp; where the speed vanishes halving stops and subdivision takes over.
    const bool even =
        piece.fastest <= 1.1 * piece.slowest && (piece.organ_largest <= 1.1 * piece.organ_least || is_negative);
    if (!(fits && even) && part.depth < kDeepestSplit) {
      Part nearer = part;
      Part further = part;
      const double middle = 0.5 * (part.from + part.to);
      cut(part.control, degree_, 0.5, nearer.control, further.control);
      nearer.to = further.from = middle;
      nearer.depth = further.depth = part.depth + 1;
      waiting.push_back(further);
      waiting.push_back(nearer);
      continue;
    }
    const auto [least, largest] =
        std::minmax_element(piece.organ_control.begin(), piece.organ_control.begin() + organ_degree_ + 1);
    least_organ_mm_ = std::min(least_organ_mm_, *least);
    largest_organ_mm_ = std::max(largest_organ_mm_, *largest);
    const int common = std::max(degree_, organ_degree_);
    raise_degree(piece.control, degree_, common);
    raise_degree(piece.organ_control, organ_degree_, common);
    pieces_.push_back(piece);
  }
}

void GeneratorCurve::finish(Piece& piece) {
  powers_of(piece.control, degree_, piece.power);
  powers_of(piece.organ_control, organ_degree_, piece.organ_power);
  // A polynomial stays within the hull of its control points, and so do its derivatives.
  const Vec2 along = normalized(piece.control[degree_] - piece.control[0]);
  piece.slowest = length(piece.control[degree_] - piece.control[0]);
  for (int i = 0; i < degree_; ++i) {
    const Vec2 step = static_cast<double>(degree_) * (piece.control[i + 1] - piece.control[i]);
    piece.slowest = std::min(piece.slowest, dot(step, along));
    piece.fastest = std::max(piece.fastest, length(step));
    if (i > 0) {
      const Vec2 change = piece.control[i + 1] - 2.0 * piece.control[i] + piece.control[i - 1];
      piece.bend = std::max(piece.bend, degree_ * (degree_ - 1) * length(change));
    }
  }
  piece.organ_largest = piece.organ_least = piece.organ_control[0];
  for (int i = 0; i < organ_degree_; ++i) {
    const auto& c = piece.organ_control;
    piece.organ_least = std::min(piece.organ_least, c[i + 1]);
    piece.organ_largest = std::max(piece.organ_largest, c[i + 1]);
    piece.organ_slope = std::max(piece.organ_slope, organ_degree_ * std::abs(c[i + 1] - c[i]));
    if (i > 0) {
      piece.organ_bend =
          std::max(piece.organ_bend, organ_degree_ * (organ_degree_ - 1) * std::abs(c[i + 1] - 2.0 * c[i] + c[i - 1]));
    }
  }
}

GeneratorPlace GeneratorCurve::place_of(double t) const {
  const auto after =
      std::partition_point(pieces_.begin(), pieces_.end(), [&](const Piece& piece) { return piece.from >= t; });
  const std::ptrdiff_t index = std::max<std::ptrdiff_t>(after - pieces_.begin() - 1, 0);
  const Piece& piece = pieces_[index];
  return {static_cast<std::uint32_t>(index), std::clamp((t - piece.from) / piece.width, 0.0, 1.0)};
}

std::array<double, 2> GeneratorCurve::stretch_about(GeneratorPlace place, double way_mm) const {
  // With radii by place no further than the pieces that least_organ_near_mm speaks of.
  const std::uint32_t most = organ_degree_ > 0 ? 1 : static_cast<std::uint32_t>(pieces_.size());
  const std::uint32_t first = place.piece > most ? place.piece - most : 0;
  const std::uint32_t last = std::min(place.piece + most, static_cast<std::uint32_t>(pieces_.size()) - 1);
  way_mm *= 1.0 - 1e-9;  // so that rounding does not make it more
  std::uint32_t piece = place.piece;
  double x = place.x;
  double rest = way_mm;
  while (x * pieces_[piece].fastest < rest && piece > first) {
    rest -= x * pieces_[piece].fastest;
    --piece;
    x = 1.0;
  }
  const double low = piece + std::max(x - rest / pieces_[piece].fastest, 0.0);
  piece = place.piece;
  x = place.x;
  rest = way_mm;
  while ((1.0 - x) * pieces_[piece].fastest < rest && piece < last) {
    rest -= (1.0 - x) * pieces_[piece].fastest;
    ++piece;
    x = 0.0;
  }
  return {low, piece + std::min(x + rest / pieces_[piece].fastest, 1.0)};
}

/// Square of the distance, less the square of the distance that is asked for, and its derivative by x.
double GeneratorCurve::excess(const Piece& piece, double x, const ForbiddenDisc& disc, double own_mm, double factor,
                              double& slope) const {
  const Point p = at({static_cast<std::uint32_t>(&piece - pieces_.data()), x});
  const Vec2 apart = p.position_mm - disc.centre;
  const double wanted = factor * (disc.radius_mm + own_mm + p.organ_mm);
  slope = 2.0 * (dot(apart, p.derivative) - wanted * factor * p.organ_derivative);
  return dot(apart, apart) + disc.aside2 - wanted * wanted;
}

bool GeneratorCurve::leave(GeneratorPlace& from, const ForbiddenDisc& disc, double own_mm, double factor) const {
  const GeneratorPlace start = from;
  while (!leave_piece(from.piece, from.x, disc, own_mm, factor)) {
    if (from.piece + 1 == pieces_.size()) {
      return false;
    }
    from = {from.piece + 1, 0.0};
  }
  if (!(start < from)) {  // rounding must not stop the climb
    from.x = std::min(start.x + 1e-15, 1.0);
    if (!(start < from)) {
      if (from.piece + 1 == pieces_.size()) {
        return false;
      }
      from = {from.piece + 1, 0.0};
    }
  }
  return true;
}

/// The first root of the excess after x in a piece, given that it is negative at x or x is on the border by rounding.
///
/// Half the second derivative of the excess is |C'|^2 + (C - c).C'' - w'^2 - w w'', w the wanted distance. As long as
/// the centres are at most 4 w apart, it is at least m = slowest^2 - 4 w bend - w'^2 - w |w''|. If m > 0 the excess is
/// convex there, has one root, and lies above the parabola of second derivative 2 m at x, whose root is beyond that
/// root; Newton's method from there comes down to it without fail.
bool GeneratorCurve::leave_piece(std::uint32_t index, double& x, const ForbiddenDisc& disc, double own_mm,
                                 double factor) const {
  const Piece& piece = pieces_[index];
  const double wanted = factor * (disc.radius_mm + own_mm + piece.organ_largest);
  const double wanted_slope = factor * piece.organ_slope;
  const double m = piece.slowest * piece.slowest - 4.0 * wanted * piece.bend - wanted_slope * wanted_slope -
                   wanted * factor * piece.organ_bend;
  double slope = 0.0;
  const double here = excess(piece, x, disc, own_mm, factor, slope);
  if (here >= 0.0) {
    return true;
  }
  if (!(m > 0.0 && piece.slowest > 0.0)) {
    return leave_by_subdivision(piece, x, disc, own_mm, factor);
  }
  const double half = 0.5 * slope;
  const double ahead = (std::sqrt(half * half - m * here) - half) / m;
  if (!(piece.fastest * std::min(ahead, 1.0 - x) <= 3.0 * wanted)) {
    return leave_by_subdivision(piece, x, disc, own_mm, factor);
  }
  double y = x + ahead;
  double value = 0.0;
  if (y >= 1.0) {
    y = 1.0;
    value = excess(piece, y, disc, own_mm, factor, slope);
    if (value < 0.0) {
      return false;
    }
  } else {
    value = excess(piece, y, disc, own_mm, factor, slope);
  }
  for (int step = 0; step < 60 && value > 0.0 && slope > 0.0; ++step) {
    const double down = value / slope;
    y -= down;
    if (down <= 1e-9) {  // the next error is about its square, by the ratio m / slope of a graze at worst
      break;
    }
    value = excess(piece, y, disc, own_mm, factor, slope);
  }
  x = std::max(x, y);
  return true;
}

/// The same without conditions: the excess as a Bernstein polynomial, whose coefficients bound it, halved until each
/// stretch has no root (all coefficients negative) or one (one change of sign).
bool GeneratorCurve::leave_by_subdivision(const Piece& piece, double& x, const ForbiddenDisc& disc, double own_mm,
                                          double factor) const {
  constexpr int kTerms = 2 * kMaxDegree + 1;
  using Coefficients = std::array<double, kTerms>;
  const int half = std::max(degree_, organ_degree_);
  const int degree = 2 * half;
  std::array<double, kMaxDegree + 1> dx;
  std::array<double, kMaxDegree + 1> dy;
  std::array<double, kMaxDegree + 1> wanted;
  {
    std::array<Vec2, kMaxDegree + 1> unused;
    std::array<Vec2, kMaxDegree + 1> control;
    std::array<double, kMaxDegree + 1> organ_unused;
    std::array<double, kMaxDegree + 1> organ;
    cut(piece.control, half, x, unused, control);
    cut(piece.organ_control, half, x, organ_unused, organ);
    for (int i = 0; i <= half; ++i) {
      dx[i] = control[i].x - disc.centre.x;
      dy[i] = control[i].y - disc.centre.y;
      wanted[i] = factor * (disc.radius_mm + own_mm + organ[i]);
    }
  }
  std::array<double, kMaxDegree + 1> choose;
  choose[0] = 1.0;
  for (int i = 0; i < half; ++i) {
    choose[i + 1] = choose[i] * (half - i) / (i + 1);
  }
  struct Stretch {
    double from;
    double to;
    Coefficients c;
  };
  std::array<Stretch, 60> stack;
  int top = 0;
  stack[0] = {0.0, 1.0, {}};
  double all = 1.0;  // (degree choose k)
  for (int k = 0; k <= degree; ++k) {
    double sum = 0.0;
    for (int i = std::max(0, k - half); i <= std::min(k, half); ++i) {
      sum += choose[i] * choose[k - i] * (dx[i] * dx[k - i] + dy[i] * dy[k - i] - wanted[i] * wanted[k - i]);
    }
    stack[0].c[k] = sum / all + disc.aside2;
    all = all * (degree - k) / (k + 1);
  }
  const double rest = 1.0 - x;
  while (top >= 0) {
    const Stretch stretch = stack[top--];
    int changes = 0;
    for (int k = 0; k < degree; ++k) {
      changes += (stretch.c[k] < 0.0) != (stretch.c[k + 1] < 0.0) ? 1 : 0;
    }
    if (changes == 0 && stretch.c[0] < 0.0) {
      continue;
    }
    if (stretch.c[0] >= 0.0) {  // left before it begins
      x += rest * stretch.from;
      return true;
    }
    if (changes > 1 && top + 2 < static_cast<int>(stack.size()) && stretch.to - stretch.from > 1e-15) {
      const double middle = 0.5 * (stretch.from + stretch.to);
      Stretch& right = stack[++top];
      right.from = middle;
      right.to = stretch.to;
      Stretch& left = stack[++top];
      left.from = stretch.from;
      left.to = middle;
      cut(stretch.c, degree, 0.5, left.c, right.c);
      continue;
    }
    // One root (or a cluster narrower than rounding): Newton's method inside a bracket.
    double low = x + rest * stretch.from;
    double high = x + rest * stretch.to;
    if (changes > 1 && stretch.c[degree] < 0.0) {
      continue;
    }
    double y = 0.5 * (low + high);
    for (int step = 0; step < 100; ++step) {
      double slope = 0.0;
      const double value = excess(piece, y, disc, own_mm, factor, slope);
      (value < 0.0 ? low : high) = y;
      const double next = slope > 0.0 ? y - value / slope : low;
      const bool newton = next > low && next < high;
      const double moved = std::abs((newton ? next : 0.5 * (low + high)) - y);
      y = newton ? next : 0.5 * (low + high);
      if (moved <= 4e-16 || high - low <= 4e-16) {
        break;
      }
    }
    x = y;
    return true;
  }
  return false;
}

}  // namespace anthesis
