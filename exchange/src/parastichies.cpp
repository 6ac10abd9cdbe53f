#include "anthesis/exchange/parastichies.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "anthesis/base/error.h"
#include "anthesis/base/math.h"
#include "drawing.h"
#include "text.h"

namespace anthesis {
namespace {

using detail::append;
using detail::attribute;
using detail::px;
using detail::text_at;

// Of Okabe and Ito's palette: told apart by the colour-blind, and in print.
constexpr char kCounterClockwiseColour[] = "#0072B2";
constexpr char kClockwiseColour[] = "#D55E00";
constexpr char kStraightColour[] = "#009E73";
constexpr char kIrregularColour[] = "#b8b8b8";

const char* turn_name(ParastichyTurn turn) {
  return turn == ParastichyTurn::kClockwise          ? "clockwise"
         : turn == ParastichyTurn::kCounterClockwise ? "counter-clockwise"
                                                     : "straight";
}

const char* turn_colour(ParastichyTurn turn) {
  return turn == ParastichyTurn::kClockwise          ? kClockwiseColour
         : turn == ParastichyTurn::kCounterClockwise ? kCounterClockwiseColour
                                                     : kStraightColour;
}

bool irregular(const ParastichyRegion& region) {
  return region.kind.series == ParastichySeries::kIrregular;
}

/// An empty field for what is not known.
std::string field(double value) {
  return std::isfinite(value) ? to_text(value) : std::string();
}

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

double length_of(const Parastichies& found, const ParastichyFile& file) {
  if (file.length_mm > 0.0) {
    return file.length_mm;
  }
  return !found.regions.empty() && found.regions.back().to_mm > 0.0 ? found.regions.back().to_mm : 1.0;
}

void comments(std::string& text, const ParastichyFile& file) {
  if (!file.title.empty()) {
    append(text, "# ", detail::one_line(file.title), "\n");
  }
  if (!file.caption.empty()) {
    append(text, "# ", detail::one_line(file.caption), "\n");
  }
}

std::string jugate(const ParastichyRegion& region) {
  if (region.kind.series != ParastichySeries::kMultijugate) {
    return series_name(region.kind.series);
  }
  return region.kind.jugacy == 2   ? "bijugate"
         : region.kind.jugacy == 3 ? "trijugate"
                                   : std::to_string(region.kind.jugacy) + "-jugate";
}

}  // namespace

std::string parastichy_regions_csv(const Parastichies& found, const ParastichyFile& file) {
  std::string text;
  comments(text, file);
  append(text,
         "from,to,from_mm,to_mm,organs,m,n,m_turn,n_turn,third,series,jugacy,regularity,divergence_deg,"
         "plastochron_ratio,dislocations,m_index_difference,m_index_share,n_index_difference,n_index_share,m_step_mm,"
         "n_step_mm\n");
  const double length_mm = length_of(found, file);
  for (const ParastichyRegion& region : found.regions) {
    append(text, region.from_mm / length_mm, ",", region.to_mm / length_mm, ",", region.from_mm, ",", region.to_mm, ",",
           region.organs, ",", region.m.number, ",", region.n.number, ",", turn_name(region.m.turn), ",",
           turn_name(region.n.turn), ",", region.third.number, ",", series_name(region.kind.series), ",",
           region.kind.jugacy, ",", region.regularity, ",", field(math::degrees(region.divergence_rad)), ",",
           field(region.plastochron_ratio), ",", region.dislocations, ",", region.m.index_difference, ",",
           region.m.index_share, ",", region.n.index_difference, ",", region.n.index_share, ",", region.m.step_mm, ",",
           region.n.step_mm, "\n");
  }
  return text;
}

std::string parastichy_organs_csv(const Parastichies& found, std::span<const PatternOrgan> organs,
                                  const ParastichyFile& file) {
  std::string text;
  comments(text, file);
  append(text, "id,azimuth_deg,s_mm,radius_mm,height_mm,u,divergence_deg,coordination,contacts,region,m,n\n");
  for (std::size_t i = 0; i < std::min(organs.size(), found.organs.size()); ++i) {
    const PatternOrgan& organ = organs[i];
    const ParastichyOrgan& answer = found.organs[i];
    append(text, i + (file.first_is_1 ? 1 : 0), ",", field(math::degrees(organ.azimuth_rad)), ",", field(organ.s_mm),
           ",", field(organ.radius_mm), ",", field(organ.height_mm), ",", field(answer.u), ",",
           field(math::degrees(answer.divergence_rad)), ",", answer.coordination, ",", answer.contacts, ",");
    if (std::isfinite(answer.u) && answer.region < found.regions.size()) {
      const ParastichyRegion& region = found.regions[answer.region];
      append(text, answer.region, ",", region.m.number, ",", region.n.number, "\n");
    } else {
      append(text, ",,\n");
    }
  }
  return text;
}

std::string parastichies_json(const Parastichies& found, const ParastichyFile& file) {
  using Json = nlohmann::ordered_json;
  const double length_mm = length_of(found, file);
  const std::uint32_t first = file.first_is_1 ? 1 : 0;
  Json json;
  if (!file.title.empty()) {
    json["title"] = detail::valid_utf8(file.title);
  }
  if (!file.caption.empty()) {
    json["made_by"] = detail::valid_utf8(file.caption);
  }
  json["parastichies"] = Json::array();
  for (const ParastichyRegion& region : found.regions) {
    Json item;
    item["from"] = number(region.from_mm / length_mm);
    item["to"] = number(region.to_mm / length_mm);
    item["families"] = Json::array();
    if (!irregular(region)) {
      item["families"] = {region.m.number, region.n.number};
    }
    item["series"] = series_name(region.kind.series);
    item["jugacy"] = region.kind.jugacy;
    item["regularity"] = number(region.regularity);
    item["counted"] = Json::array();
    for (const ParastichyFamily* family : {&region.m, &region.n, &region.third}) {
      Json one;
      one["number"] = family->number;
      one["turn"] = turn_name(family->turn);
      one["step_mm"] = number(family->step_mm);
      one["step_azimuth_deg"] = number(math::degrees(family->step_azimuth_rad));
      one["evenness"] = number(family->evenness);
      if (family->index_difference > 0) {
        one["index_difference"] = family->index_difference;
        one["index_share"] = number(family->index_share);
      }
      item["counted"].push_back(std::move(one));
    }
    item["divergence_deg"] = number(math::degrees(region.divergence_rad));
    item["plastochron_ratio"] = number(region.plastochron_ratio);
    item["organs"] = region.organs;
    item["dislocations"] = region.dislocations;
    item["from_mm"] = number(region.from_mm);
    item["to_mm"] = number(region.to_mm);
    json["parastichies"].push_back(std::move(item));
  }
  json["transitions"] = Json::array();
  for (const ParastichyTransition& transition : found.transitions) {
    json["transitions"].push_back({{"at", number(transition.s_mm / length_mm)},
                                   {"inside", transition.inside},
                                   {"outside", transition.outside},
                                   {"continuous", transition.continuous}});
  }
  json["dislocations"] = Json::array();
  for (const ParastichyDislocation& dislocation : found.dislocations) {
    json["dislocations"].push_back({{"at", number(dislocation.s_mm / length_mm)},
                                    {"azimuth_deg", number(math::degrees(dislocation.azimuth_rad))},
                                    {"organ", dislocation.organ + first},
                                    {"families", dislocation.pair},
                                    {"gained", dislocation.gained}});
  }
  json["divergence"] = {{"mean_deg", number(math::degrees(found.divergence.mean_rad))},
                        {"deviation_deg", number(math::degrees(found.divergence.deviation_rad))},
                        {"turn", turn_name(found.divergence.turn)},
                        {"plastochron_ratio", number(found.divergence.plastochron_ratio)}};
  json["left_out"] = found.left_out;
  return json.dump(1) + "\n";
}

std::string parastichies_svg(const Parastichies& found, std::span<const PatternOrgan> organs, ParastichyView view,
                             const ParastichyFile& file) {
  constexpr double kSide = 720.0;
  constexpr double kMargin = 40.0;
  constexpr double kLegendWidth = 230.0;
  constexpr double kTop = 56.0;
  constexpr double kFoot = 44.0;
  constexpr double kTallest = 4000.0;

  double reach_mm = 0.0;
  double u_low = 0.0;
  double u_high = 0.0;
  bool any = false;
  for (std::size_t i = 0; i < std::min(organs.size(), found.organs.size()); ++i) {
    const double u = found.organs[i].u;
    if (!std::isfinite(u)) {
      continue;
    }
    reach_mm = std::max(reach_mm, organs[i].s_mm);
    u_low = any ? std::min(u_low, u) : u;
    u_high = any ? std::max(u_high, u) : u;
    any = true;
  }
  const bool polar = view == ParastichyView::kPolar;
  const double scale = polar ? (reach_mm > 0.0 ? 0.49 * kSide / reach_mm : 1.0)
                             : std::min(kSide / math::kTurnRad, kTallest / std::max(u_high - u_low, 1e-9));
  const double height = polar ? kSide : scale * (u_high - u_low) + 16.0;
  const double width = polar ? kSide : scale * math::kTurnRad;
  const double x0 = kMargin + (polar ? 0.5 * kSide : 0.0);
  const double y0 = kTop + (polar ? 0.5 * kSide : 8.0);
  const auto wrapped = [](double angle, double low) {
    return angle - math::kTurnRad * std::floor((angle - low) / math::kTurnRad);
  };
  const auto place = [&](std::size_t i) {
    const double azimuth = wrapped(organs[i].azimuth_rad, 0.0);
    if (polar) {
      const auto [sin, cos] = math::sin_cos(azimuth);
      return Vec2{x0 + scale * organs[i].s_mm * cos, y0 - scale * organs[i].s_mm * sin};
    }
    return Vec2{x0 + scale * azimuth, y0 + scale * (found.organs[i].u - u_low)};
  };

  std::string svg;
  detail::open_svg(svg, kMargin + width + 30.0 + kLegendWidth, kTop + std::max(height, 200.0) + kFoot, file.title);
  text_at(svg, kMargin, 32.0, 18.0, "start", detail::kInk, file.title);
  append(svg, "<clipPath id=\"drawing\"><rect", attribute("x", px(kMargin)), attribute("y", px(kTop)),
         attribute("width", px(width)), attribute("height", px(height)), "/></clipPath>\n",
         "<g clip-path=\"url(#drawing)\">\n");

  // Where one pair gives way to the next.
  append(svg, "<g fill=\"none\" stroke=\"", detail::kFaint, "\" stroke-width=\"0.8\" stroke-dasharray=\"5 4\">\n");
  for (std::size_t r = 1; r < found.regions.size(); ++r) {
    const double s_mm = found.regions[r].from_mm;
    if (polar) {
      append(svg, "<circle", attribute("cx", px(x0)), attribute("cy", px(y0)), attribute("r", px(scale * s_mm)),
             "/>\n");
      continue;
    }
    double u = u_high;
    for (std::size_t i = 0; i < std::min(organs.size(), found.organs.size()); ++i) {
      if (std::isfinite(found.organs[i].u) && organs[i].s_mm >= s_mm) {
        u = std::min(u, found.organs[i].u);
      }
    }
    append(svg, "<line", attribute("x1", px(x0)), attribute("x2", px(x0 + width)),
           attribute("y1", px(y0 + scale * (u - u_low))), attribute("y2", px(y0 + scale * (u - u_low))), "/>\n");
  }
  svg += "</g>\n";

  // One path for each colour and weight: a file of a hundred thousand links opens at once.
  for (const char* colour : {kIrregularColour, kStraightColour, kCounterClockwiseColour, kClockwiseColour}) {
    std::string path;
    for (const ParastichyLink& link : found.links) {
      const std::size_t a = link.organs[0];
      const std::size_t b = link.organs[1];
      if (a >= organs.size() || b >= organs.size() || found.organs[a].region >= found.regions.size()) {
        continue;
      }
      const ParastichyRegion& region = found.regions[found.organs[a].region];
      const char* own = kIrregularColour;
      if (irregular(region)) {
        if (!link.contact) {
          continue;
        }
      } else if (link.family == 1 && link.number == region.m.number) {
        own = turn_colour(region.m.turn);
      } else if (link.family == 2 && link.number == region.n.number) {
        own = turn_colour(region.n.turn);
      } else {
        continue;
      }
      if (own != colour) {
        continue;
      }
      const Vec2 from = place(a);
      Vec2 to = place(b);
      if (!polar) {
        const double step = wrapped(organs[b].azimuth_rad - organs[a].azimuth_rad, -math::kPi);
        to.x = from.x + scale * step;
        if (to.x < x0 || to.x > x0 + width) {
          const double turn = to.x < x0 ? width : -width;
          append(path, "M", px(from.x + turn), " ", px(from.y), "L", px(to.x + turn), " ", px(to.y));
        }
      }
      append(path, "M", px(from.x), " ", px(from.y), "L", px(to.x), " ", px(to.y));
    }
    if (!path.empty()) {
      append(svg, "<path fill=\"none\" stroke-linecap=\"round\" stroke-width=\"",
             colour == kIrregularColour ? "1" : "1.6", "\"", attribute("stroke", colour), attribute("d", path), "/>\n");
    }
  }

  const double dot =
      std::clamp(0.2 * std::sqrt(width * height / std::max(1.0, static_cast<double>(organs.size()))), 0.5, 4.0);
  append(svg, "<g fill=\"", detail::kInk, "\">\n");
  for (std::size_t i = 0; i < std::min(organs.size(), found.organs.size()); ++i) {
    if (std::isfinite(found.organs[i].u)) {
      const Vec2 p = place(i);
      append(svg, "<circle", attribute("cx", px(p.x)), attribute("cy", px(p.y)), attribute("r", px(dot)), "/>\n");
    }
  }
  append(svg, "</g>\n<g fill=\"none\" stroke=\"#CC79A7\" stroke-width=\"1.8\">\n");
  for (const ParastichyDislocation& dislocation : found.dislocations) {
    if (dislocation.organ < organs.size()) {
      const Vec2 p = place(dislocation.organ);
      append(svg, "<circle", attribute("cx", px(p.x)), attribute("cy", px(p.y)), attribute("r", px(2.0 * dot + 3.0)),
             "/>\n");
    }
  }
  svg += "</g>\n</g>\n";

  const double legend_x = kMargin + width + 30.0;
  double y = kTop + 12.0;
  text_at(svg, legend_x, y, 13.0, "start", detail::kInk, "from the apex outwards");
  y += 22.0;
  for (const ParastichyRegion& region : found.regions) {
    if (irregular(region)) {
      text_at(svg, legend_x, y, 13.0, "start", detail::kFaint, "irregular");
    } else {
      text_at(svg, legend_x + 24.0, y, 15.0, "end", turn_colour(region.m.turn), std::to_string(region.m.number));
      text_at(svg, legend_x + 36.0, y, 15.0, "middle", detail::kInk, "+");
      text_at(svg, legend_x + 48.0, y, 15.0, "start", turn_colour(region.n.turn), std::to_string(region.n.number));
      text_at(svg, legend_x + 92.0, y, 13.0, "start", detail::kInk, jugate(region));
    }
    y += 20.0;
  }
  y += 10.0;
  text_at(svg, legend_x, y, 12.0, "start", kCounterClockwiseColour, "counter-clockwise on the way out");
  text_at(svg, legend_x, y + 17.0, 12.0, "start", kClockwiseColour, "clockwise on the way out");
  if (!found.dislocations.empty()) {
    text_at(svg, legend_x, y + 34.0, 12.0, "start", "#CC79A7",
            "dislocations: " + std::to_string(found.dislocations.size()));
  }
  text_at(svg, kMargin, kTop + std::max(height, 200.0) + kFoot - 14.0, 11.0, "start", detail::kFaint, file.caption);
  svg += "</svg>\n";
  return svg;
}

}  // namespace anthesis
