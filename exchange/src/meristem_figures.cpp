#include "anthesis/exchange/meristem_figures.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/meristem_dynamics.h"
#include "anthesis/phyllotaxis/meristem_tree.h"
#include "drawing.h"

namespace anthesis {
namespace {

constexpr int kShades = 17;
constexpr int kBrightnesses = 16;

/// One decimal: these drawings have tens of thousands of numbers.
std::string number(double value) {
  return detail::px(std::round(value * 10.0) / 10.0);
}

std::string hex(double r, double g, double b) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text = "#";
  for (const double value : {r, g, b}) {
    const int byte = static_cast<int>(std::lround(std::clamp(value, 0.0, 255.0)));
    text += kDigits[byte / 16];
    text += kDigits[byte % 16];
  }
  return text;
}

/// Green young, red old, as O16 fig. 11; `light` above 1 pales, below 1 darkens.
std::string age_colour(double age, double light) {
  constexpr double kStops[3][3] = {{58, 166, 85}, {232, 198, 58}, {200, 55, 45}};
  const double place = 2.0 * std::clamp(age, 0.0, 1.0);
  const int i = place < 1.0 ? 0 : 1;
  const double f = place - i;
  double c[3];
  for (int k = 0; k < 3; ++k) {
    const double v = (1.0 - f) * kStops[i][k] + f * kStops[i + 1][k];
    c[k] = light > 1.0 ? v + (light - 1.0) * (255.0 - v) : light * v;
  }
  return hex(c[0], c[1], c[2]);
}

int shade(double age) {
  return static_cast<int>(std::lround(std::clamp(age, 0.0, 1.0) * (kShades - 1)));
}

/// The head of a drawing, with a sphere in the colour of each age and the shades of naked surfaces.
std::string open(double width, double height, const std::string& title) {
  std::string svg;
  detail::open_svg(svg, width, height, title);
  svg += "<defs>\n";
  for (int i = 0; i < kShades; ++i) {
    const double age = static_cast<double>(i) / (kShades - 1);
    detail::append(svg, "<radialGradient id=\"a", i, "\" cx=\".4\" cy=\".35\" r=\".7\"><stop stop-color=\"",
                   age_colour(age, 1.45), "\"/><stop offset=\".45\" stop-color=\"", age_colour(age, 1.0),
                   "\"/><stop offset=\"1\" stop-color=\"", age_colour(age, 0.62), "\"/></radialGradient>\n");
  }
  svg += "</defs>\n<style>";
  for (int i = 0; i < kShades; ++i) {
    detail::append(svg, ".a", i, "{fill:url(#a", i, ")}");
  }
  for (int i = 0; i < kBrightnesses; ++i) {
    const double bright = 0.72 + 0.3 * i / (kBrightnesses - 1);
    const std::string naked = hex(226 * bright, 232 * bright, 206 * bright);
    const std::string part = hex(206 * bright, 224 * bright, 178 * bright);
    detail::append(svg, ".n", i, "{fill:", naked, ";stroke:", naked, "}.p", i, "{fill:", part, ";stroke:", part, "}");
  }
  return svg + "</style>\n";
}

void text(std::string& svg, double x, double y, double size, const std::string& words) {
  detail::text_at(svg, x, y, size, "middle", detail::kInk, words);
}

/// Orthographic view from the front, from some height, with things drawn from the back to the front.
struct View {
  double elevation_rad = math::radians(48);
  Vec2 centre;  ///< in the picture, of the world's origin
  double scale = 1.0;
  struct Thing {
    double depth;
    std::string svg;
  };
  std::vector<Thing> things;

  Vec3 to_eye() const { return {0.0, -math::cos(elevation_rad), math::sin(elevation_rad)}; }
  Vec2 at(Vec3 p) const {
    const Vec3 up{0.0, math::sin(elevation_rad), math::cos(elevation_rad)};
    return {centre.x + scale * p.x, centre.y - scale * dot(p, up)};
  }
  void bead(Vec3 p, double radius, double age) {
    const Vec2 c = at(p);
    things.push_back({dot(p, to_eye()) + radius, "<circle class=\"a" + std::to_string(shade(age)) + "\" cx=\"" +
                                                     number(c.x) + "\" cy=\"" + number(c.y) + "\" r=\"" +
                                                     number(scale * radius) + "\"/>\n"});
  }
  /// A surface of revolution in its own frame, from its apex to its base.
  void surface(const Placement& world, const SurfaceOfRevolution& surface, int rings, int sides, bool part,
               double depth) {
    const Vec3 light = normalized(Vec3{-0.45, -0.5, 0.75});
    for (int i = 0; i < rings; ++i) {
      for (int k = 0; k < sides; ++k) {
        const double t[2] = {static_cast<double>(i) / rings, (i + 1.0) / rings};
        const double azimuth[2] = {math::kTurnRad * k / sides, math::kTurnRad * (k + 1.0) / sides};
        const SurfaceFrame middle = surface.frame(0.5 * (t[0] + t[1]), 0.5 * (azimuth[0] + azimuth[1]));
        const Vec3 normal = rotate(world.rotation, middle.normal);
        if (dot(normal, to_eye()) < -0.05) {
          continue;
        }
        const double bright = 0.72 + 0.3 * std::max(0.0, dot(normal, light));
        const int level =
            static_cast<int>(std::lround(std::clamp((bright - 0.72) / 0.3, 0.0, 1.0) * (kBrightnesses - 1)));
        std::string path;
        for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
          const Vec2 p = at(apply(world, surface.frame(t[a], azimuth[b]).position_mm));
          detail::append(path, path.empty() ? "M" : "L", number(p.x), " ", number(p.y));
        }
        std::string drawn;
        detail::append(drawn, "<path class=\"", part ? "p" : "n", level, "\" d=\"", path, "Z\"/>\n");
        things.push_back({dot(apply(world, middle.position_mm), to_eye()) + depth, std::move(drawn)});
      }
    }
  }
  void draw(std::string& svg) {
    std::stable_sort(things.begin(), things.end(), [](const Thing& a, const Thing& b) { return a.depth < b.depth; });
    svg += "<g stroke-width=\".5\">\n";
    for (const Thing& thing : things) {
      svg += thing.svg;
    }
    svg += "</g>\n";
  }
};

MeristemDynamicsParams head(MeristemMode mode) {
  MeristemDynamicsParams p;
  p.mode = mode;
  p.profiles = {{0.0, {{0, 4.2}, {2.2, 4.2}, {4, 2.4}, {4.2, 0}}}, {1.0, {{0, 2.6}, {4, 2.6}, {7, 1.8}, {7.4, 0}}}};
  p.interval = 0.0035;
  p.meristem_area_mm2 = 90.0;
  p.meristem_growth = FunctionGraph({{0.0, 1.0}, {1.0, 1.25}});
  p.area_mm2 = FunctionGraph({{0.0, 0.8}, {1.0, 0.8}});
  p.area_growth = FunctionGraph({{0.0, 0.5}, {0.5, 0.75}, {1.0, 1.0}});
  if (mode == MeristemMode::kDivergent) {
    p.meristem_area_mm2 = 50.0;
    p.outer_area_mm2 = 40.0;
    p.outer_growth = p.meristem_growth;
    p.interval = 0.0065;
  }
  if (mode == MeristemMode::kSegregation) {
    p.meristem_area_mm2 = 1.0;
    p.threshold_area_mm2 = 1.6;
    p.meristem_growth = GrowthFunction::from_rate(FunctionGraph({{0.0, 72.0}, {1.0, 72.0}}));
  }
  return p;
}

Expected<std::string> modes_figure() {
  std::string svg = open(960, 620, "Centripetal fractionation, divergent fractionation, segregation");
  const char* const names[] = {"a  centripetal fractionation", "b  divergent fractionation", "c  segregation"};
  for (int m = 0; m < 3; ++m) {
    const auto pattern = MeristemDynamics::run(head(static_cast<MeristemMode>(m)), 10000);
    if (!pattern) {
      return unexpected(pattern.error());
    }
    text(svg, 160 + 320 * m, 26, 15, names[m]);
    for (int row = 0; row < 2; ++row) {
      const double time = row == 0 ? 0.22 : 0.95;
      View view;
      view.centre = {160.0 + 320 * m, 175.0 + 290 * row};
      view.scale = 23;
      const SurfaceOfRevolution surface = pattern->surface(time);
      view.surface({}, surface, 10, 28, false, 0.0);
      const auto places = pattern->places(time, surface);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const Primordium& primordium = pattern->primordia()[i];
        const SurfaceFrame frame = surface.frame(places[i].t, primordium.azimuth_rad);
        const double radius = 0.92 * std::sqrt(places[i].area_mm2 / math::kPi);
        if (dot(frame.normal, view.to_eye()) > -0.15) {
          view.bead(frame.position_mm + 0.25 * radius * frame.normal, radius, (time - primordium.birth) / time);
        }
      }
      view.draw(svg);
      text(svg, 160 + 320 * m, 305 + 304 * row, 12,
           std::to_string(places.size()) + " primordia, time " + (row == 0 ? "0.22" : "0.95"));
    }
  }
  return svg + "</svg>\n";
}

constexpr double kThreshold = 15.0;
constexpr double kRate = 6.0;

MeristemTreeParams self_similar() {
  const auto uniform = GrowthFunction::from_rate(FunctionGraph({{0.0, kRate}, {1.0, kRate}}));
  MeristemLevel level;
  level.dynamics.mode = MeristemMode::kSegregation;
  level.dynamics.profiles = {{0.0, {{0, 0}, {1, 0}}}};
  level.dynamics.meristem_growth = uniform;
  level.dynamics.area_growth = uniform;
  level.dynamics.meristem_area_mm2 = 0.75 * kThreshold;
  level.dynamics.threshold_area_mm2 = kThreshold;
  level.onset_area_mm2 = 0.75 * kThreshold;
  return {{level}, 4, 0.5};
}

Expected<std::string> self_similar_figure() {
  std::string svg = open(960, 640, "A self-similar pattern on a uniformly growing flat meristem");
  const auto tree = MeristemTree::run(self_similar(), 100000);
  if (!tree) {
    return unexpected(tree.error());
  }
  // Each picture a time of growth by 1.9 later than the one before, all on one scale.
  const double full = tree->places(1.0)[0].scale;
  const double scale = 255.0 / full;
  const Vec2 centres[] = {{70, 60}, {105, 200}, {195, 450}, {645, 320}};
  for (int frame = 0; frame < 4; ++frame) {
    const double time = 1.0 - (3 - frame) * 2.0 * math::log(1.85) / kRate;
    const auto places = tree->places(time);
    svg += "<g stroke=\"#7f8a6a\" stroke-width=\".5\">\n";
    const double onset_age = math::log(0.75 * kThreshold) / kRate;
    for (std::size_t i = 1; i < places.size(); ++i) {
      const Placement& p = places[i];
      const double radius = 1.2 * scale * p.scale;
      if (radius < 0.6) {
        continue;
      }
      svg += "<circle cx=\"" + number(centres[frame].x + scale * p.position_mm.x) + "\" cy=\"" +
             number(centres[frame].y - scale * p.position_mm.y) + "\" r=\"" + number(radius) + "\"";
      const double age = (time - tree->elements()[i].birth);
      svg += tree->elements()[i].onset <= time
                 ? " fill=\"" + age_colour(age, 1.75) + "\"/>\n"
                 : " stroke=\"none\" fill=\"url(#a" + std::to_string(shade(age / onset_age)) + ")\"/>\n";
    }
    svg += "</g>\n";
  }
  return svg + "</svg>\n";
}

MeristemTreeParams cones() {
  MeristemLevel whole;
  whole.dynamics.profiles = {{0.0, {{0, 1.5}, {0.25, 1.35}, {0.7, 0.6}, {1, 0}}}};
  whole.dynamics.interval = 0.007;
  whole.dynamics.meristem_area_mm2 = 42.0;
  whole.dynamics.area_growth = FunctionGraph({{0.0, 0.6}, {0.4, 0.75}, {1.0, 1.0}});
  MeristemLevel part;
  part.dynamics.profiles = {{0.0, {{0, 1.2}, {1, 0}}}, {0.6, {{0, 2.2}, {1, 0}}}};
  part.dynamics.interval = 0.014;
  part.dynamics.meristem_area_mm2 = 34.0;
  part.dynamics.area_growth = FunctionGraph({{0.0, 0.7}, {1.0, 1.0}});
  part.onset_age = 0.08;
  return {{whole, part}, 2, 0.62};
}

Expected<std::string> hierarchy_figure() {
  std::string svg = open(960, 560, "A two-level pattern of cones on a cone");
  const auto tree = MeristemTree::run(cones(), 100000);
  if (!tree) {
    return unexpected(tree.error());
  }
  for (int row = 0; row < 2; ++row) {
    const double time = row == 0 ? 0.3 : 1.0;
    View view;
    view.elevation_rad = math::radians(38);
    view.centre = row == 0 ? Vec2{225.0, 350.0} : Vec2{680.0, 340.0};
    view.scale = 56;
    const auto places = tree->places(time);
    view.surface(places[0], tree->surface(0, time), 12, 36, false, 0.0);
    for (std::uint32_t i = 1; i < places.size(); ++i) {
      const MeristemElement& element = tree->elements()[i];
      const Vec3 normal = rotate(places[i].rotation, {0, 0, 1});
      const double age = time - element.birth;
      if (element.level == 1) {
        if (dot(normal, view.to_eye()) > -0.35) {
          view.surface(places[i], tree->surface(i, time), 2, 12, true, 0.15);
        }
      } else if (dot(normal, view.to_eye()) > -0.1 &&
                 dot(rotate(places[element.parent].rotation, {0, 0, 1}), view.to_eye()) > -0.35) {
        view.bead(places[i].position_mm + 0.3 * places[i].scale * normal, 1.08 * places[i].scale, age / 0.85);
        view.things.back().depth += 0.15;
      }
    }
    view.draw(svg);
  }
  return svg + "</svg>\n";
}

}  // namespace

Expected<std::string> meristem_figure_svg(MeristemFigure figure) {
  return figure == MeristemFigure::kModes         ? modes_figure()
         : figure == MeristemFigure::kSelfSimilar ? self_similar_figure()
                                                  : hierarchy_figure();
}

}  // namespace anthesis
