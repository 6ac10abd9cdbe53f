#include "disc.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/version.h"
#include "anthesis/exchange/svg.h"
#include "anthesis/fate/cone.h"
#include "anthesis/phyllotaxis/vogel.h"
#include "outputs.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 2> kDiscFormats = {"csv", "svg"};
constexpr std::uint64_t kMostFlorets = 1'000'000;
constexpr std::uint64_t kMostSteps = 100'000;
constexpr Limits kConeLimits = {0.0, 180.0, true, true};

struct Disc {
  std::vector<Vec2> florets_mm;
  std::vector<bool> rays;
};

Disc disc_of(std::size_t count, double divergence_deg, double cone_deg) {
  Disc disc;
  disc.florets_mm.resize(count);
  place_spiral({.spacing_mm = 1.0, .divergence_rad = math::radians(divergence_deg)}, disc.florets_mm);
  for (const double room : nearest_in_cone_mm(disc.florets_mm, {}, math::radians(cone_deg))) {
    disc.rays.push_back(std::isinf(room));
  }
  return disc;
}

std::size_t rays_of(std::size_t count, double divergence_deg, double cone_deg) {
  std::vector<Vec2> florets_mm(count);
  place_spiral({.spacing_mm = 1.0, .divergence_rad = math::radians(divergence_deg)}, florets_mm);
  return count_with_room(florets_mm, {}, math::radians(cone_deg));
}

std::string made_by(const std::string& settings) {
  return fmt::format("Anthesis {}, {}", kVersion, settings);
}

std::string disc_csv(const Disc& disc, const std::string& settings) {
  std::string text = "# " + made_by(settings) + "\nid,kind,x_mm,y_mm\n";
  for (std::size_t i = 0; i < disc.florets_mm.size(); ++i) {
    text += fmt::format("{},{},{},{}\n", i + 1, disc.rays[i] ? "ray_floret" : "disk_floret",
                        to_text(disc.florets_mm[i].x), to_text(disc.florets_mm[i].y));
  }
  return text;
}

std::string disc_svg(const Disc& disc, const std::string& settings) {
  Plan plan;
  plan.title = "Ray florets by the cone rule";
  plan.caption = made_by(settings);
  plan.kinds = {"disk_floret", "ray_floret"};
  for (std::size_t i = 0; i < disc.florets_mm.size(); ++i) {
    PlanDisc floret;
    floret.centre_mm = disc.florets_mm[i];
    floret.id = static_cast<std::uint32_t>(i + 1);
    floret.kind = disc.rays[i] ? 1 : 0;
    plan.discs.push_back(floret);
  }
  return plan_svg(plan);
}

void run_florets(const DiscArguments& arguments, const DiscJob& job, const std::vector<Output>& outputs) {
  Report report;
  const auto count = static_cast<std::size_t>(*arguments.vogel);
  const std::string settings = fmt::format("Vogel disc of {} florets, divergence {} degrees, cone {} degrees", count,
                                           to_text(arguments.divergence_deg), to_text(arguments.cone_deg));
  const Disc disc =
      report.time("pattern", [&] { return disc_of(count, arguments.divergence_deg, arguments.cone_deg); });
  const auto rays = static_cast<std::size_t>(std::count(disc.rays.begin(), disc.rays.end(), true));
  for (const Output& output : outputs) {
    write_output(report, output.path, output.format == "csv" ? disc_csv(disc, settings) : disc_svg(disc, settings));
  }
  if (job.json) {
    report.values = {{"version", kVersion},
                     {"organs", {{"ray_floret", rays}, {"disk_floret", count - rays}}},
                     {"divergence_deg", arguments.divergence_deg},
                     {"cone_deg", arguments.cone_deg}};
    print(report.text());
  } else {
    print(fmt::format("{} ray florets, {} disk florets\n", rays, count - rays));
  }
}

/// "cone-deg=20:89:0.5"
struct Sweep {
  bool of_cone = true;
  std::vector<double> values;
};

Sweep parse_sweep(const std::string& text) {
  const std::string form = "--sweep must be cone-deg=FROM:TO:STEP or organs=FROM:TO:STEP, got " + text;
  const std::size_t equals = text.find('=');
  const std::size_t first = text.find(':', equals == std::string::npos ? text.size() : equals);
  const std::size_t second = text.find(':', first == std::string::npos ? text.size() : first + 1);
  if (second == std::string::npos) {
    throw usage(form);
  }
  const std::string name = text.substr(0, equals);
  if (name != "cone-deg" && name != "organs") {
    throw usage(form);
  }
  Sweep sweep;
  sweep.of_cone = name == "cone-deg";
  const Limits limits = sweep.of_cone ? kConeLimits : Limits{1.0, static_cast<double>(kMostFlorets)};
  const std::string label = "--sweep " + name;
  const double from = parse_number(label, text.substr(equals + 1, first - equals - 1), limits);
  const double to = parse_number(label, text.substr(first + 1, second - first - 1), limits);
  const double step = parse_number(label + " step", text.substr(second + 1), {sweep.of_cone ? 1e-6 : 1.0, 1e6});
  if (to < from) {
    throw usage(label + " must run upwards, got " + text);
  }
  // The last value counts although (to - from) / step may come out a rounding below a whole number.
  const double steps = std::floor((to - from) / step + 1e-9);
  if (steps >= static_cast<double>(kMostSteps)) {
    throw usage(fmt::format("{} must have at most {} steps, got {}", label, kMostSteps, text));
  }
  for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i) {
    const double value = from + static_cast<double>(i) * step;
    if (!sweep.of_cone && value != std::floor(value)) {
      throw usage(label + " must be whole numbers, got " + text);
    }
    sweep.values.push_back(value);
  }
  return sweep;
}

void run_sweep(const DiscArguments& arguments, const DiscJob& job, const std::vector<Output>& outputs,
               Console& console) {
  const Sweep sweep = parse_sweep(arguments.sweep);
  if (sweep.of_cone && !arguments.vogel) {
    throw usage("--sweep cone-deg needs the number of florets: --vogel N");
  }
  const ThreadLimit threads(job.threads);
  const Progress progress = console.progress();
  Report report;
  std::vector<Vec2> points(sweep.values.size());
  const bool whole = report.time("sweep", [&] {
    return parallel_for(
        points.size(),
        [&](std::size_t i) {
          const double value = sweep.values[i];
          const std::size_t rays =
              sweep.of_cone ? rays_of(static_cast<std::size_t>(*arguments.vogel), arguments.divergence_deg, value)
                            : rays_of(static_cast<std::size_t>(value), arguments.divergence_deg, arguments.cone_deg);
          points[i] = {value, static_cast<double>(rays)};
        },
        progress, "sweep");
  });
  if (!whole) {
    throw failure({ErrorCode::kCancelled, "", ""});
  }

  const std::string constant = sweep.of_cone ? fmt::format("{} florets", *arguments.vogel)
                                             : fmt::format("cone {} degrees", to_text(arguments.cone_deg));
  const std::string settings =
      fmt::format("Vogel disc, {}, divergence {} degrees", constant, to_text(arguments.divergence_deg));
  std::string table = fmt::format("# {}\n{},ray_florets\n", made_by(settings), sweep.of_cone ? "cone_deg" : "organs");
  double most = 0.0;
  for (const Vec2 point : points) {
    table += to_text(point.x) + ',' + to_text(point.y) + '\n';
    most = std::max(most, point.y);
  }
  for (const Output& output : outputs) {
    if (output.format == "csv") {
      write_output(report, output.path, table);
      continue;
    }
    StepPlot plot;
    plot.title = "Ray florets by the cone rule";
    plot.caption = made_by(settings);
    plot.x_label = sweep.of_cone ? "half angle of the cone, degrees" : "florets";
    plot.y_label = "ray florets";
    plot.points = points;
    plot.guides = fibonacci_guides(most);
    write_output(report, output.path, step_plot_svg(plot));
  }
  if (job.json) {
    report.values = {{"version", kVersion}, {"divergence_deg", arguments.divergence_deg}};
    report.values[sweep.of_cone ? "vogel" : "cone_deg"] =
        sweep.of_cone ? static_cast<double>(*arguments.vogel) : arguments.cone_deg;
    print(report.text());
  } else if (outputs.empty()) {
    print(table);
  }
}

}  // namespace

void DiscArguments::add_to(CLI::App& app) {
  add_whole(app, "--vogel", vogel, 1, static_cast<int>(kMostFlorets),
            "A flat disc of so many florets, in place of a species");
  add_number(app, "--divergence-deg", divergence_deg, {-360.0, 360.0, true, true}, "Angle between florets of the disc");
  add_number(app, "--cone-deg", cone_deg, kConeLimits, "Half angle of the cone that a ray floret has to itself");
  app.add_option("--sweep", sweep, "Count rays over a range: cone-deg=20:89:0.5 or organs=20:400:1")
      ->type_name("RANGE");
}

void run_disc(const DiscArguments& arguments, const DiscJob& job, Console& console) {
  const std::vector<Output> outputs = check_outputs(job.outputs, kDiscFormats);
  if (arguments.sweep.empty()) {
    return run_florets(arguments, job, outputs);
  }
  run_sweep(arguments, job, outputs, console);
}

}  // namespace anthesis::cli
