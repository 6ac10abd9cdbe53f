#include "anthesis/geometry/function_graph.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/check.h"

namespace anthesis {

FunctionGraph::FunctionGraph(std::vector<Vec2> points) {
  curve_.degree = std::min(3, static_cast<int>(points.size()) - 1);
  curve_.controls = std::move(points);
  for (const double u : curve_.knots()) {
    const double x = curve_.at(u).x;
    if (breaks_.empty() || x > breaks_.back()) {
      breaks_.push_back(x);
    }
  }
}

double FunctionGraph::operator()(double x) const {
  if (!(x > first())) {
    return curve_.controls.front().y;
  }
  if (!(x < last())) {
    return curve_.controls.back().y;
  }
  double low = 0.0;
  double high = 1.0;
  double u = (x - first()) / (last() - first());
  for (int step = 0; step < 100; ++step) {  // x(u) ascends: Newton inside a bracket
    const double excess = curve_.at(u).x - x;
    (excess < 0.0 ? low : high) = u;
    const double slope = curve_.derivative(u).x;
    double next = slope > 0.0 ? u - excess / slope : low;
    if (!(next > low && next < high)) {
      next = 0.5 * (low + high);
    }
    const double moved = std::abs(next - u);
    u = next;
    if (moved <= 1e-15) {
      break;
    }
  }
  return curve_.at(u).y;
}

std::optional<Error> check_function(std::string_view where, std::span<const Vec2> points) {
  if (points.size() < 2) {
    return invalid_parameter(where, "must have at least 2 points", static_cast<double>(points.size()));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y)) {
      return invalid_parameter(where, "must have finite points",
                               std::isfinite(points[i].x) ? points[i].y : points[i].x);
    }
    if (i > 0 && points[i].x < points[i - 1].x) {
      return invalid_parameter(where, "must have points with ascending x", points[i].x);
    }
  }
  if (!(points.back().x > points.front().x)) {
    return invalid_parameter(where, "must span more than one x", points.back().x);
  }
  return std::nullopt;
}

std::optional<Error> check_function_values(std::string_view where, std::span<const Vec2> points, double low,
                                           double high) {
  if (auto error = check_function(where, points)) {
    return error;
  }
  for (const Vec2 point : points) {
    if (auto error = check_number(where, point.y, low, high)) {
      return error;
    }
  }
  return std::nullopt;
}

}  // namespace anthesis
