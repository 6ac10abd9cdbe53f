#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/receptacle/growing_receptacle.h"

namespace anthesis {

struct ContourPoint {
  Vec2 position;   ///< (radius, height), radius >= 0
  double s = 0.0;  ///< 0 apex, 1 base
};

/// A growing half section, sampled frame by frame at the same material points as far as the model knows them: all
/// landmarks, and fillers equally far apart between two landmarks.
struct ContourSequence {
  std::vector<double> times;         ///< one for each frame
  std::vector<bool> landmarks;       ///< one for each point of a frame: landmark (apex and base too) or filler
  std::vector<ContourPoint> points;  ///< frame after frame, apex to base; young frames may repeat points at the base
  std::vector<Vec2> ring;            ///< (radius, height) of the active ring, one for each frame

  std::size_t frames() const { return times.size(); }
  std::size_t points_per_frame() const { return landmarks.size(); }
  std::span<const ContourPoint> frame(std::size_t i) const {
    return std::span(points).subspan(i * points_per_frame(), points_per_frame());
  }
};

/// The times of the frames of O24: 0, then each later by `step` times `pace` at the one before, and at last 1.
/// 2,214 frames with the paces published for Bellis, sunflower and gerbera.
/// Errors: a step or a pace that is not > 0; more than 1,000,000 frames (kTooLarge).
Expected<std::vector<double>> contour_times(const std::function<double(double)>& pace, double step = 0.0032);

/// Samples a head at the given times. Between two landmarks there are as many parts as
/// floor(2 + 4 (A - A_min) / (A_max - A_min)) says, A their distance at time 1.
///
/// A head with published lookup is sampled like the published program does: fillers are found by steps of 0.0001 in s,
/// so that they stand up to that much too far out. 2,214 frames take less than 0.1 s. Same bits for any number of
/// threads. Precondition: times in [0, 1].
ContourSequence sample_contours(const GrowingReceptacle& head, std::span<const double> times);

}  // namespace anthesis
