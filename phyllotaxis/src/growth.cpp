#include "anthesis/phyllotaxis/growth.h"

#include <algorithm>
#include <limits>

#include "anthesis/base/math.h"

namespace anthesis {

GrowthFunction GrowthFunction::from_rate(FunctionGraph rate) {
  GrowthFunction growth(std::move(rate));
  growth.is_rate_ = true;
  growth.integral_ = CumulativeIntegral([&](double x) { return growth.graph_(x); }, growth.graph_.breaks());
  growth.exponent_at_0_ = growth.exponent(0.0);
  return growth;
}

double GrowthFunction::exponent(double x) const {
  const double beyond = x < graph_.first()  ? (x - graph_.first()) * graph_(graph_.first())
                        : x > graph_.last() ? (x - graph_.last()) * graph_(graph_.last())
                                            : 0.0;
  return integral_.at(x) + beyond;
}

double GrowthFunction::operator()(double x) const {
  return is_rate_ ? math::exp(exponent(x) - exponent_at_0_) : graph_(x);
}

double GrowthFunction::ratio(double from, double to) const {
  return is_rate_ ? math::exp(exponent(to) - exponent(from)) : graph_(to) / graph_(from);
}

double GrowthFunction::when(double from, double factor) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (!(factor > 1.0)) {
    return from;
  }
  if (is_rate_) {
    const double target = exponent(from) + math::log(factor);
    const double rate_before = graph_(graph_.first());
    const double rate_after = graph_(graph_.last());
    if (target > integral_.total()) {
      return rate_after > 0.0 ? std::max(from, graph_.last() + (target - integral_.total()) / rate_after) : kNever;
    }
    if (target < 0.0) {  // only where the search began before the graph's first x, with a rate > 0
      return std::max(from, graph_.first() + target / rate_before);
    }
    return std::max(from, integral_.inverse(target));
  }
  const double target = factor * graph_(from);
  if (graph_(graph_.last()) < target) {
    return kNever;
  }
  double low = std::max(from, graph_.first());
  double high = graph_.last();
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) {
      return high;
    }
    (graph_(middle) < target ? low : high) = middle;
  }
}

}  // namespace anthesis
