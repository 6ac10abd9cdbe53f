#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/inflorescence/development.h"

namespace anthesis {

/// An organ in a plan: a disc as large as the organ's share of the receptacle.
struct PlanDisc {
  Vec2 centre_mm;          ///< seen from above, +y away from the reader
  double radius_mm = 1.0;  ///< > 0
  std::uint32_t id = 0;    ///< what numbers show
  std::uint32_t kind = 0;  ///< index into Plan::kinds
  double age = 0.0;        ///< 0 young to 1 old
};

/// What the colour of a disc says.
enum class PlanColour {
  kKind,  ///< one colour for each kind, with a legend
  kAge,   ///< green young, yellow, red old, with a scale
};

/// A pattern seen from above.
struct Plan {
  std::string title;
  std::string caption;  ///< small print under the drawing: how it was made
  std::vector<PlanDisc> discs;
  std::vector<std::string> kinds;                   ///< names for the legend
  std::vector<std::array<std::uint32_t, 2>> links;  ///< indices into `discs` to join by a line: parastichies
  PlanColour colour = PlanColour::kKind;
  bool numbers = false;  ///< writes each organ's id into its disc
};

/// The organs born by `time`. Errors: kInvalidParameter for a time outside [0, 1].
Expected<Plan> plan_of(const Development& development, double time);

/// An SVG drawing with a bar for scale. Discs are drawn in the given order. Values that are not finite are left out.
std::string plan_svg(const Plan& plan);

/// Counts against a swept parameter.
struct StepPlot {
  std::string title;
  std::string caption;  ///< small print under the drawing
  std::string x_label;
  std::string y_label;
  std::vector<Vec2> points;    ///< x ascending; y holds half-way to the neighbours
  std::vector<double> guides;  ///< horizontal dashed lines, each labelled with its value at the right
};

/// Fibonacci numbers 1, 2, 3, 5 ... not above `highest`: the guides of a plot of organ counts.
std::vector<double> fibonacci_guides(double highest);

/// An SVG plot with labelled axes. Values that are not finite are left out.
std::string step_plot_svg(const StepPlot& plot);

}  // namespace anthesis
