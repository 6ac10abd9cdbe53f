#include "anthesis/exchange/section_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "anthesis/base/math.h"
#include "anthesis/geometry/predicates.h"
#include "drawing.h"
#include "text.h"

namespace anthesis {
namespace {

using detail::attribute;
using detail::kFaint;
using detail::kInk;
using detail::line;
using detail::px;
using detail::short_text;
using detail::text_at;

constexpr std::size_t kMostPanels = 60;
constexpr double kMostRows = 200.0;  // of a grid
constexpr double kMargin = 28.0;
constexpr double kTop = 52.0;
constexpr double kFoot = 34.0;
constexpr double kGap = 34.0;        ///< between panels; names of control points stand in it
constexpr double kPanelHead = 24.0;  ///< over a panel, for its name
constexpr double kPanelFoot = 40.0;  ///< under a panel, for its scale bar
constexpr double kLegendWidth = 84.0;

/// Paper, straw, green, blue, night: darker with every step in print without colours too.
std::string shade(double share) {
  constexpr std::array<std::array<double, 3>, 5> kStops = {
      {{250, 248, 238}, {222, 226, 150}, {92, 178, 150}, {38, 104, 152}, {22, 32, 84}}};
  return detail::blended(kStops, share);
}

/// Lengths are shown in millimetres where they are known.
double shown_per_unit(const SectionFigureParams& params) {
  return params.unit_mm > 0.0 ? params.unit_mm : 1.0;
}

std::string unit_name(const SectionFigureParams& params) {
  return params.unit_mm > 0.0 ? "mm" : "units";
}

/// Where a section lies in the drawing.
struct Panel {
  Vec2 corner;   ///< in pixels: the axis, at the lowest height
  double scale;  ///< pixels for the sections' unit
  double low;    ///< the lowest height

  Vec2 at(Vec2 p) const { return {corner.x + scale * p.x, corner.y - scale * (p.y - low)}; }

  std::string path(std::span<const Vec2> points) const {
    std::string text;
    for (const Vec2 p : points) {
      const Vec2 q = at(p);
      detail::append(text, text.empty() ? "M" : "L", px(q.x), " ", px(q.y));
    }
    return text;
  }
};

struct Extent {
  double width = 0.0;
  double low = 0.0;
  double high = 0.0;
};

Extent extent_of(std::span<const Vec2> controls) {
  Extent extent{0.0, controls.front().y, controls.front().y};
  for (const Vec2 p : controls) {
    extent.width = std::max(extent.width, p.x);
    extent.low = std::min(extent.low, p.y);
    extent.high = std::max(extent.high, p.y);
  }
  return extent;
}

/// A figure of panels in rows, each panel as large as its room lets it be, scale bars under them.
class Figure {
 public:
  Figure(const SectionFigureParams& params, std::span<const Extent> extents, std::size_t columns, bool with_legend)
      : params_(params) {
    const double right = params.width_px - kMargin - (with_legend ? kLegendWidth : 0.0);
    const auto count = static_cast<double>(columns);
    room_ = (right - kMargin - (count - 1.0) * kGap) / count;
    double top = kTop;
    for (std::size_t first = 0; first < extents.size(); first += columns) {
      const std::size_t end = std::min(first + columns, extents.size());
      double tallest = 0.0;
      std::vector<double> scales;
      for (std::size_t i = first; i < end; ++i) {
        const Extent& extent = extents[i];
        // As wide as a column, and not more than half as high again as wide.
        const double scale = std::min(room_ / extent.width, 1.5 * room_ / (extent.high - extent.low));
        scales.push_back(scale);
        tallest = std::max(tallest, scale * (extent.high - extent.low));
      }
      for (std::size_t i = first; i < end; ++i) {
        const double x = kMargin + static_cast<double>(i - first) * (room_ + kGap);
        panels_.push_back({{x, top + kPanelHead + tallest}, scales[i - first], extents[i].low});
        tops_.push_back(top);
      }
      top += kPanelHead + tallest + kPanelFoot;
    }
    legend_x_ = right + 26.0;
    height_ = top + kFoot;
    detail::open_svg(svg, params.width_px, height_, params.title);
    text_at(svg, kMargin, 30.0, 18.0, "start", kInk, params.title);
  }

  const Panel& panel(std::size_t i) const { return panels_[i]; }

  void name(std::size_t i, const std::string& words) {
    text_at(svg, panels_[i].corner.x, tops_[i] + 12.0, 13.0, "start", kInk, words);
  }

  void outline(std::size_t i, std::span<const Vec2> controls) {
    const Panel& panel = panels_[i];
    detail::append(svg, "<path", attribute("d", panel.path(controls)), " fill=\"none\" stroke=\"", kInk,
                   "\" stroke-width=\"1.6\" stroke-linejoin=\"round\"/>\n");
    const Vec2 foot = panel.at(controls.back());
    const Vec2 top = panel.at(controls.front());
    line(svg, foot.x, foot.y + 8.0, top.x, top.y - 8.0, kInk, 0.8, attribute("stroke-dasharray", "8 3 2 3"));
  }

  void triangulation(std::size_t i, const SectionMesh& mesh) {
    if (!params_.with_mesh) {
      return;
    }
    // Every edge once: from the triangle that has it in ascending order, or alone.
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const Triangle& triangle : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        edges.push_back(std::minmax({triangle[k], triangle[(k + 1) % 3]}) ==
                                std::pair(triangle[k], triangle[(k + 1) % 3])
                            ? std::array{triangle[k], triangle[(k + 1) % 3]}
                            : std::array{triangle[(k + 1) % 3], triangle[k]});
      }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    std::string path;
    for (const auto& [a, b] : edges) {
      const std::array ends{mesh.points[a], mesh.points[b]};
      path += panels_[i].path(ends);
    }
    detail::append(svg, "<path", attribute("d", path),
                   " fill=\"none\" stroke=\"#333333\" stroke-opacity=\".38\" stroke-width=\".4\"/>\n");
  }

  void scale_bar(std::size_t i) {
    const Panel& panel = panels_[i];
    const double per_unit = shown_per_unit(params_);
    const double bar = math::round_down_to_125(0.5 * room_ / panel.scale * per_unit);
    const double length = panel.scale * bar / per_unit;
    const double y = panel.corner.y + 20.0;
    line(svg, panel.corner.x, y, panel.corner.x + length, y, kInk, 2.0);
    text_at(svg, panel.corner.x + length + 7.0, y + 4.0, 11.0, "start", kInk,
            short_text(bar) + " " + unit_name(params_));
  }

  void legend(const std::string& words, std::span<const std::string> labels) {
    constexpr double kStep = 22.0;
    text_at(svg, legend_x_, kTop + 12.0, 13.0, "start", kInk, words);
    double y = kTop + 24.0;
    for (std::size_t k = labels.size() + 1; k-- > 0; y += kStep) {
      detail::append(svg, "<rect", attribute("x", px(legend_x_)), attribute("y", px(y)), attribute("width", "14"),
                     attribute("height", px(kStep)),
                     attribute("fill", shade(static_cast<double>(k) / static_cast<double>(labels.size()))), "/>\n");
      if (k > 0) {
        text_at(svg, legend_x_ + 20.0, y + kStep + 4.0, 11.0, "start", kInk, labels[k - 1]);
      }
    }
  }

  std::string finish() {
    text_at(svg, kMargin, height_ - 14.0, 11.0, "start", kFaint, params_.caption);
    svg += "</svg>\n";
    return std::move(svg);
  }

  std::string svg;

 private:
  const SectionFigureParams& params_;
  double room_ = 0.0;
  double height_ = 0.0;
  double legend_x_ = 0.0;
  std::vector<Panel> panels_;
  std::vector<double> tops_;
};

/// The boundary of where a function that is linear on triangles is at least `level`: closed paths. Triangles are cut;
/// sides that two parts share are left out, so that the paths are the isolines and what they meet of the boundary.
std::string region_path(const SectionMesh& mesh, std::span<const double> values, double level, const Panel& panel) {
  using Node = std::uint64_t;  // a point of the mesh twice, or the two ends of a side that the isoline crosses
  struct Side {
    Node from;
    Node to;
    bool operator<(const Side& other) const { return from != other.from ? from < other.from : to < other.to; }
  };
  const auto node = [](std::uint32_t a, std::uint32_t b) {
    return static_cast<Node>(std::min(a, b)) << 32 | std::max(a, b);
  };
  const auto place = [&](Node n) {
    const auto a = static_cast<std::uint32_t>(n >> 32);
    const auto b = static_cast<std::uint32_t>(n);
    return a == b ? mesh.points[a]
                  : lerp(mesh.points[a], mesh.points[b], (level - values[a]) / (values[b] - values[a]));
  };
  std::vector<Side> sides;
  for (const Triangle& triangle : mesh.triangles) {
    Node corners[6];
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k];
      const std::uint32_t b = triangle[(k + 1) % 3];
      if (values[a] >= level) {
        corners[count++] = node(a, a);
      }
      if ((values[a] >= level) != (values[b] >= level)) {
        corners[count++] = node(a, b);
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      sides.push_back({corners[k], corners[(k + 1) % count]});
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<Side> open;
  std::copy_if(sides.begin(), sides.end(), std::back_inserter(open), [&](const Side& side) {
    return !std::binary_search(sides.begin(), sides.end(), Side{side.to, side.from});
  });
  std::vector<bool> used(open.size(), false);
  std::string path;
  for (std::size_t i = 0; i < open.size(); ++i) {
    std::vector<Vec2> loop;
    for (std::size_t at = i; at < open.size() && !used[at];) {
      used[at] = true;
      loop.push_back(place(open[at].from));
      const Node next = open[at].to;
      at = static_cast<std::size_t>(std::lower_bound(open.begin(), open.end(), Side{next, 0}) - open.begin());
      while (at < open.size() && open[at].from == next && used[at]) {
        ++at;  // another loop touches here
      }
      if (at < open.size() && open[at].from != next) {
        break;
      }
    }
    if (!loop.empty()) {
      path += panel.path(loop) + "Z";
    }
  }
  return path;
}

void draw_bands(Figure& figure, std::size_t i, std::span<const Vec2> controls, const SectionMesh& mesh,
                std::span<const double> values, std::span<const double> levels) {
  const Panel& panel = figure.panel(i);
  detail::append(figure.svg, "<path", attribute("d", panel.path(controls) + "Z"), attribute("fill", shade(0.0)),
                 "/>\n");
  for (std::size_t k = 0; k < levels.size(); ++k) {
    // Each region lies on those before it: no seams between bands.
    const std::string path = region_path(mesh, values, levels[k], panel);
    if (!path.empty()) {
      detail::append(figure.svg, "<path", attribute("d", path),
                     attribute("fill", shade(static_cast<double>(k + 1) / static_cast<double>(levels.size()))),
                     " stroke=\"#ffffff\" stroke-opacity=\".75\" stroke-width=\".7\" stroke-linejoin=\"round\"/>\n");
    }
  }
}

/// Control points as dots, with the numbers of those that have room for them outside the section.
void draw_numbers(Figure& figure, std::size_t i, std::span<const Vec2> controls) {
  constexpr double kSize = 8.0;
  const Panel& panel = figure.panel(i);
  std::vector<Vec2> taken;
  for (std::size_t c = 0; c < controls.size(); ++c) {
    const Vec2 p = panel.at(controls[c]);
    detail::append(figure.svg, "<circle", attribute("cx", px(p.x)), attribute("cy", px(p.y)), attribute("r", "1.7"),
                   attribute("fill", kInk), "/>\n");
    const Vec2 along =
        panel.at(controls[std::min(c + 1, controls.size() - 1)]) - panel.at(controls[c == 0 ? 0 : c - 1]);
    const double span = length(along);
    const Vec2 outwards = span > 0.0 ? Vec2{along.y, -along.x} / span : Vec2{0.0, -1.0};
    const Vec2 words = p + 9.0 * outwards;
    const auto is_near = [&](Vec2 q) { return std::fabs(q.x - words.x) < 13.0 && std::fabs(q.y - words.y) < kSize; };
    if (words.x > panel.corner.x - 14.0 && std::none_of(taken.begin(), taken.end(), is_near)) {
      taken.push_back(words);
      text_at(figure.svg, words.x, words.y + 0.36 * kSize, kSize, "middle", kInk, std::to_string(c));
    }
  }
}

void draw_arrow(std::string& svg, Vec2 from, Vec2 to) {
  const Vec2 along = to - from;
  const double span = length(along);
  if (span < 1.5) {
    detail::append(svg, "<circle", attribute("cx", px(from.x)), attribute("cy", px(from.y)), " r=\".9\"/>\n");
    return;
  }
  const Vec2 unit = along / span;
  const Vec2 across{-unit.y, unit.x};
  const double head = std::min(5.0, 0.5 * span);
  const Vec2 neck = to - head * unit;
  const Vec2 left = neck + 0.4 * head * across;
  const Vec2 right = neck - 0.4 * head * across;
  std::string path;
  detail::append(path, "M", px(from.x), " ", px(from.y), "L", px(neck.x), " ", px(neck.y), "M", px(left.x), " ",
                 px(left.y), "L", px(to.x), " ", px(to.y), "L", px(right.x), " ", px(right.y), "Z");
  detail::append(svg, "<path", attribute("d", path), "/>\n");
}

std::optional<Error> carry_to(InteriorGrowth& growth, std::size_t frame, std::span<Vec2> points,
                              const SectionFigureParams& params) {
  while (growth.frame() < frame) {
    if (!report(params.progress, "figure", static_cast<double>(growth.frame()) / static_cast<double>(frame))) {
      return Error{ErrorCode::kCancelled, "", "cancelled"};
    }
    (void)growth.carry(points);
    if (std::optional<Error> error = growth.advance(growth.frame() + 1)) {
      return error;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> check(const SectionFigureParams& params) {
  if (!(params.unit_mm >= 0.0 && params.unit_mm <= 1e9)) {
    return invalid_parameter("unit_mm", "must be between 0 and 1e9", params.unit_mm);
  }
  if (!(params.width_px >= 300.0 && params.width_px <= 10000.0)) {
    return invalid_parameter("width_px", "must be between 300 and 10000", params.width_px);
  }
  return check(params.interior.mesh);
}

Expected<std::string> section_weights_svg(std::span<const Vec2> controls, std::span<const std::uint32_t> shown,
                                          const SectionFigureParams& params) {
  if (std::optional<Error> error = check(params)) {
    return unexpected(std::move(*error));
  }
  if (shown.size() > kMostPanels) {
    return unexpected(
        invalid_parameter("shown", "must be at most 60 control points", static_cast<double>(shown.size())));
  }
  for (const std::uint32_t c : shown) {
    if (c >= controls.size()) {
      return unexpected(
          invalid_parameter("shown", "must be below " + std::to_string(controls.size()), static_cast<double>(c)));
    }
  }
  const Expected<HarmonicSection> section = HarmonicSection::make(controls, params.interior.mesh);
  if (!section) {
    return unexpected(section.error());
  }
  constexpr std::array kLevels{0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 0.6};
  const std::vector<Extent> extents(shown.size() + 1, extent_of(controls));
  Figure figure(params, extents, std::min<std::size_t>(extents.size(), 3), true);
  figure.triangulation(0, section->mesh());
  figure.outline(0, controls);
  draw_numbers(figure, 0, controls);
  figure.name(0, std::to_string(controls.size()) + " control points");
  figure.scale_bar(0);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    std::vector<double> values(controls.size(), 0.0);
    values[shown[i]] = 1.0;
    const std::vector<double> field = section->extend(values);
    draw_bands(figure, i + 1, controls, section->mesh(), field, kLevels);
    figure.triangulation(i + 1, section->mesh());
    figure.outline(i + 1, controls);
    const Vec2 p = figure.panel(i + 1).at(controls[shown[i]]);
    detail::append(figure.svg, "<circle", attribute("cx", px(p.x)), attribute("cy", px(p.y)),
                   " r=\"4\" fill=\"#D55E00\" stroke=\"#ffffff\"/>\n");
    figure.name(i + 1, "control point " + std::to_string(shown[i]));
  }
  std::vector<std::string> labels;
  for (const double level : kLevels) {
    labels.push_back(short_text(level));
  }
  figure.legend("weight", labels);
  return figure.finish();
}

Expected<std::string> section_displacement_svg(const SectionSequence& sections, std::size_t from, std::size_t to,
                                               const SectionFigureParams& params) {
  if (std::optional<Error> error = check(params)) {
    return unexpected(std::move(*error));
  }
  if (!(from < to && to < sections.frames())) {
    return unexpected(invalid_parameter("frames", "must ascend and be below " + std::to_string(sections.frames()),
                                        static_cast<double>(to)));
  }
  Expected<InteriorGrowth> growth = InteriorGrowth::make(sections, params.interior);
  if (!growth) {
    return unexpected(growth.error());
  }
  if (std::optional<Error> error = carry_to(*growth, from, {}, params)) {
    return unexpected(std::move(*error));
  }
  const SectionMesh mesh = growth->mesh();
  const std::span<const Vec2> before = sections.frame(from);
  const std::span<const Vec2> after = sections.frame(to);
  Extent extent = extent_of(before);
  const Extent later = extent_of(after);
  const double size = std::max(extent.width, extent.high - extent.low);
  extent = {std::max(extent.width, later.width), std::min(extent.low, later.low), std::max(extent.high, later.high)};

  // Points of the mesh, then starts of arrows in rows. What lies on the axis is taken beside it: there is no other
  // displacement at the axis itself than that it stays there.
  std::vector<Vec2> moved = mesh.points;
  for (Vec2& p : moved) {
    p.x = std::max(p.x, 1e-6 * size);
  }
  constexpr double kArrows = 14.0;
  const double step = size / kArrows;
  for (double y = extent.low + 0.5 * step; y < extent.high; y += step) {
    for (double x = 0.5 * step; x < extent.width; x += step) {
      if (is_in_section(before, {x, y})) {
        moved.push_back({x, y});
      }
    }
  }
  const std::vector<Vec2> starts(moved.begin() + static_cast<std::ptrdiff_t>(mesh.points.size()), moved.end());
  if (std::optional<Error> error = carry_to(*growth, to, moved, params)) {
    return unexpected(std::move(*error));
  }
  std::vector<double> distance;
  double most = 0.0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    distance.push_back(length(moved[v] - mesh.points[v]));
    most = std::max(most, distance.back());
  }
  std::vector<double> levels;
  std::vector<std::string> labels;
  if (most > 0.0) {
    const double per_unit = shown_per_unit(params);
    const double band = math::round_down_to_125(most * per_unit / 5.0);
    for (double k = 1.0; k * band < most * per_unit * (1.0 - 1e-9); k += 1.0) {
      levels.push_back(k * band / per_unit);
      labels.push_back(short_text(k * band));
    }
  }
  Figure figure(params, std::span(&extent, 1), 1, true);
  draw_bands(figure, 0, before, mesh, distance, levels);
  figure.triangulation(0, mesh);
  figure.outline(0, before);
  detail::append(figure.svg, "<path", attribute("d", figure.panel(0).path(after)), " fill=\"none\" stroke=\"", kInk,
                 "\" stroke-width=\"1\" stroke-dasharray=\"5 3\"/>\n<g fill=\"#D55E00\" stroke=\"#D55E00\" "
                 "stroke-width=\".9\">\n");
  for (std::size_t i = 0; i < starts.size(); ++i) {
    draw_arrow(figure.svg, figure.panel(0).at(starts[i]), figure.panel(0).at(moved[mesh.points.size() + i]));
  }
  figure.svg += "</g>\n";
  figure.name(0, "frame " + std::to_string(from) + " (solid) to " + std::to_string(to) + " (dashed)");
  figure.scale_bar(0);
  figure.legend("moved, " + unit_name(params), labels);
  return figure.finish();
}

Expected<std::string> section_growth_svg(const SectionSequence& sections, std::span<const std::size_t> frames,
                                         std::size_t across, const SectionFigureParams& params) {
  if (std::optional<Error> error = check(params)) {
    return unexpected(std::move(*error));
  }
  if (frames.empty() || frames.size() > kMostPanels || frames.back() >= sections.frames() ||
      std::adjacent_find(frames.begin(), frames.end(), std::greater_equal<>()) != frames.end()) {
    return unexpected(Error{ErrorCode::kInvalidParameter, "frames",
                            "must be 1 to 60, ascend and be below " + std::to_string(sections.frames())});
  }
  if (across < 4 || across > 200) {
    return unexpected(invalid_parameter("across", "must be between 4 and 200", static_cast<double>(across)));
  }
  Expected<InteriorGrowth> growth = InteriorGrowth::make(sections, params.interior);
  if (!growth) {
    return unexpected(growth.error());
  }
  if (std::optional<Error> error = carry_to(*growth, frames.front(), {}, params)) {
    return unexpected(std::move(*error));
  }

  // Meshes of the grid whose whole outline is inside, as closed lines of kPieces points a side. A side that two meshes
  // share is carried twice, to the same place.
  constexpr std::size_t kPieces = 6;
  const std::span<const Vec2> first = sections.frame(frames.front());
  const Extent start = extent_of(first);
  const double step = std::max(start.width / static_cast<double>(across), (start.high - start.low) / kMostRows);
  std::vector<Vec2> points;
  std::vector<bool> is_dark;
  const auto rows = static_cast<std::size_t>((start.high - start.low) / step) + 1;
  for (std::size_t j = 0; j < rows; ++j) {
    for (std::size_t i = 0; i < across; ++i) {
      std::vector<Vec2> mesh_outline;
      const Vec2 low{(static_cast<double>(i) + 0.5) * step, start.low + (static_cast<double>(j) + 0.25) * step};
      const std::array corners{low, low + Vec2{step, 0.0}, low + Vec2{step, step}, low + Vec2{0.0, step}};
      for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t n = 0; n < kPieces; ++n) {
          mesh_outline.push_back(lerp(corners[k], corners[(k + 1) % 4], static_cast<double>(n) / kPieces));
        }
      }
      if (std::all_of(mesh_outline.begin(), mesh_outline.end(), [&](Vec2 p) { return is_in_section(first, p); })) {
        points.insert(points.end(), mesh_outline.begin(), mesh_outline.end());
        is_dark.push_back((i + j) % 2 == 1);
      }
    }
  }

  std::vector<Extent> extents;
  for (const std::size_t frame : frames) {
    extents.push_back(extent_of(sections.frame(frame)));
  }
  Figure figure(params, extents, extents.size() == 4 ? 4 : std::min<std::size_t>(extents.size(), 3), false);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (std::optional<Error> error = carry_to(*growth, frames[f], points, params)) {
      return unexpected(std::move(*error));
    }
    const Panel& panel = figure.panel(f);
    const std::span<const Vec2> controls = sections.frame(frames[f]);
    detail::append(figure.svg, "<path", attribute("d", panel.path(controls) + "Z"), attribute("fill", shade(0.0)),
                   "/>\n");
    for (const bool dark : {false, true}) {
      std::string path;
      for (std::size_t m = 0; m < is_dark.size(); ++m) {
        if (is_dark[m] == dark) {
          path += panel.path(std::span(points).subspan(4 * kPieces * m, 4 * kPieces)) + "Z";
        }
      }
      detail::append(figure.svg, "<path", attribute("d", path), attribute("fill", shade(dark ? 0.5 : 0.2)),
                     " stroke=\"#1f3d3a\" stroke-width=\".5\" stroke-linejoin=\"round\"/>\n");
    }
    figure.outline(f, controls);
    figure.name(f, "frame " + std::to_string(frames[f]));
    figure.scale_bar(f);
  }
  return figure.finish();
}

}  // namespace anthesis
