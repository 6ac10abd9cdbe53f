#include "anthesis/exchange/vlab_digitised_head.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "anthesis/exchange/vlab_head.h"

namespace anthesis {
namespace {

constexpr double kOvershoot = 0.01;  // of the widest

std::vector<Vec2> half_section(const VlabContour& contour) {
  std::vector<Vec2> controls;
  double widest = 0.0;
  for (const Vec3 control : vlab_spline(contour).controls) {
    controls.push_back({control.x, control.y});
    widest = std::max(widest, control.x);
  }
  if (std::abs(controls.front().x) <= kOvershoot * widest) {
    controls.front().x = 0.0;  // the apex
  }
  for (Vec2& control : controls) {
    if (control.x < 0.0 && control.x >= -kOvershoot * widest) {
      control.x = 0.0;
    }
  }
  return controls;
}

}  // namespace

Expected<DigitisedHead> vlab_digitised_head(std::vector<VlabContour> contours, std::vector<double> knots,
                                            double scale) {
  Expected<VlabStages> stages = vlab_stages(std::move(contours), std::move(knots));
  if (!stages) {
    return unexpected(stages.error());
  }
  DigitisedHead head;
  for (std::size_t k = 0; k < stages->contours.size(); ++k) {
    DigitisedSection section;
    section.profile.degree = 3;
    section.profile.controls = half_section(stages->contours[k]);
    section.landmarks = std::move(stages->landmarks[k]);
    section.ring = stages->ring[k];
    head.sections.push_back(std::move(section));
  }
  head.knots = std::move(stages->knots);
  head.scale = scale;
  if (std::optional<Error> error = check(head)) {
    error->where = "contours." + error->where;
    return unexpected(std::move(*error));
  }
  return head;
}

}  // namespace anthesis
