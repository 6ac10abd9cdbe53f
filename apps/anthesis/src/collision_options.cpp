#include "collision_options.h"

namespace anthesis::cli {

void CollisionArguments::add_to(CLI::App& app, const std::string& note) {
  app.add_flag_callback(
      "--no-collisions", [this] { resolve = false; }, "Let organs pass through one another: quick, for a first look");
  app.add_flag_callback(
         "--collisions", [this] { resolve = true; },
         "Keep organs apart also where the species lets them run into one another")
      ->excludes("--no-collisions");
  add_whole(app, "--collision-steps", steps, 1, 10000, "Steps in which organs grow and give way" + note);
  app.add_option("--checkpoint", checkpoint, "Folder to save the work on collisions in, until all files are written")
      ->type_name("DIR");
  app.add_flag("--resume", resume, "Go on from what the folder of --checkpoint holds, if anything");
}

void CollisionArguments::check(bool resolving) const {
  if (resume && checkpoint.empty()) {
    throw usage("--resume goes on from a --checkpoint: give its folder");
  }
  if (!checkpoint.empty() && !resolving) {
    throw usage("--checkpoint is for the work on collisions, and this command does none");
  }
}

void CollisionArguments::forget() const {
  if (!checkpoint.empty()) {
    remove_checkpoint(checkpoint);
  }
}

std::vector<Canopy> resolve(const Development& development, std::span<const double> times,
                            const CollisionArguments& arguments, Report& report, const Progress& progress) {
  CollisionOptions options;
  options.steps = arguments.steps;
  options.checkpoint = arguments.checkpoint;
  options.resume = arguments.resume;
  Expected<AccommodatedDevelopment> result =
      report.time("collisions", [&] { return resolve_collisions(development, times, options, progress); });
  if (!result && result.error().where == "checkpoint") {  // a run is in the folder: the command lacks --resume
    throw usage("--" + to_string(result.error()));
  }
  if (!result && result.error().code == ErrorCode::kCancelled && !arguments.checkpoint.empty()) {
    throw Failure{exit_code(ErrorCode::kCancelled), "stopped; the same command with --resume goes on"};
  }
  AccommodatedDevelopment resolved = value_of(std::move(result));
  report.values["crossings"] = 0;  // or resolve_collisions had failed
  report.values["collisions"] = {{"steps", resolved.report.steps},
                                 {"passes", resolved.report.passes},
                                 {"contacts", resolved.report.contacts},
                                 {"residual_mm", resolved.report.residual_mm}};
  return std::move(resolved.frames);
}

std::vector<Canopy> canopies_at(const Development& development, std::span<const double> times) {
  std::vector<Canopy> canopies;
  canopies.reserve(times.size());
  for (const double time : times) {
    canopies.push_back(development.at(time));
  }
  return canopies;
}

std::vector<double> even_times(int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    times.push_back(count > 1 ? static_cast<double>(i) / (count - 1) : 1.0);
  }
  return times;
}

}  // namespace anthesis::cli
