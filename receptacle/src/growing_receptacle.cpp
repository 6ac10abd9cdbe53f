#include "anthesis/receptacle/growing_receptacle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "anthesis/base/assert.h"
#include "anthesis/base/check.h"
#include "anthesis/geometry/predicates.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "section_table.h"

namespace anthesis {

using detail::gauss_table;
using detail::GaussTable;
using detail::SectionTable;

namespace {

constexpr int kDegree = 2;                  // in time, and along the material coordinate
constexpr std::size_t kFewestSections = 3;  // a quadratic's
constexpr std::size_t kMostSections = 100;
constexpr std::size_t kMostControls = 10'000;
constexpr std::size_t kMaterialSteps = 1000;  // as published

std::string indexed(const char* name, std::size_t i) {
  return std::string(name) + '[' + std::to_string(i) + ']';
}

/// Series miss the axis by a rounding; a radius is never negative.
Vec2 right_of_axis(Vec2 point) {
  return {std::max(point.x, 0.0), point.y};
}

std::optional<Error> check_simple(const std::string& where, const BSplineCurve<Vec2>& profile) {
  constexpr int kSteps = 256;
  std::vector<Vec2> line;
  for (int i = 0; i <= kSteps; ++i) {
    line.push_back(right_of_axis(profile.at(static_cast<double>(i) / kSteps)));
  }
  if (const std::optional<Vec2> place = place_of_crossing(line)) {
    const auto rounded = [](double value) { return to_text(std::round(1e3 * value) / 1e3); };
    std::string twice = "the place ";
    twice.append(rounded(place->x)).append(", ").append(rounded(place->y)).append(" twice");
    return invalid_parameter(where, "must not touch or cross itself", twice);
  }
  return std::nullopt;
}

std::optional<Error> check_section(const std::string& where, const DigitisedSection& section) {
  if (auto error = check_profile(where + ".profile", section.profile)) {
    return error;
  }
  if (auto error = check_simple(where + ".profile", section.profile)) {
    return error;
  }
  if (auto error = check_number(where + ".ring", section.ring, 0.0, 1.0)) {
    return error;
  }
  double outside = 1.0;
  for (std::size_t i = 0; i < section.landmarks.size(); ++i) {
    const double s = section.landmarks[i];
    if (!(s > 0.0 && (i == 0 ? s <= outside : s < outside))) {
      return invalid_parameter(where + '.' + indexed("landmarks", i), "must descend within (0, 1]", s);
    }
    outside = s;
  }
  return std::nullopt;
}

std::optional<Error> check_knots(std::span<const double> knots, std::size_t sections) {
  if (knots.empty()) {
    return std::nullopt;
  }
  if (knots.size() != sections + kDegree + 1) {
    return invalid_parameter("knots", "must be three more than the " + std::to_string(sections) + " sections",
                             static_cast<double>(knots.size()));
  }
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const std::string where = indexed("knots", i);
    if (i <= kDegree && knots[i] != 0.0) {
      return invalid_parameter(where, "must be 0, as the first three", knots[i]);
    }
    if (i >= sections && knots[i] != 1.0) {
      return invalid_parameter(where, "must be 1, as the last three", knots[i]);
    }
    if (i > kDegree && i < sections && !(knots[i] > 0.0 && knots[i] < 1.0 && knots[i] >= knots[i - 1])) {
      return invalid_parameter(where, "must ascend between 0 and 1", knots[i]);
    }
    if (i >= kDegree + 3 && i < sections && knots[i] == knots[i - 2]) {
      return invalid_parameter(where, "must not be the third of its value", knots[i]);
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Vec2> place_of_crossing(std::span<const Vec2> outline) {
  double size = 0.0;
  for (const Vec2 point : outline) {
    size = std::max({size, std::fabs(point.x), std::fabs(point.y)});
  }
  std::vector<Vec2> line;  // outlines may stand still for some points
  for (const Vec2 point : outline) {
    if (line.empty() || length(point - line.back()) > 1e-6 * size) {
      line.push_back(point);
    }
  }
  const auto pieces = crossing_pieces(line, false);
  return pieces ? std::optional<Vec2>(line[(*pieces)[1]]) : std::nullopt;
}

BSplineCurve<Vec2> traced_profile(std::vector<Vec2> points) {
  ANTHESIS_ASSERT(points.size() >= 2);
  return {1, std::move(points)};
}

std::optional<Error> check(const DigitisedHead& head) {
  const std::size_t count = head.sections.size();
  if (count < kFewestSections || count > kMostSections) {
    return invalid_parameter("sections", "must be 3 to 100", static_cast<double>(count));
  }
  std::size_t controls = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::string where = indexed("sections", k);
    controls += head.sections[k].profile.controls.size();
    if (controls > kMostControls) {
      return Error{ErrorCode::kTooLarge, where + ".profile", "must not bring the control points above 10000"};
    }
    if (auto error = check_section(where, head.sections[k])) {
      return error;
    }
    if (k > 0 && head.sections[k].landmarks.size() < head.sections[k - 1].landmarks.size()) {
      return invalid_parameter(where + ".landmarks", "must be no fewer than the section before has",
                               static_cast<double>(head.sections[k].landmarks.size()));
    }
  }
  if (auto error = check_knots(head.knots, count)) {
    return error;
  }
  if (!(head.scale > 0.0 && head.scale <= 1e9)) {
    return invalid_parameter("scale", "must be > 0 and at most 1e9", head.scale);
  }
  return std::nullopt;
}

struct GrowingReceptacle::Tables {
  SectionLookup lookup = SectionLookup::kExact;
  SectionTable profile;
  std::size_t sections = 0;
  std::size_t landmarks = 0;
  std::vector<double> inner_knots;  ///< in time
  std::vector<double> ring;         ///< one for each section
  std::vector<double> places;       ///< [number][section]: s of landmark `number`; 0 the base, the last the apex

  /// Material coordinates 1, 0.999, ... as repeated subtraction leaves them; for the published inverse.
  std::vector<double> material_steps;

  BasisFunctions weights(double time) const { return clamped_basis(inner_knots, kDegree, std::clamp(time, 0.0, 1.0)); }
  double place(const BasisFunctions& weights, std::size_t number) const {
    const double* row = &places[number * sections + static_cast<std::size_t>(weights.first)];
    double sum = 0.0;
    for (int k = 0; k < weights.count; ++k) {
      sum += weights.weight[k] * row[k];
    }
    return sum;
  }
  /// Control j of the material line's s as a function of u: the landmarks from the apex outwards.
  double control(const BasisFunctions& weights, std::size_t j) const { return place(weights, landmarks + 1 - j); }

  double s_from_material(const BasisFunctions& weights, double u) const {
    const BasisFunctions q = clamped_basis(static_cast<int>(landmarks + 2), degree_in_material(), u);
    double sum = 0.0;
    for (int j = 0; j < q.count; ++j) {
      sum += q.weight[j] * control(weights, static_cast<std::size_t>(q.first + j));
    }
    return std::min(sum, 1.0);  // the weights may add up to a little more than 1
  }
  /// Without landmarks there are two controls only, and the tissue stretches evenly.
  int degree_in_material() const { return landmarks > 0 ? kDegree : 1; }

  double material_from_s(const BasisFunctions& weights, double s) const;
  double published_material_from_s(const BasisFunctions& weights, double s) const;
};

/// s(u) is piecewise quadratic and ascends with its controls: find the piece, solve it.
double GrowingReceptacle::Tables::material_from_s(const BasisFunctions& weights, double s) const {
  if (s >= 1.0) {
    return 1.0;
  }
  if (s <= 0.0) {
    return 0.0;
  }
  if (landmarks == 0) {
    return s;
  }
  // The pieces meet halfway between neighbouring controls, but for the first and the last.
  const std::size_t pieces = landmarks;
  const auto joint = [&](std::size_t i) {
    return i == 0 ? 0.0 : i == pieces ? 1.0 : 0.5 * (control(weights, i) + control(weights, i + 1));
  };
  std::size_t low = 0;
  std::size_t high = pieces;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (joint(middle) <= s ? low : high) = middle;
  }
  const double b0 = joint(low);
  const double b1 = control(weights, low + 1);
  const double b2 = joint(low + 1);
  // b0 (1 - x)^2 + 2 b1 x (1 - x) + b2 x^2 = s, in the form that does not cancel.
  const double a = (b2 - b1) - (b1 - b0);
  const double b = b1 - b0;
  const double c = s - b0;
  const double root = b + std::sqrt(std::max(b * b + a * c, 0.0));
  const double x = root > 0.0 ? std::clamp(c / root, 0.0, 1.0) : 1.0;
  return (static_cast<double>(low) + x) / static_cast<double>(pieces);
}

/// The first of 1, 0.999, 0.998 ... whose line is not outside s. The published search tries them all in turn and may
/// run past 0; here it stops there.
double GrowingReceptacle::Tables::published_material_from_s(const BasisFunctions& weights, double s) const {
  const double exact = material_from_s(weights, s);
  std::size_t step = static_cast<std::size_t>((1.0 - exact) * static_cast<double>(kMaterialSteps));
  step -= std::min<std::size_t>(step, 2);
  while (step < kMaterialSteps && s_from_material(weights, material_steps[step]) > s) {
    ++step;
  }
  return material_steps[step];
}

GrowingReceptacle::GrowingReceptacle(const DigitisedHead& head, SectionLookup lookup) {
  ANTHESIS_ASSERT(!check(head));
  auto tables = std::make_shared<Tables>();
  const std::size_t sections = head.sections.size();
  tables->lookup = lookup;
  tables->sections = sections;
  tables->profile = detail::make_section_table(head.sections, head.scale, lookup);
  for (std::size_t i = 1; i + kDegree < sections; ++i) {
    tables->inner_knots.push_back(head.knots.empty() ? static_cast<double>(i) / static_cast<double>(sections - kDegree)
                                                     : head.knots[i + kDegree]);
  }
  for (const DigitisedSection& section : head.sections) {
    tables->ring.push_back(section.ring);
  }
  tables->landmarks = head.sections.back().landmarks.size();
  tables->places.assign((tables->landmarks + 2) * sections, 0.0);
  std::fill_n(tables->places.begin(), sections, 1.0);
  for (std::size_t number = 1; number <= tables->landmarks; ++number) {
    double* row = &tables->places[number * sections];
    const double* outside = row - sections;
    std::size_t first = sections;  // the youngest section that has this landmark
    while (first > 0 && head.sections[first - 1].landmarks.size() >= number) {
      --first;
      row[first] = head.sections[first].landmarks[number - 1];
    }
    for (std::size_t k = 0; k < first; ++k) {
      row[k] = outside[k] * row[first] / outside[first];
    }
  }
  double u = 1.0;
  for (std::size_t i = 0; i < kMaterialSteps; ++i, u -= 1.0 / static_cast<double>(kMaterialSteps)) {
    tables->material_steps.push_back(u);
  }
  tables->material_steps.push_back(0.0);
  tables_ = std::move(tables);
}

Vec2 GrowingReceptacle::point(double time, double s) const {
  return right_of_axis(tables_->profile.blend(tables_->weights(time), s));
}

double GrowingReceptacle::length(double time) const {
  return tables_->profile.length(tables_->weights(time));
}

double GrowingReceptacle::ring(double time) const {
  const BasisFunctions weights = tables_->weights(time);
  double sum = 0.0;
  for (int k = 0; k < weights.count; ++k) {
    sum += weights.weight[k] * tables_->ring[static_cast<std::size_t>(weights.first + k)];
  }
  return sum;
}

std::size_t GrowingReceptacle::landmarks() const {
  return tables_->landmarks;
}

double GrowingReceptacle::landmark(double time, std::size_t number) const {
  return tables_->place(tables_->weights(time), std::min(number, tables_->landmarks + 1));
}

double GrowingReceptacle::s_from_material(double time, double u) const {
  return tables_->s_from_material(tables_->weights(time), std::clamp(u, 0.0, 1.0));
}

double GrowingReceptacle::material_from_s(double time, double s) const {
  const BasisFunctions weights = tables_->weights(time);
  return tables_->lookup == SectionLookup::kExact ? tables_->material_from_s(weights, s)
                                                  : tables_->published_material_from_s(weights, s);
}

SectionLookup GrowingReceptacle::lookup() const {
  return tables_->lookup;
}

GrownProfile GrowingReceptacle::at(double time) const {
  const SectionTable& table = tables_->profile;
  const GaussTable& gauss = gauss_table();
  const BasisFunctions weights = tables_->weights(time);
  const std::size_t intervals = table.intervals();
  const std::size_t size = intervals * table.terms;
  GrownProfile profile;
  profile.tables_ = tables_;
  profile.x_.assign(size, 0.0);
  profile.y_.assign(size, 0.0);
  for (int k = 0; k < weights.count; ++k) {
    const double share = weights.weight[k];
    const std::size_t from = static_cast<std::size_t>(weights.first + k) * size;
    for (std::size_t i = 0; i < size; ++i) {
      profile.x_[i] += share * table.x[from + i];
      profile.y_[i] += share * table.y[from + i];
    }
  }
  profile.before_.assign(intervals + 1, 0.0);
  if (table.terms == 2) {  // chords: their length is spread evenly
    for (std::size_t i = 0; i < intervals; ++i) {
      const double half = anthesis::length(Vec2{profile.x_[2 * i + 1], profile.y_[2 * i + 1]});
      profile.before_[i + 1] = profile.before_[i] + 2.0 * half;
    }
    return profile;
  }
  profile.density_.assign(intervals * GaussTable::kNodes, 0.0);
  for (std::size_t i = 0; i < intervals; ++i) {
    std::array<double, GaussTable::kNodes> speed;
    for (std::size_t j = 0; j < GaussTable::kNodes; ++j) {
      Vec2 slope;
      for (int k = 0; k < weights.count; ++k) {
        const std::size_t at = static_cast<std::size_t>(weights.first + k) * table.pieces + i * GaussTable::kNodes + j;
        slope += weights.weight[k] * Vec2{table.dx[at], table.dy[at]};
      }
      speed[j] = anthesis::length(slope) / gauss.weight[j];
    }
    double* density = &profile.density_[i * GaussTable::kNodes];
    for (std::size_t m = 0; m < GaussTable::kNodes; ++m) {
      for (std::size_t j = 0; j < GaussTable::kNodes; ++j) {
        density[m] += gauss.legendre[m][j] * speed[j];
      }
    }
    profile.before_[i + 1] = profile.before_[i] + 2.0 * density[0];
  }
  return profile;
}

namespace {

/// A density and its integral from -1, out of Legendre coefficients.
struct DensityAt {
  double density = 0.0;
  double integral = 0.0;
};
DensityAt density_at(const double* c, double x) {
  constexpr std::size_t n = GaussTable::kNodes;
  std::array<double, n + 1> p;
  p[0] = 1.0;
  p[1] = x;
  for (std::size_t m = 2; m <= n; ++m) {
    const double degree = static_cast<double>(m);
    p[m] = ((2.0 * degree - 1.0) * x * p[m - 1] - (degree - 1.0) * p[m - 2]) / degree;
  }
  DensityAt result{c[0], c[0] * (x + 1.0)};
  for (std::size_t m = 1; m < n; ++m) {
    result.density += c[m] * p[m];
    result.integral += c[m] * (p[m + 1] - p[m - 1]) / (2.0 * static_cast<double>(m) + 1.0);
  }
  return result;
}

}  // namespace

Vec2 GrownProfile::point(double s) const {
  const SectionTable& table = tables_->profile;
  s = std::clamp(s, 0.0, 1.0);
  const std::size_t interval = table.interval_of(s);
  const double x = table.local(interval, s);
  const double* cx = &x_[interval * table.terms];
  const double* cy = &y_[interval * table.terms];
  double before = 1.0;
  double here = x;
  Vec2 sum{cx[0] + cx[1] * x, cy[0] + cy[1] * x};
  for (std::size_t m = 2; m < table.terms; ++m) {
    const double next = 2.0 * x * here - before;
    before = here;
    here = next;
    sum += Vec2{here * cx[m], here * cy[m]};
  }
  return right_of_axis(sum);
}

double GrownProfile::length_to(double s) const {
  const SectionTable& table = tables_->profile;
  s = std::clamp(s, 0.0, 1.0);
  const std::size_t i = table.interval_of(s);
  const double x = table.local(i, s);
  if (density_.empty()) {
    return before_[i] + 0.5 * (x + 1.0) * (before_[i + 1] - before_[i]);
  }
  return before_[i] + density_at(&density_[i * GaussTable::kNodes], x).integral;
}

double GrownProfile::s_at_length(double length) const {
  const SectionTable& table = tables_->profile;
  if (!(length > 0.0)) {
    return 0.0;
  }
  if (length >= before_.back()) {
    return 1.0;
  }
  const std::size_t i =
      static_cast<std::size_t>(std::upper_bound(before_.begin(), before_.end(), length) - before_.begin()) - 1;
  const double amount = before_[i + 1] - before_[i];
  const double wanted = length - before_[i];
  double x = 2.0 * wanted / amount - 1.0;
  if (!density_.empty()) {
    constexpr int kRounds = 8;  // Newton from a good guess: three or four do
    for (int round = 0; round < kRounds; ++round) {
      const DensityAt here = density_at(&density_[i * GaussTable::kNodes], x);
      const double change = here.density > 0.0 ? (wanted - here.integral) / here.density : 0.0;
      x = std::clamp(x + change, -1.0, 1.0);
      if (std::abs(change) < 1e-14) {
        break;
      }
    }
  }
  return table.breaks[i] + 0.5 * (x + 1.0) * (table.breaks[i + 1] - table.breaks[i]);
}

}  // namespace anthesis
