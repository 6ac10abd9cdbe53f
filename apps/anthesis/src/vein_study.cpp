#include "vein_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/version.h"
#include "anthesis/exchange/species_key.h"
#include "anthesis/render/caption.h"
#include "anthesis/vasculature/vein_measures.h"
#include "vein_figures.h"

namespace anthesis::cli {
namespace {

constexpr std::size_t kMostRuns = 1000;
constexpr double kSpare = 1e-9;  // of a step: 0:1:0.1 has eleven values
constexpr std::string_view kSeed = "seed";

/// Which value of each variation the run takes.
std::vector<std::size_t> places_of(std::size_t run, const std::vector<Variation>& variations) {
  std::vector<std::size_t> places(variations.size());
  for (std::size_t v = variations.size(); v-- > 0;) {
    places[v] = run % variations[v].values.size();
    run /= variations[v].values.size();
  }
  return places;
}

}  // namespace

Variation parse_variation(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t first = text.find(':', equals == std::string::npos ? 0 : equals);
  const std::size_t second = first == std::string::npos ? first : text.find(':', first + 1);
  if (equals == std::string::npos || equals == 0 || second == std::string::npos) {
    throw usage("--vary must be KEY=FROM:TO:STEP or KEY=xFROM:TO:STEP, got " + text);
  }
  const bool factor = text.compare(equals + 1, 1, "x") == 0;
  const auto number = [&](std::size_t from, std::size_t to) {
    return parse_number("--vary " + text.substr(0, equals), text.substr(from, to == std::string::npos ? to : to - from),
                        {-1e9, 1e9});
  };
  const double from = number(equals + (factor ? 2 : 1), first);
  const double to = number(first + 1, second);
  const double step = number(second + 1, std::string::npos);
  if (!(step > 0.0) || to < from) {
    throw usage("--vary must go up from FROM to TO by a STEP > 0, got " + text);
  }
  const double count = std::floor((to - from) / step + kSpare) + 1.0;
  if (count > static_cast<double>(kMostRuns)) {
    throw usage(fmt::format("--vary must give at most {} values, got {}", kMostRuns, text));
  }
  Variation variation{text.substr(0, equals), {}, factor};
  for (int i = 0; i < static_cast<int>(count); ++i) {
    variation.values.push_back(std::round((from + i * step) * 1e12) / 1e12);  // 0.3, not 0.30000000000000004
  }
  const auto is_seed = [](double v) { return v >= 0.0 && v == std::floor(v); };
  if (variation.key == kSeed && (factor || !std::all_of(variation.values.begin(), variation.values.end(), is_seed))) {
    throw usage("--vary seed must give whole numbers, got " + text);
  }
  return variation;
}

void run_study(const HeadArguments& arguments, const std::vector<std::string>& texts, double at,
               const VeinPictureOptions& picture, std::optional<int> columns, const std::vector<Output>& outputs,
               bool json, Console& console) {
  std::vector<Variation> variations;
  std::size_t runs = 1;
  for (const std::string& text : texts) {
    variations.push_back(parse_variation(text));
    for (std::size_t v = 0; v + 1 < variations.size(); ++v) {
      if (whole_key(variations[v].key) == whole_key(variations.back().key)) {
        throw usage("--vary must name different numbers, got " + variations.back().key + " twice");
      }
    }
    runs *= variations.back().values.size();
    if (runs > kMostRuns) {
      throw usage(fmt::format("--vary must give at most {} heads together", kMostRuns));
    }
  }
  const bool pictures = std::any_of(outputs.begin(), outputs.end(), [](const Output& o) { return o.format == "png"; });
  const VeinPhotographer photographer(picture);
  if (pictures) {
    photographer.check_sheet(runs);
  }
  const Progress progress = console.progress();
  Report report;
  const Species species = report.time("species", [&] { return find_head(arguments); });
  std::vector<Species> heads;  // all are checked before the first is grown
  std::vector<HeadArguments> all_arguments(runs, arguments);
  for (std::size_t run = 0; run < runs; ++run) {
    Species& head = heads.emplace_back(species);
    const std::vector<std::size_t> places = places_of(run, variations);
    for (std::size_t v = 0; v < variations.size(); ++v) {
      const double value = variations[v].values[places[v]];
      if (variations[v].key == kSeed) {
        all_arguments[run].seed = static_cast<std::uint64_t>(value);
      } else {
        set(head, "--vary", {variations[v].key, value, variations[v].factor});
      }
    }
    if (auto error = check(head)) {
      throw usage("--vary: " + to_string(*error));
    }
    go_on(progress, "species", static_cast<double>(run + 1) / static_cast<double>(runs));
  }
  HeadExtent extent;  // of all heads, so that the pictures of a sheet can be compared
  for (std::size_t run = 0; pictures && run < runs; ++run) {
    const ContourSequence contours =
        report.time("contours", [&] { return value_of(head_contours(heads[run], arguments.rules())); });
    extent = together(extent, anthesis::extent_of(outline_of(contours, frame_at(contours, at))));
  }
  std::string table;
  std::vector<Image> images;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  MadeFrom lines;
  for (std::size_t run = 0; run < runs; ++run) {
    const std::string stage = fmt::format("head {} of {}: ", run + 1, runs);
    const Progress watch = [&](std::string_view part, double fraction) {
      return progress(stage + std::string(part), fraction);
    };
    const GrownHead grown = grow_head(all_arguments[run], heads[run], {at}, report, watch);
    const VasculatureMeasures measures = report.time("measures", [&] { return measure(grown.moments.back().veins); });
    const std::vector<std::size_t> places = places_of(run, variations);
    std::string header;
    std::string row;
    std::string caption;
    nlohmann::ordered_json object;
    for (std::size_t v = 0; v < variations.size(); ++v) {
      const std::string value = to_text(variations[v].values[places[v]]);
      header += (v == 0 ? "" : ",") + variations[v].name();
      row += (v == 0 ? "" : ",") + value;
      caption += (v == 0 ? "" : "\n") + variations[v].key + (variations[v].factor ? " x " : " = ") + value;
      object[variations[v].name()] = variations[v].values[places[v]];
    }
    for (const auto& [key, value] : figures_of(grown.moments.back().veins, grown.primordia, measures)) {
      header += "," + key;
      row += "," + value;
      object[key] = nlohmann::ordered_json::parse(value, nullptr, false);
    }
    if (run == 0) {
      lines = made_from(arguments, species, grown.moments.back());
      for (std::size_t v = 0; v < variations.size(); ++v) {
        lines.push_back({"vary", texts[v]});
        std::erase_if(lines, [&](const auto& line) { return line.first == kSeed && variations[v].key == kSeed; });
      }
      table = fmt::format("# generator: Anthesis {}\n", kVersion);
      for (const auto& [key, value] : lines) {
        table += fmt::format("# {}: {}\n", key, value);
      }
      table += header + "\n";
    }
    table += row + "\n";
    rows.push_back(std::move(object));
    if (pictures) {
      images.push_back(
          report.time("render", [&] { return photographer.photograph(grown, grown.moments.back(), extent, watch); }));
      write_caption(images.back(), caption);
    }
  }
  for (const Output& output : outputs) {
    if (output.format == "png") {
      const int across = columns.value_or(static_cast<int>(variations.back().values.size()));
      const Image sheet = contact_sheet(images, std::min<int>(across, static_cast<int>(images.size())));
      write_output(report, output.path, value_of(encode_png(sheet, png_texts(lines))));
    } else {
      write_output(report, output.path, table);
    }
  }
  report.values["species"] = species.name;
  report.values["seed"] = arguments.seed;
  report.values["version"] = kVersion;
  report.values["heads"] = std::move(rows);
  if (json) {
    print(report.text());
  } else if (outputs.empty()) {
    print(table);
  }
}

}  // namespace anthesis::cli
