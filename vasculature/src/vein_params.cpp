#include "anthesis/vasculature/vein_params.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "anthesis/base/check.h"
#include "anthesis/base/math.h"

namespace anthesis {
namespace {

constexpr double kMost = 1e6;  // any length or resistivity
constexpr int kMostFrames = 1'000'000;

/// Reports the first rule that is broken.
class Checker {
 public:
  void number(const std::string& where, double value, double low, double high) {
    if (!error) {
      error = check_number(where, value, low, high);
    }
  }
  void whole(const std::string& where, int value, int low, int high) {
    if (!error) {
      error = check_whole(where, value, low, high);
    }
  }
  void range(const std::string& where, const std::array<double, 2>& value, double low, double high) {
    if (!error) {
      error = check_range(where, value, low, high);
    }
  }
  void course(const std::string& where, const TimeCourse& course, double low, double high) {
    if (!error && course.points.empty()) {
      error = invalid_parameter(where, "must have at least 1 point", "none");
    }
    for (std::size_t i = 0; i < course.points.size() && !error; ++i) {
      const std::string point = where + "[" + std::to_string(i) + "]";
      number(point, course.points[i].y, low, high);
      const double before = i == 0 ? 0.0 : course.points[i - 1].x;
      if (!error && !(course.points[i].x >= before && course.points[i].x <= 1.0)) {
        error = invalid_parameter(point, "must have a time in [0, 1] that is not before the last one's",
                                  course.points[i].x);
      }
    }
  }
  /// A length that depends on the step.
  void at_least(const std::string& where, double value, double least, const char* least_name) {
    number(where, value, 0.0, kMost);
    if (!error && value < least) {
      error = invalid_parameter(where, std::string("must be at least ") + least_name + ", " + to_text(least), value);
    }
  }
  void jitter(const std::string& where, const VeinJitter& jitter) {
    number(where + ".probability", jitter.probability, 0.0, 1.0);
    number(where + ".strength", jitter.strength, 0.0, 100.0);
  }

  std::optional<Error> error;
};

}  // namespace

VeinParams::VeinParams() = default;

std::optional<Error> check(const VeinParams& params) {
  constexpr double kSmall = 1e-9;
  Checker checker;
  checker.whole("ring_vertices", params.ring_vertices, 1, 100'000);
  checker.number("ring_radius", params.ring_radius, kSmall, 1.0);
  checker.number("ring_inset_mm", params.ring_inset_mm, 0.0, kMost);
  checker.number("first_start", params.first_start, 0.0, 1.0);
  for (std::size_t i = 0; i < params.initials.size(); ++i) {
    const VeinInitial& initial = params.initials[i];
    const std::string where = "initials[" + std::to_string(i) + "].";
    checker.number(where + "depth_mm", initial.depth_mm, kSmall, 1e4 * params.step_mm);
    checker.range(where + "depth_range", initial.depth_range, kSmall, 100.0);
    double longest = 0.0;
    for (const Vec2 factor : params.depth_course.points) {
      longest = std::max(longest, factor.y * initial.depth_range[1] * initial.depth_mm);
    }
    if (!checker.error && longest > 1e4 * params.step_mm) {
      checker.error =
          invalid_parameter(where + "depth_mm", "must be at most 10000 steps with depth_range and depth_course",
                            longest / params.step_mm);
    }
    checker.number(where + "sinking_mm", initial.sinking_mm, 0.0, 1e4 * params.step_mm);
    checker.whole(where + "delay_frames", initial.delay_frames[0], 0, kMostFrames);
    checker.whole(where + "delay_frames", initial.delay_frames[1], initial.delay_frames[0], kMostFrames);
    checker.jitter(where + "jitter", initial.jitter);
    checker.jitter(where + "strand_jitter", initial.strand_jitter);
    checker.number(where + "resistivity_factor", initial.resistivity_factor, 0.0, kMost);
    checker.number(where + "initial_resistivity_factor", initial.initial_resistivity_factor, 0.0, kMost);
  }
  checker.course("depth_course", params.depth_course, 0.0, 100.0);
  checker.course("ground_resistivity", params.ground_resistivity, 0.0, kMost);
  checker.course("maturation_frames", params.maturation_frames, 0.0, kMostFrames);
  checker.number("mature_resistivity", params.mature_resistivity, 0.0, kMost);
  checker.number("vein_weight", params.vein_weight, 0.0, kMost);
  checker.number("age_weight", params.age_weight, 0.0, kMost);
  checker.number("age_offset", params.age_offset, 0.0, 1.0);
  checker.number("shielding_angle_deg", params.shielding_angle_deg, kSmall, 180.0);
  checker.number("sector_weight", params.sector_weight, 0.0, kMost);
  checker.number("inward_limit", params.inward_limit, -1.0, 1.0);
  checker.number("step_mm", params.step_mm, kSmall, kMost);
  checker.at_least("merge_distance_mm", params.merge_distance_mm, 0.5 * params.step_mm, "half of step_mm");
  checker.number("momentum", params.momentum, 0.0, kMost);
  checker.number("drift", params.drift, 0.0, 1.0);
  checker.at_least("split_length_mm", params.split_length_mm, params.step_mm, "step_mm");
  const VeinReticulation& reticulation = params.reticulation;
  checker.whole("reticulation.delay_frames", reticulation.delay_frames, 0, kMostFrames);
  checker.number("reticulation.ratio_limit", reticulation.ratio_limit, 0.0, kMost);
  checker.number("reticulation.difference_limit", reticulation.difference_limit, -kMost, kMost);
  checker.number("reticulation.reach_mm", reticulation.reach_mm, 0.0, kMost);
  checker.number("reticulation.neighbourhood_mm", reticulation.neighbourhood_mm, 0.0, kMost);
  const VeinColonisation& colonisation = params.colonisation;
  checker.range("colonisation.window", colonisation.window, 0.0, 1.0);
  checker.course("colonisation.s", colonisation.s, 0.0, 1.0);
  checker.range("colonisation.depth_mm", colonisation.depth_mm, 0.0, kMost);
  checker.whole("colonisation.points_per_frame", colonisation.points_per_frame, 0, 10'000);
  checker.number("colonisation.spacing_mm", colonisation.spacing_mm, kSmall, kMost);
  checker.number("colonisation.kill_distance_mm", colonisation.kill_distance_mm, kSmall, kMost);
  checker.number("colonisation.step_mm", colonisation.step_mm, kSmall, kMost);
  checker.number("colonisation.resistivity_factor", colonisation.resistivity_factor, 0.0, kMost);
  checker.jitter("colonisation.jitter", colonisation.jitter);
  checker.number("murray_exponent", params.murray_exponent, 1.0, 100.0);
  for (std::size_t i = 0; i < params.tip_diameter_mm.size(); ++i) {
    checker.number("tip_diameter_mm[" + std::to_string(i) + "]", params.tip_diameter_mm[i], kSmall, kMost);
  }
  checker.course("diameter_course", params.diameter_course, 1e-6, 1e6);
  checker.whole("fade_in_frames", params.fade_in_frames, 0, kMostFrames);
  checker.number("second_share", params.second_share, 0.0, 0.5);
  return checker.error;
}

}  // namespace anthesis
