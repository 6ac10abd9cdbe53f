#include "anthesis/exchange/divergence_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "anthesis/base/math.h"
#include "anthesis/exchange/svg.h"
#include "drawing.h"
#include "provenance.h"

namespace anthesis {
namespace {

using detail::append;
using detail::attribute;
using detail::kFaint;
using detail::kInk;
using detail::line;
using detail::px;
using detail::text_at;

// Okabe and Ito's palette: told apart by the colour-blind, and in print.
constexpr std::array<const char*, kStudyModels> kColours = {"#E69F00", "#0072B2", "#009E73"};

/// Left or right is an accident: the angle as its mirror image that is at most half a turn.
double folded_deg(double angle_rad) {
  const double angle = math::degrees(angle_rad);
  return angle > 180.0 ? 360.0 - angle : angle;
}

bool drawable(const DivergenceResult& result) {
  return result.measured && std::isfinite(result.pattern.divergence_rad) && std::isfinite(result.pattern.distance) &&
         result.pattern.distance > 0.0 && static_cast<std::size_t>(result.model) < kStudyModels;
}

/// One shape for each model, so that colours are not all there is to tell them apart, and three can lie on one place.
void mark(std::string& svg, StudyModel model, double x, double y) {
  const char* colour = kColours[static_cast<std::size_t>(model)];
  switch (model) {
    case StudyModel::kContactPressure:
      append(svg, "<circle", attribute("cx", px(x)), attribute("cy", px(y)), " r=\"4.6\"", " fill=\"none\"",
             attribute("stroke", colour), " stroke-width=\"1.8\"/>\n");
      break;
    case StudyModel::kCollision:
      append(svg, "<circle", attribute("cx", px(x)), attribute("cy", px(y)), " r=\"2.6\"", attribute("fill", colour),
             "/>\n");
      break;
    case StudyModel::kInhibition: {
      std::string path;
      append(path, "M", px(x), " ", px(y - 4.0), "l4 4l-4 4l-4 -4z");
      append(svg, "<path", attribute("d", path), attribute("fill", colour), " fill-opacity=\"0.8\"/>\n");
      break;
    }
  }
}

}  // namespace

std::string divergence_study_csv(const DivergenceStudy& study) {
  std::string text;
  append(text, "# generator: ", detail::generator(), "\n");
  append(text, "model,size,distance,rise,divergence_deg,deviation_deg,m,n,agreement\n");
  for (const DivergenceResult& result : study.results) {
    if (drawable(result)) {
      const PatternMeasure& pattern = result.pattern;
      append(text, model_name(result.model), ",", result.size, ",", pattern.distance, ",", result.rise, ",",
             folded_deg(pattern.divergence_rad), ",", math::degrees(pattern.deviation_rad), ",", pattern.m, ",",
             pattern.n, ",", pattern.agreement, "\n");
    }
  }
  return text;
}

std::string divergence_study_svg(const DivergenceStudy& study, const std::string& title, const std::string& caption) {
  constexpr double kWidth = 860.0;
  constexpr double kHeight = 900.0;
  constexpr double kLeft = 76.0;
  constexpr double kRight = 800.0;
  constexpr double kTop = 84.0;      // upper panel
  constexpr double kMiddle = 480.0;  // its foot
  constexpr double kLower = 520.0;   // lower panel
  constexpr double kBottom = 816.0;
  constexpr double kLowDeg = 90.0;
  constexpr double kHighDeg = 184.0;

  double size_min = HUGE_VAL;
  double size_max = 0.0;
  double highest = 3.0;
  for (const DivergenceResult& result : study.results) {
    if (drawable(result)) {
      size_min = std::min({size_min, result.size, result.pattern.distance});
      size_max = std::max({size_max, result.size, result.pattern.distance});
      highest = std::max(highest, static_cast<double>(result.pattern.n));
    }
  }
  if (!(size_max > 0.0)) {
    size_min = 0.05;
    size_max = 0.5;
  }
  size_min /= 1.05;
  size_max *= 1.05;
  const double folds = math::log(size_max / size_min);
  // Small organs to the right: that is where a growing plant goes.
  const auto x_of = [&](double size) { return kLeft + math::log(size_max / size) / folds * (kRight - kLeft); };
  const auto y_of = [&](double angle_deg) {
    return kMiddle - (angle_deg - kLowDeg) / (kHighDeg - kLowDeg) * (kMiddle - kTop);
  };
  const double count_top = 1.35 * highest;
  const auto count_y = [&](double count) {
    return kBottom - math::log(std::max(count, 0.8) / 0.8) / math::log(count_top / 0.8) * (kBottom - kLower);
  };

  std::string svg;
  detail::open_svg(svg, kWidth, kHeight, title);
  text_at(svg, kLeft, 30.0, 17.0, "start", kInk, title);

  // Legend.
  double x = kLeft + 5.0;
  for (std::size_t i = 0; i < kStudyModels; ++i) {
    const StudyModel model = static_cast<StudyModel>(i);
    mark(svg, model, x, 55.5);
    text_at(svg, x + 12.0, 60.0, 13.0, "start", kInk, model_name(model));
    x += i == 0 ? 150.0 : 110.0;
  }
  line(svg, x, 55.5, x + 22.0, 55.5, "#9a9a9a", 1.3);
  text_at(svg, x + 30.0, 60.0, 13.0, "start", kInk, "van Iterson: circles touch along (m, n)");

  append(svg, "<clipPath id=\"panel\"><rect", attribute("x", px(kLeft)), attribute("y", px(kTop)),
         attribute("width", px(kRight - kLeft)), attribute("height", px(kMiddle - kTop)), "/></clipPath>\n");

  // Upper panel: guides first, then arcs, then dots.
  const double golden_deg = math::degrees(kGoldenAngleRad);
  const double lucas_deg = 360.0 / (3.0 + 1.0 / std::numbers::phi);
  const std::array<std::pair<double, const char*>, 2> limits = {
      {{golden_deg, "137.5\xC2\xB0"}, {lucas_deg, "99.5\xC2\xB0"}}};
  for (const auto& [angle, label] : limits) {
    line(svg, kLeft, y_of(angle), kRight, y_of(angle), kFaint, 0.8, " stroke-dasharray=\"5 4\"");
    text_at(svg, kRight + 6.0, y_of(angle) + 4.0, 11.0, "start", kFaint, label);
  }
  svg += "<g clip-path=\"url(#panel)\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n";
  for (const LatticeArc& arc : study.arcs) {
    const auto draw = [&](std::size_t from, std::size_t to, const char* look) {
      std::string path;
      for (std::size_t i = from; i < to; ++i) {
        append(path, i == from ? "M" : "L", px(x_of(2.0 * arc.points[i].radius)), " ",
               px(y_of(math::degrees(arc.points[i].divergence_rad))));
      }
      if (to > from + 1) {
        append(svg, "<path", attribute("d", path), look, "/>\n");
      }
    };
    const std::size_t border = std::min(arc.first_opposed, arc.points.size());
    draw(0, std::min(border + 1, arc.points.size()), " stroke=\"#c8c8c8\" stroke-width=\"0.8\"");
    draw(border, arc.points.size(), " stroke=\"#9a9a9a\" stroke-width=\"1.3\"");
  }
  svg += "</g>\n";
  // Names of the arcs, above or below their middle, where neither a dot nor another name is in the way. Arcs come with
  // the largest circles first.
  struct Box {
    double x;
    double y;
    double half_width;
    double half_height;
  };
  std::vector<Box> taken;
  for (const DivergenceResult& result : study.results) {
    if (drawable(result)) {
      taken.push_back({x_of(result.pattern.distance), y_of(folded_deg(result.pattern.divergence_rad)), 5.0, 5.0});
    }
  }
  for (const LatticeArc& arc : study.arcs) {
    const std::size_t from = std::min(arc.first_opposed, arc.points.size());
    if (arc.points.size() < from + 3 || arc.m + arc.n > 21) {
      continue;
    }
    const TouchingLattice& middle = arc.points[(from + arc.points.size()) / 2];
    const double at_x = x_of(2.0 * middle.radius);
    const double at_y = y_of(math::degrees(middle.divergence_rad));
    std::string words;
    append(words, "(", arc.m, ", ", arc.n, ")");
    const double half_width = 3.2 * static_cast<double>(words.size());
    if (x_of(2.0 * arc.points.back().radius) - x_of(2.0 * arc.points[from].radius) < 1.5 * half_width ||
        at_x < kLeft + half_width + 4.0 || at_x > kRight - half_width) {
      continue;
    }
    for (const double aside : {-15.0, 15.0, -22.0, 22.0}) {
      const Box box{at_x, at_y + aside, half_width, 6.0};
      const bool free = std::none_of(taken.begin(), taken.end(), [&](const Box& other) {
        return std::abs(box.x - other.x) < box.half_width + other.half_width &&
               std::abs(box.y - other.y) < box.half_height + other.half_height;
      });
      if (free && box.y > kTop + 8.0 && box.y < kMiddle - 8.0) {
        text_at(svg, box.x, box.y + 4.0, 11.0, "middle", "#6a6a6a", words,
                " stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\"");
        taken.push_back(box);
        break;
      }
    }
  }
  svg += "<g>\n";
  for (const DivergenceResult& result : study.results) {
    const double angle = folded_deg(result.pattern.divergence_rad);
    if (drawable(result) && angle >= kLowDeg && angle <= kHighDeg) {
      mark(svg, result.model, x_of(result.pattern.distance), y_of(angle));
    }
  }
  svg += "</g>\n";

  // Lower panel.
  double last_label_y = kBottom + 100.0;
  for (const double guide : fibonacci_guides(count_top)) {
    const double y = count_y(guide);
    line(svg, kLeft, y, kRight, y, kFaint, 0.8, " stroke-dasharray=\"5 4\"");
    if (last_label_y - y >= 11.0) {
      text_at(svg, kLeft - 9.0, y + 4.0, 12.0, "end", kInk, std::to_string(static_cast<int>(guide)));
      last_label_y = y;
    }
  }
  for (const DivergenceResult& result : study.results) {
    if (drawable(result)) {
      // The three lie on the same whole numbers most of the time: side by side they can all be seen.
      const double aside = 5.0 * (static_cast<double>(result.model) - 1.0);
      const double at = x_of(result.pattern.distance);
      mark(svg, result.model, at, count_y(result.pattern.m) + aside);
      if (result.pattern.n != result.pattern.m) {
        mark(svg, result.model, at, count_y(result.pattern.n) + aside);
      }
    }
  }

  // Axes over everything.
  for (const double foot : {kMiddle, kBottom}) {
    line(svg, kLeft, foot, kRight, foot, kInk, 1.0);
    line(svg, kLeft, foot == kMiddle ? kTop : kLower, kLeft, foot, kInk, 1.0);
    for (const double size : {0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.08, 0.06, 0.05, 0.04, 0.03, 0.02}) {
      if (size >= size_min && size <= size_max) {
        line(svg, x_of(size), foot, x_of(size), foot + 5.0, kInk, 1.0);
        if (foot == kBottom) {
          std::string words;
          detail::append_number(words, size);
          text_at(svg, x_of(size), foot + 20.0, 12.0, "middle", kInk, words);
        }
      }
    }
  }
  for (double angle = 90.0; angle <= 180.0; angle += 15.0) {
    line(svg, kLeft - 5.0, y_of(angle), kLeft, y_of(angle), kInk, 1.0);
    text_at(svg, kLeft - 9.0, y_of(angle) + 4.0, 12.0, "end", kInk, std::to_string(static_cast<int>(angle)));
  }
  text_at(svg, 0.5 * (kLeft + kRight), kBottom + 44.0, 14.0, "middle", kInk,
          "organ size: distance between neighbours / circumference");
  const auto upright = [&](double centre, const char* words) {
    text_at(svg, 26.0, centre, 14.0, "middle", kInk, words,
            attribute("transform", "rotate(-90 26 " + px(centre) + ")"));
  };
  upright(0.5 * (kTop + kMiddle), "divergence (degrees)");
  upright(0.5 * (kLower + kBottom), "parastichies m and n");
  text_at(svg, kLeft, kHeight - 12.0, 11.0, "start", kFaint, caption);
  svg += "</svg>\n";
  return svg;
}

}  // namespace anthesis
