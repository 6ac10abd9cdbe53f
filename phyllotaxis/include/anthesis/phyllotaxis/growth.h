#pragma once
#include "anthesis/geometry/cumulative_integral.h"
#include "anthesis/geometry/function_graph.h"

namespace anthesis {

/// How an area grows with time or age: a positive factor G(x), given by its graph or by its relative rate G'/G. A rate
/// suits growth that goes on for many doublings: a constant rate is exponential growth, exactly.
class GrowthFunction {
 public:
  /// The factor itself. Precondition: the function is > 0.
  GrowthFunction(FunctionGraph factor) : graph_(std::move(factor)) {}  // NOLINT: a graph is a growth function

  /// The factor exp(integral of the rate from 0 to x), 1 at x = 0. Beyond the graph's ends the rate stays what it is
  /// there, so growth goes on.
  static GrowthFunction from_rate(FunctionGraph rate);

  /// G(x). Infinite where a rate has been at work for more than 709 e-foldings; `ratio` does not overflow there.
  double operator()(double x) const;

  /// G(to) / G(from), relative error below 1e-12 while it is below 1e100.
  double ratio(double from, double to) const;

  /// The first x >= from where G(x) = factor * G(from): `from` itself for factors up to 1, infinity where it is never
  /// reached. As exact as doubles are: one step earlier, G is short of it but for rounding. About 0.2 microseconds for
  /// a rate; a factor is halved down to, some 50 evaluations. Precondition: G never falls.
  double when(double from, double factor) const;

  /// Where the graph's smooth pieces meet, ascending; before the first the factor or rate is constant, and behind the
  /// last.
  const std::vector<double>& breaks() const { return graph_.breaks(); }
  bool given_by_rate() const { return is_rate_; }

 private:
  double exponent(double x) const;  ///< integral of the rate from the graph's first x

  FunctionGraph graph_;
  bool is_rate_ = false;
  CumulativeIntegral integral_;  ///< of the rate, over the graph's interval
  double exponent_at_0_ = 0.0;
};

}  // namespace anthesis
