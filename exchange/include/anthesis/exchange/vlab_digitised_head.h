#pragma once
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/exchange/vlab_contour.h"
#include "anthesis/receptacle/growing_receptacle.h"

namespace anthesis {

/// The head whose stages are the contours with markers of a VLab object (vlab_stages), in the files' unit times
/// `scale`. Without knots (empty) the stages lie equally in time. Contours are taken as drawn, apex first; drawings
/// overshoot the axis: radii down to -1 % of the widest are put on it.
///
/// Errors: those of vlab_stages; what check(DigitisedHead) finds, where `where` is like "contours.sections[2].ring".
Expected<DigitisedHead> vlab_digitised_head(std::vector<VlabContour> contours, std::vector<double> knots,
                                            double scale = 1.0);

}  // namespace anthesis
