#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "anthesis/base/parallel.h"
#include "anthesis/base/version.h"
#include "anthesis/contact/crossings.h"
#include "anthesis/exchange/mesh_file.h"
#include "arguments.h"

namespace anthesis::cli {
namespace {

constexpr int kCrossingsFound = 1;  // an answer, not a failure

struct Arguments {
  std::string file;
  std::optional<int> frame;
  std::uint64_t max_pairs = 20;
  int threads = 0;
  bool json = false;
};

/// One side of a crossing.
struct Side {
  std::string part;
  std::uint32_t triangle = 0;
};

struct FoundPair {
  std::size_t frame = 0;
  Side first;
  Side second;
  Vec3 place_mm;
};

struct Found {
  std::uint64_t crossings = 0;
  std::uint64_t degenerate = 0;
  std::size_t frames_with_crossings = 0;
  std::vector<FoundPair> pairs;
};

void check_frame(const CheckedMesh& mesh, std::size_t frame, const Arguments& arguments, const Progress& progress,
                 Found& found) {
  const MeshPose pose = mesh.pose(frame);
  // What is scaled to nothing is not there: organs before their birth.
  const std::span<const std::uint32_t> part_of = mesh.part_of_triangle();
  std::vector<std::uint32_t> numbers;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < mesh.triangles().size(); ++i) {
    if (pose.shown[part_of[i]] != 0) {
      numbers.push_back(i);
      triangles.push_back(mesh.triangles()[i]);
    }
  }
  Expected<CrossingReport> result =
      find_crossings(pose.positions, triangles, arguments.max_pairs - found.pairs.size(), progress);
  if (!result) {
    Error& error = result.error();
    error.where = fmt::format("{}: frame {}:{}{}", arguments.file, frame, error.where.empty() ? "" : " ", error.where);
  }
  const CrossingReport report = value_of(std::move(result));
  found.crossings += report.count;
  found.degenerate += report.degenerate;
  found.frames_with_crossings += report.count > 0 ? 1 : 0;
  const Vec3 mm = mesh.mm_per_unit();
  const auto side = [&](std::uint32_t triangle) {
    return Side{mesh.parts()[part_of[numbers[triangle]]], numbers[triangle]};
  };
  for (const Crossing& crossing : report.crossings) {
    const Vec3 place = crossing.place_mm;
    found.pairs.push_back(
        {frame, side(crossing.first), side(crossing.second), Vec3{place.x * mm.x, place.y * mm.y, place.z * mm.z}});
  }
}

std::string plural(std::uint64_t count, std::string_view thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

/// To a ten-thousandth, and 0 for -0.
double shown_mm(double value) {
  return std::round(value * 1e4) / 1e4 + 0.0;
}

std::string as_text(const Found& found, std::size_t frames) {
  std::string text;
  for (const FoundPair& pair : found.pairs) {
    text += fmt::format("frame {}: {} triangle {} and {} triangle {} at ({}, {}, {}) mm\n", pair.frame, pair.first.part,
                        pair.first.triangle, pair.second.part, pair.second.triangle, shown_mm(pair.place_mm.x),
                        shown_mm(pair.place_mm.y), shown_mm(pair.place_mm.z));
  }
  if (found.crossings > found.pairs.size()) {
    text += fmt::format("and {} more\n", found.crossings - found.pairs.size());
  }
  return text + fmt::format("{} in {}\n", plural(found.crossings, "crossing"), plural(frames, "frame"));
}

void run(const Arguments& arguments, Console& console) {
  const ThreadLimit threads(arguments.threads);
  const Progress progress = console.progress();
  Report report;
  const CheckedMesh mesh = value_of(report.time("read", [&] { return load_mesh(arguments.file); }));
  const std::size_t frames = mesh.times_s().size();
  if (arguments.frame && static_cast<std::size_t>(*arguments.frame) >= frames) {
    throw usage(fmt::format("--frame must be below the number of frames, {}, got {}", frames, *arguments.frame));
  }
  const std::size_t first = arguments.frame ? static_cast<std::size_t>(*arguments.frame) : 0;
  const std::size_t last = arguments.frame ? first + 1 : frames;

  Found found;
  report.time("check", [&] {
    for (std::size_t frame = first; frame < last; ++frame) {
      // The bar shows all frames, not each.
      const Progress of_frame = [&](std::string_view stage, double fraction) {
        return progress(stage, (static_cast<double>(frame - first) + fraction) / static_cast<double>(last - first));
      };
      check_frame(mesh, frame, arguments, of_frame, found);
    }
    return 0;
  });

  if (arguments.json) {
    const auto side = [](const Side& s) { return nlohmann::ordered_json{{"part", s.part}, {"triangle", s.triangle}}; };
    nlohmann::ordered_json pairs = nlohmann::ordered_json::array();
    for (const FoundPair& pair : found.pairs) {
      pairs.push_back({{"frame", pair.frame},
                       {"first", side(pair.first)},
                       {"second", side(pair.second)},
                       {"place_mm", {pair.place_mm.x, pair.place_mm.y, pair.place_mm.z}}});
    }
    report.values["file"] = arguments.file;
    report.values["version"] = kVersion;
    report.values["frames"] = last - first;
    report.values["triangles"] = mesh.triangles().size();
    report.values["crossings"] = found.crossings;
    report.values["pairs"] = std::move(pairs);
    report.values["degenerate"] = found.degenerate;
    print(report.text());
  } else {
    print(as_text(found, last - first));
  }
  if (found.crossings > 0) {
    throw Answer{kCrossingsFound};
  }
}

}  // namespace

Command add_check(CLI::App& app) {
  CLI::App* command =
      add_command(app, "check", "Find triangles that cross in a .glb or .ply file; exit status 1 if there are any",
                  "  anthesis check flower.glb\n"
                  "  anthesis check flower.glb --frame 12 --max-pairs 100\n"
                  "  anthesis check flower.ply --json");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->file, "A mesh in a .glb or .ply file")->required()->type_name("");
  add_whole(*command, "--frame", arguments->frame, 0, static_cast<int>(kMeshFrameLimit) - 1,
            "One key frame of an animation, the first is 0; all if left out");
  add_whole(*command, "--max-pairs", arguments->max_pairs, 0, 1'000'000, "List so many pairs at most");
  add_whole(*command, "--threads", arguments->threads, 0, 1024,
            "Threads to use, 0 for all; results do not depend on it");
  command->add_flag("--json", arguments->json, "Print one JSON object");
  return {command, [arguments](Console& console) { run(*arguments, console); }};
}

}  // namespace anthesis::cli
