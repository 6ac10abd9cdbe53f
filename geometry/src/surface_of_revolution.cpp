#include "anthesis/geometry/surface_of_revolution.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "anthesis/base/math.h"

namespace anthesis {

SurfaceOfRevolution::SurfaceOfRevolution(std::vector<Vec2> controls_mm, int degree)
    : SurfaceOfRevolution(BSplineCurve<Vec2>{degree, std::move(controls_mm)}) {}

SurfaceOfRevolution::SurfaceOfRevolution(BSplineCurve<Vec2> profile_mm) : profile_(std::move(profile_mm)) {
  length_ = ArcLength(profile_);
  area_ =
      CumulativeIntegral([this](double t) { return math::kTurnRad * radius_mm(t) * speed_mm(t); }, profile_.knots());
}

double SurfaceOfRevolution::speed_mm(double t) const {
  return length(profile_.derivative(t));
}

SurfaceFrame SurfaceOfRevolution::frame(double t, double azimuth_rad) const {
  const Vec2 point = profile_.at(t);
  Vec2 along = profile_.derivative(t);
  // Where control points coincide the derivative vanishes: the shortest chord about t tells the direction.
  for (double reach = 1e-6; !(length(along) > 0.0) && reach < 4.0; reach *= 4.0) {
    along = profile_.at(std::min(t + reach, 1.0)) - profile_.at(std::max(t - reach, 0.0));
  }
  along = normalized(along);
  const auto [sine, cosine] = math::sin_cos(azimuth_rad);
  const Vec3 outward{cosine, sine, 0.0};
  SurfaceFrame frame;
  frame.position_mm = {point.x * cosine, point.x * sine, point.y};
  frame.meridian = along.x * outward + Vec3{0.0, 0.0, along.y};
  frame.parallel = {-sine, cosine, 0.0};
  frame.normal = -along.y * outward + Vec3{0.0, 0.0, along.x};
  return frame;
}

std::optional<Error> check_profile(std::string_view where, std::span<const Vec2> controls_mm) {
  if (controls_mm.size() < 2) {
    return invalid_parameter(where, "must have at least 2 points", static_cast<double>(controls_mm.size()));
  }
  double widest = 0.0;
  for (const Vec2 point : controls_mm) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
      return invalid_parameter(where, "must have finite points", std::isfinite(point.x) ? point.y : point.x);
    }
    if (point.x < 0.0) {
      return invalid_parameter(where, "must have radii >= 0", point.x);
    }
    widest = std::max(widest, point.x);
  }
  if (!(widest > 0.0)) {
    return invalid_parameter(where, "must leave the axis: one radius must be > 0", widest);
  }
  const auto same = [&](Vec2 point) { return point == controls_mm.front(); };
  if (std::all_of(controls_mm.begin(), controls_mm.end(), same)) {
    return invalid_parameter(where, "must have two different points", controls_mm.front().x);
  }
  return std::nullopt;
}

std::optional<Error> check_profile(std::string_view where, const BSplineCurve<Vec2>& profile_mm) {
  if (auto error = check_profile(where, std::span<const Vec2>(profile_mm.controls))) {
    return error;
  }
  const int degree = profile_mm.degree;
  if (degree < 1 || degree > kMaxDegree) {
    return invalid_parameter(where, "must have a degree from 1 to " + std::to_string(kMaxDegree), degree);
  }
  const auto points = static_cast<double>(profile_mm.controls.size());
  if (points < degree + 1) {
    return invalid_parameter(where, "must have more points than its degree", points);
  }
  const std::vector<double>& knots = profile_mm.inner_knots;
  if (knots.empty()) {
    return std::nullopt;
  }
  if (knots.size() + degree + 1 != profile_mm.controls.size()) {
    return invalid_parameter(where, "must have as many interior knots as points less its degree less 1",
                             static_cast<double>(knots.size()));
  }
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!(knots[i] > 0.0 && knots[i] < 1.0)) {
      return invalid_parameter(where, "must have interior knots between 0 and 1", knots[i]);
    }
    if (i > 0 && knots[i] < knots[i - 1]) {
      return invalid_parameter(where, "must have ascending knots", knots[i]);
    }
    if (i >= static_cast<std::size_t>(degree) && knots[i] == knots[i - degree]) {
      return invalid_parameter(where, "must repeat no interior knot more often than its degree", knots[i]);
    }
  }
  return std::nullopt;
}

}  // namespace anthesis
