#include "anthesis/exchange/svg.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"
#include "check_time.h"
#include "drawing.h"
#include "provenance.h"
#include "text.h"

namespace anthesis {
namespace {

using detail::age_colour;
using detail::attribute;
using detail::escaped;
using detail::kFaint;
using detail::kInk;
using detail::line;
using detail::open_svg;
using detail::px;
using detail::short_text;
using detail::text_at;

// Okabe and Ito's palette: told apart by the colour-blind, and in print.
constexpr std::array<const char*, 8> kKindColours = {"#E69F00", "#009E73", "#56B4E9", "#CC79A7",
                                                     "#F0E442", "#0072B2", "#D55E00", "#999999"};

bool finite(const PlanDisc& disc) {
  return std::isfinite(disc.centre_mm.x) && std::isfinite(disc.centre_mm.y) && std::isfinite(disc.radius_mm) &&
         disc.radius_mm > 0.0 && std::isfinite(disc.age);
}

const char* kind_colour(std::size_t kind) {
  return kKindColours[kind % kKindColours.size()];
}

}  // namespace

Expected<Plan> plan_of(const Development& development, double time) {
  if (std::optional<Error> error = detail::check_time(time)) {
    return unexpected(*error);
  }
  Plan plan;
  const Species& species = development.species();
  plan.title = species.latin.empty() ? species.name : species.name + " (" + species.latin + ")";
  plan.caption =
      detail::generator() + ", seed " + std::to_string(development.options().seed) + ", time " + to_text(time);
  for (const OrganKind& kind : species.organs) {
    plan.kinds.push_back(kind.name);
  }
  const Canopy canopy = development.at(time);
  double oldest = 0.0;
  for (const OrganState& state : canopy.organs) {
    oldest = std::max(oldest, time - development.organs()[state.id.value - 1].birth);
  }
  for (const OrganState& state : canopy.organs) {
    const Organ& organ = development.organs()[state.id.value - 1];
    const Vec3 p = state.world_from_organ.position_mm;
    plan.discs.push_back({.centre_mm = {p.x, p.y},
                          .radius_mm = std::sqrt(std::max(0.0, state.area_mm2) / math::kPi),
                          .id = organ.id.value,
                          .kind = organ.kind,
                          .age = oldest > 0.0 ? (time - organ.birth) / oldest : 0.0});
  }
  return plan;
}

std::string plan_svg(const Plan& plan) {
  constexpr double kSide = 720.0;
  constexpr double kMargin = 40.0;
  constexpr double kLegendWidth = 190.0;
  constexpr double kTop = 56.0;
  constexpr double kFoot = 64.0;
  constexpr double kWidth = kSide + 2.0 * kMargin + kLegendWidth;
  constexpr double kHeight = kSide + kTop + kFoot;

  double reach_mm = 0.0;
  for (const PlanDisc& disc : plan.discs) {
    if (finite(disc)) {
      reach_mm = std::max(
          {reach_mm, std::abs(disc.centre_mm.x) + disc.radius_mm, std::abs(disc.centre_mm.y) + disc.radius_mm});
    }
  }
  const double scale = reach_mm > 0.0 ? 0.5 * kSide / reach_mm : 1.0;
  const auto x_of = [&](double x_mm) { return kMargin + 0.5 * kSide + scale * x_mm; };
  const auto y_of = [&](double y_mm) { return kTop + 0.5 * kSide - scale * y_mm; };  // SVG's y points down

  std::string svg;
  open_svg(svg, kWidth, kHeight, plan.title);
  text_at(svg, kMargin, 32.0, 18.0, "start", kInk, plan.title);

  svg += "<g stroke=\"#ffffff\" stroke-width=\"0.6\">\n";
  for (const PlanDisc& disc : plan.discs) {
    if (finite(disc)) {
      detail::append(svg, "<circle", attribute("cx", px(x_of(disc.centre_mm.x))),
                     attribute("cy", px(y_of(disc.centre_mm.y))), attribute("r", px(scale * disc.radius_mm)),
                     attribute("fill", plan.colour == PlanColour::kAge ? age_colour(disc.age) : kind_colour(disc.kind)),
                     "/>\n");
    }
  }
  svg += "</g>\n";
  if (!plan.links.empty()) {
    svg += "<g fill=\"none\" stroke=\"#222222\" stroke-opacity=\"0.55\" stroke-width=\"1\" stroke-linecap=\"round\">\n";
    for (const std::array<std::uint32_t, 2>& link : plan.links) {
      if (link[0] < plan.discs.size() && link[1] < plan.discs.size() && finite(plan.discs[link[0]]) &&
          finite(plan.discs[link[1]])) {
        const Vec2 a = plan.discs[link[0]].centre_mm;
        const Vec2 b = plan.discs[link[1]].centre_mm;
        std::string path;
        detail::append(path, "M", px(x_of(a.x)), " ", px(y_of(a.y)), "L", px(x_of(b.x)), " ", px(y_of(b.y)));
        detail::append(svg, "<path", attribute("d", path), "/>\n");
      }
    }
    svg += "</g>\n";
  }
  if (plan.numbers) {
    svg += "<g text-anchor=\"middle\" fill=\"#111111\">\n";
    for (const PlanDisc& disc : plan.discs) {
      if (finite(disc)) {
        const std::string digits = std::to_string(disc.id);
        // As large as the disc lets it be, and no larger than is read with ease.
        const double width = std::max(1.6, 0.58 * static_cast<double>(digits.size()));
        const double size = std::min(14.0, 1.6 * scale * disc.radius_mm / width);
        detail::append(svg, "<text", attribute("x", px(x_of(disc.centre_mm.x))),
                       attribute("y", px(y_of(disc.centre_mm.y) + 0.36 * size)), attribute("font-size", px(size)), ">",
                       digits, "</text>\n");
      }
    }
    svg += "</g>\n";
  }

  const double legend_x = kMargin + kSide + 30.0;
  if (plan.colour == PlanColour::kAge) {
    constexpr int kSteps = 24;
    constexpr double kScaleHeight = 160.0;
    text_at(svg, legend_x, kTop + 12.0, 13.0, "start", kInk, "age");
    for (int i = 0; i < kSteps; ++i) {
      const double height = kScaleHeight / kSteps;
      detail::append(svg, "<rect", attribute("x", px(legend_x)), attribute("y", px(kTop + 24.0 + i * height)),
                     attribute("width", "14"), attribute("height", px(height + 0.3)),
                     attribute("fill", age_colour((i + 0.5) / kSteps)), "/>\n");
    }
    text_at(svg, legend_x + 22.0, kTop + 34.0, 12.0, "start", kInk, "young");
    text_at(svg, legend_x + 22.0, kTop + 24.0 + kScaleHeight, 12.0, "start", kInk, "old");
  } else {
    double y = kTop + 12.0;
    for (std::size_t kind = 0; kind < plan.kinds.size(); ++kind) {
      const auto count = std::count_if(plan.discs.begin(), plan.discs.end(),
                                       [&](const PlanDisc& disc) { return disc.kind == kind && finite(disc); });
      if (count == 0) {
        continue;
      }
      detail::append(svg, "<circle", attribute("cx", px(legend_x + 6.0)), attribute("cy", px(y - 4.5)),
                     attribute("r", "6"), attribute("fill", kind_colour(kind)), "/>\n");
      text_at(svg, legend_x + 20.0, y, 13.0, "start", kInk, plan.kinds[kind] + ": " + std::to_string(count));
      y += 22.0;
    }
  }

  if (reach_mm > 0.0) {
    const double bar_mm = math::round_up_to_125(reach_mm / 6.0);
    const double bar_y = kTop + kSide + 22.0;
    line(svg, kMargin, bar_y, kMargin + scale * bar_mm, bar_y, kInk, 2.0);
    text_at(svg, kMargin + scale * bar_mm + 8.0, bar_y + 4.0, 12.0, "start", kInk, short_text(bar_mm) + " mm");
  }
  text_at(svg, kMargin, kHeight - 14.0, 11.0, "start", kFaint, plan.caption);
  svg += "</svg>\n";
  return svg;
}

std::vector<double> fibonacci_guides(double highest) {
  std::vector<double> numbers;
  double next = 1.0;
  double following = 2.0;
  while (next <= highest && numbers.size() < 60) {
    numbers.push_back(next);
    const double sum = next + following;
    next = following;
    following = sum;
  }
  return numbers;
}

std::string step_plot_svg(const StepPlot& plot) {
  constexpr double kWidth = 760.0;
  constexpr double kHeight = 480.0;
  constexpr double kLeft = 76.0;
  constexpr double kRight = 700.0;
  constexpr double kTop = 52.0;
  constexpr double kBottom = 392.0;

  std::vector<Vec2> points;
  std::copy_if(plot.points.begin(), plot.points.end(), std::back_inserter(points),
               [](Vec2 p) { return std::isfinite(p.x) && std::isfinite(p.y); });
  double x_min = 0.0;
  double x_max = 1.0;
  double y_max = 1.0;
  if (!points.empty()) {
    x_min = points.front().x;
    x_max = points.back().x;
    for (const Vec2 p : points) {
      x_min = std::min(x_min, p.x);
      x_max = std::max(x_max, p.x);
      y_max = std::max(y_max, p.y);
    }
  }
  if (!(x_max > x_min)) {
    x_min -= 0.5;
    x_max += 0.5;
  }
  const double x_step = math::round_up_to_125((x_max - x_min) / 10.0);
  const double y_step = math::round_up_to_125(y_max / 8.0);
  y_max = y_step * std::ceil(1.02 * y_max / y_step);
  const auto x_of = [&](double x) { return kLeft + (x - x_min) / (x_max - x_min) * (kRight - kLeft); };
  const auto y_of = [&](double y) { return kBottom - y / y_max * (kBottom - kTop); };

  std::string svg;
  open_svg(svg, kWidth, kHeight, plot.title);
  text_at(svg, kLeft, 30.0, 17.0, "start", kInk, plot.title);

  double last_label_y = kBottom + 100.0;
  std::vector<double> guides = plot.guides;
  std::sort(guides.begin(), guides.end());
  for (const double guide : guides) {
    if (!(guide > 0.0 && guide <= y_max)) {
      continue;
    }
    const double y = y_of(guide);
    line(svg, kLeft, y, kRight, y, kFaint, 0.8, attribute("stroke-dasharray", "5 4"));
    if (last_label_y - y >= 11.0) {  // labels of the first few would lie on one another
      text_at(svg, kRight + 6.0, y + 4.0, 11.0, "start", kFaint, short_text(guide));
      last_label_y = y;
    }
  }

  line(svg, kLeft, kBottom, kRight, kBottom, kInk, 1.0);
  line(svg, kLeft, kTop, kLeft, kBottom, kInk, 1.0);
  // Whole multiples of the step, counted: a running sum would drift.
  for (double k = std::ceil(x_min / x_step - 1e-9); k * x_step <= x_max + 1e-9 * x_step; k += 1.0) {
    const double x = x_of(k * x_step);
    line(svg, x, kBottom, x, kBottom + 5.0, kInk, 1.0);
    text_at(svg, x, kBottom + 20.0, 12.0, "middle", kInk, short_text(k * x_step));
  }
  for (double k = 0.0; k * y_step <= y_max * (1.0 + 1e-9); k += 1.0) {
    const double y = y_of(k * y_step);
    line(svg, kLeft - 5.0, y, kLeft, y, kInk, 1.0);
    text_at(svg, kLeft - 9.0, y + 4.0, 12.0, "end", kInk, short_text(k * y_step));
  }
  text_at(svg, 0.5 * (kLeft + kRight), kBottom + 44.0, 14.0, "middle", kInk, plot.x_label);
  const double y_centre = 0.5 * (kTop + kBottom);
  text_at(svg, 26.0, y_centre, 14.0, "middle", kInk, plot.y_label,
          attribute("transform", "rotate(-90 26 " + px(y_centre) + ")"));

  if (!points.empty()) {
    std::string path;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double from = i == 0 ? points[i].x : 0.5 * (points[i - 1].x + points[i].x);
      const double to = i + 1 == points.size() ? points[i].x : 0.5 * (points[i].x + points[i + 1].x);
      detail::append(path, i == 0 ? "M" : "L", px(x_of(from)), " ", px(y_of(points[i].y)), "L", px(x_of(to)), " ",
                     px(y_of(points[i].y)));
    }
    detail::append(svg, "<path", attribute("d", path),
                   " fill=\"none\" stroke=\"#0072B2\" stroke-width=\"1.8\" stroke-linejoin=\"round\"/>\n");
    if (points.size() <= 100) {
      svg += "<g fill=\"#0072B2\">\n";
      for (const Vec2 p : points) {
        detail::append(svg, "<circle", attribute("cx", px(x_of(p.x))), attribute("cy", px(y_of(p.y))),
                       attribute("r", "2.2"), "/>\n");
      }
      svg += "</g>\n";
    }
  }
  text_at(svg, kLeft, kHeight - 12.0, 11.0, "start", kFaint, plot.caption);
  svg += "</svg>\n";
  return svg;
}

}  // namespace anthesis
