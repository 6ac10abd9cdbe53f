#include "study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "anthesis/base/parallel.h"
#include "anthesis/base/version.h"
#include "anthesis/exchange/divergence_study.h"
#include "anthesis/exchange/meristem_figures.h"
#include "outputs.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 2> kFormats = {"svg", "csv"};
constexpr std::array<std::string_view, 1> kDrawings = {"svg"};
constexpr std::array<std::pair<std::string_view, MeristemFigure>, 3> kFigures = {
    {{"meristem-modes", MeristemFigure::kModes},
     {"self-similar", MeristemFigure::kSelfSimilar},
     {"hierarchy", MeristemFigure::kHierarchy}}};
constexpr Limits kSizeLimits = {0.02, 0.5};

/// "0.05:0.5:46": smallest, largest, how many, in equal ratios.
std::vector<double> parse_sizes(const std::string& text) {
  const std::size_t first = text.find(':');
  const std::size_t second = first == std::string::npos ? first : text.find(':', first + 1);
  if (second == std::string::npos) {
    throw usage("--sizes must be SMALLEST:LARGEST:COUNT, got " + text);
  }
  const double smallest = parse_number("--sizes smallest", text.substr(0, first), kSizeLimits);
  const double largest = parse_number("--sizes largest", text.substr(first + 1, second - first - 1), kSizeLimits);
  const std::uint64_t count = parse_whole("--sizes count", text.substr(second + 1), 2, 1000, text);
  if (largest < smallest) {
    throw usage("--sizes must run upwards, got " + text);
  }
  return DivergenceStudyParams::study_sizes(smallest, largest, count);
}

/// The figures of growing meristems.
void draw_meristems(const std::string& of, const std::vector<std::string>& paths, bool json) {
  const auto figure =
      std::find_if(kFigures.begin(), kFigures.end(), [&](const auto& known) { return known.first == of; });
  if (figure == kFigures.end()) {
    throw usage("--study must be divergence, meristem-modes, self-similar or hierarchy, got " + of);
  }
  const std::vector<Output> outputs = check_outputs(paths, kDrawings);
  if (outputs.empty()) {
    throw usage("say where to draw: -o figure.svg");
  }
  Report report;
  for (const Output& output : outputs) {
    write_output(report, output.path, value_of(meristem_figure_svg(figure->second)));
  }
  if (json) {
    report.values["version"] = kVersion;
    print(report.text());
  }
}

}  // namespace

void StudyArguments::add_to(CLI::App& app) {
  app.add_option("--study", of,
                 "divergence: models compared over organ sizes; drawings: meristem-modes, self-similar, hierarchy")
      ->type_name("NAME");
  app.add_option("--sizes", sizes,
                 "SMALLEST:LARGEST:COUNT of the study, diameters over circumferences; 0.05:0.5:46 if left out")
      ->type_name("RANGE");
}

void run_study(const StudyArguments& arguments, const std::vector<std::string>& paths, int threads, bool json,
               Console& console) {
  if (arguments.of != "divergence") {
    return draw_meristems(arguments.of, paths, json);
  }
  const std::vector<Output> outputs = check_outputs(paths, kFormats);
  DivergenceStudyParams params;
  params.sizes = parse_sizes(arguments.sizes);
  const ThreadLimit limit(threads);
  const Progress progress = console.progress();
  Report report;
  const DivergenceStudy study = report.time("study", [&] { return value_of(study_divergence(params, progress)); });
  for (const Output& output : outputs) {
    write_output(report, output.path,
                 output.format == "csv"
                     ? divergence_study_csv(study)
                     : divergence_study_svg(study, "Divergence and parastichies against the size of organs",
                                            fmt::format("Anthesis {}", kVersion)));
  }
  if (json) {
    report.values["version"] = kVersion;
    report.values["sizes"] = params.sizes.size();
    print(report.text());
  } else if (outputs.empty()) {
    print(divergence_study_csv(study));
  }
}

}  // namespace anthesis::cli
