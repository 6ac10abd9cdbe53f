#pragma once
#include <string>

#include "anthesis/phyllotaxis/divergence_study.h"

namespace anthesis {

/// A tidy table of a study, one row for each model and size that could be measured: lines that begin with `#` say what
/// made it, then column names: model, size, distance, rise, divergence_deg, deviation_deg, m, n, agreement. Sizes,
/// distances and rises are shares of the circumference; angles above 180 degrees are given as their mirror images.
std::string divergence_study_csv(const DivergenceStudy& study);

/// Two panels over one axis of organ size, on a logarithmic scale: divergence, with the arcs of van Iterson's diagram
/// as thin lines and what the models do as dots, and the parastichy pair, with Fibonacci numbers as guides. Dots sit at
/// the size that was measured, the distance between neighbours.
std::string divergence_study_svg(const DivergenceStudy& study, const std::string& title, const std::string& caption);

}  // namespace anthesis
