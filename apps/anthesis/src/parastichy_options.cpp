#include "parastichy_options.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "anthesis/base/math.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 3> kFormats = {"svg", "csv", "json"};
constexpr std::array<std::string_view, 1> kOrganFormats = {"csv"};

std::string turn_of(ParastichyTurn turn) {
  return turn == ParastichyTurn::kClockwise  ? "clockwise"
         : turn == ParastichyTurn::kStraight ? "straight"
                                             : "counter-clockwise";
}

std::string series_of(const SeriesOfPair& kind) {
  if (kind.series == ParastichySeries::kMultijugate) {
    return kind.jugacy == 2 ? "bijugate" : fmt::format("{} times Fibonacci", kind.jugacy);
  }
  std::string name = series_name(kind.series);
  if (kind.series == ParastichySeries::kFibonacci || kind.series == ParastichySeries::kLucas) {
    name[0] = static_cast<char>(name[0] - 'a' + 'A');
  }
  return kind.series == ParastichySeries::kOther ? fmt::format("series {}, {}, ...", kind.seeds[0], kind.seeds[1])
                                                 : name;
}

/// The table that a terminal shows.
std::string words(const Parastichies& found, const ParastichyFile& file) {
  std::string text;
  if (std::isfinite(found.divergence.mean_rad)) {
    text += fmt::format("divergence {:.2f} degrees, spread {:.2f}, {}\n", math::degrees(found.divergence.mean_rad),
                        math::degrees(found.divergence.deviation_rad), turn_of(found.divergence.turn));
  }
  if (found.regions.empty()) {
    return text + "too few organs for parastichies\n";
  }
  const double length_mm = file.length_mm > 0.0 ? file.length_mm : found.regions.back().to_mm;
  text += "from   to     organs  parastichies (0 apex, 1 base)\n";
  for (const ParastichyRegion& region : found.regions) {
    text += fmt::format("{:.3f}  {:.3f}  {:<6}  ", region.from_mm / length_mm, region.to_mm / length_mm, region.organs);
    if (region.kind.series == ParastichySeries::kIrregular) {
      text += fmt::format("irregular, mostly {} and {}\n", region.m.number, region.n.number);
    } else {
      text += fmt::format("{} {}, {} {}: {}\n", region.m.number, turn_of(region.m.turn), region.n.number,
                          turn_of(region.n.turn), series_of(region.kind));
    }
  }
  return text;
}

}  // namespace

void ParastichyArguments::add_to(CLI::App& app) {
  app.add_option("--parastichies", outputs,
                 "Write the parastichies: .svg drawn, .csv a row a stretch of the surface, .json everything")
      ->type_name("FILE");
  app.add_option("--parastichy-organs", organs, "Write what was found about each organ, as .csv")->type_name("FILE");
  app.add_option("--parastichy-view", view, "Of the .svg: polar, or unrolled; polar if left out")->type_name("NAME");
}

void ParastichyArguments::check() const {
  check_outputs(outputs, kFormats, "--parastichies");
  if (!organs.empty()) {
    check_outputs({organs}, kOrganFormats, "--parastichy-organs");
  }
  if (view != "polar" && view != "unrolled") {
    throw usage("--parastichy-view must be polar or unrolled, got " + view);
  }
}

void ParastichyArguments::analyse(std::span<const PatternOrgan> pattern, const ParastichyOptions& options,
                                  const ParastichyFile& file, bool in_words, Report& report) const {
  const Parastichies found = report.time("parastichies", [&] { return analyse_parastichies(pattern, options); });
  report.values["parastichies"] = nlohmann::ordered_json::parse(parastichies_json(found, file)).at("parastichies");
  for (const Output& output : check_outputs(outputs, kFormats, "--parastichies")) {
    const ParastichyView drawn = view == "polar" ? ParastichyView::kPolar : ParastichyView::kUnrolled;
    write_output(report, output.path,
                 output.format == "svg"   ? parastichies_svg(found, pattern, drawn, file)
                 : output.format == "csv" ? parastichy_regions_csv(found, file)
                                          : parastichies_json(found, file));
  }
  if (!organs.empty()) {
    write_output(report, organs, parastichy_organs_csv(found, pattern, file));
  }
  if (in_words) {
    print(words(found, file));
  }
}

}  // namespace anthesis::cli
