#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "anthesis/base/parallel.h"
#include "collision_options.h"
#include "growth.h"
#include "outputs.h"
#include "picture_options.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 1> kFormats = {"png"};
constexpr double kCollisionDetail = 1.0;

struct Arguments {
  GrowthArguments growth;
  CollisionArguments collisions;
  PictureOptions picture;
  std::vector<std::string> outputs;
  std::optional<double> at;
  std::optional<int> frames;
  std::optional<int> columns;
  std::string organ;
};

/// Index of the kind of organ that --organ names.
std::size_t kind_named(const Species& species, const std::string& name) {
  std::string known;
  for (std::size_t i = 0; i < species.organs.size(); ++i) {
    if (species.organs[i].name == name) {
      return i;
    }
    known += (i == 0 ? "" : i + 1 == species.organs.size() ? " or " : ", ") + species.organs[i].name;
  }
  throw usage("--organ must be " + known + ", got " + name);
}

/// The file of one of several pictures: flower_0012.png.
std::string numbered(const std::string& path, std::size_t frame) {
  return fmt::format("{}_{:04d}.png", without_extension(path), frame);
}

/// The picture at the i-th time.
using Take = std::function<Image(std::size_t i, const Progress& progress)>;

/// Takes the pictures and writes them as the flags say.
void write_pictures(const Arguments& arguments, const std::vector<double>& times, const Take& take,
                    const std::function<std::vector<PngText>(double time)>& texts, Report& report,
                    const Progress& progress) {
  const std::string& path = arguments.outputs.front();
  std::vector<Image> images;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const std::string stage = arguments.frames ? fmt::format("picture {} of {}: ", i + 1, times.size()) : "";
    const Progress watch = [&](std::string_view part, double fraction) {
      return progress(stage + std::string(part), fraction);
    };
    images.push_back(report.time("render", [&] { return take(i, watch); }));
    if (!arguments.columns) {
      write_output(report, arguments.frames ? numbered(path, i) : path,
                   value_of(encode_png(images.back(), texts(times[i]))));
      images.clear();
    }
  }
  if (arguments.columns) {
    const Image sheet = contact_sheet(images, std::min(*arguments.columns, *arguments.frames));
    write_output(report, path, value_of(encode_png(sheet, texts(times.back()))));
  }
}

void run(const Arguments& arguments, Console& console) {
  if (arguments.outputs.size() != 1) {
    throw usage("say where to write one picture: -o flower.png");
  }
  if (arguments.at && arguments.frames) {
    throw usage("--at is for one time and --frames for several: give one of them");
  }
  if (arguments.columns && !arguments.frames) {
    throw usage("--columns is for the pictures of --frames: give both");
  }
  check_outputs(arguments.outputs, kFormats);
  const Photographer photographer(arguments.picture);
  if (arguments.columns) {
    photographer.check_sheet(static_cast<std::size_t>(*arguments.frames));
  }

  const ThreadLimit threads(arguments.growth.threads);
  const Progress progress = console.progress();
  Report report;
  const Species species = report.time("species", [&] { return find_plant(arguments.growth.species); });
  const bool resolving = arguments.organ.empty() && arguments.collisions.wanted(species);
  arguments.collisions.check(resolving);
  const Development drawn = grow(arguments.growth, species, report, progress);
  describe_plant(drawn, arguments.at.value_or(1.0), report);
  const std::vector<double> times =
      arguments.frames ? even_times(*arguments.frames) : std::vector<double>{arguments.at.value_or(1.0)};
  report.values["frames"] = times.size();
  const auto texts = [&](double time) { return provenance_texts(drawn, time, resolving); };

  if (!arguments.organ.empty()) {
    const std::size_t kind = kind_named(species, arguments.organ);
    const auto take = [&](std::size_t i, const Progress& watch) {
      return photographer.photograph(species, kind, arguments.growth.detail, times[i], arguments.frames.has_value(),
                                     watch);
    };
    write_pictures(arguments, times, take, texts, report, progress);
  } else {
    // Touching is found at a lower level of detail than is drawn: its cost grows faster than what is seen of it.
    std::optional<Development> touching;
    if (resolving && arguments.growth.detail > kCollisionDetail) {
      GrowthArguments coarser = arguments.growth;
      coarser.detail = kCollisionDetail;
      touching.emplace(grow(coarser, species, report, progress));
    }
    const Development& development = touching ? *touching : drawn;
    const std::vector<Canopy> canopies = resolving ? resolve(development, times, arguments.collisions, report, progress)
                                                   : canopies_at(development, times);
    const auto pose = [&](const Canopy& canopy) {
      return photographer.pose(development, canopy, touching ? &drawn : nullptr);
    };
    // A flower may be taller while it opens than when it is open: some twelve moments must fit, the last among them.
    const Scene framed = report.time("render", [&] {
      Scene moments = pose(canopies.back());
      const std::size_t step = std::max<std::size_t>(1, canopies.size() / 12);
      for (std::size_t i = 0; i + 1 < canopies.size(); i += step) {
        add_to(moments, pose(canopies[i]));
      }
      return moments;
    });
    const auto take = [&](std::size_t i, const Progress& watch) {
      return photographer.photograph(pose(canopies[i]), framed, watch);
    };
    write_pictures(arguments, times, take, texts, report, progress);
  }
  arguments.collisions.forget();
  if (arguments.growth.json) {
    print(report.text());
  }
}

}  // namespace

Command add_render(CLI::App& app) {
  CLI::App* command = add_command(app, "render", "Take a picture of a plant",
                                  "  anthesis render sunflower -o sunflower.png\n"
                                  "  anthesis render daisy -o top.png --view top --size 600 --quality draft\n"
                                  "  anthesis render sunflower -o opening.png --frames 21   (opening_0000.png ...)\n"
                                  "  anthesis render daisy -o sheet.png --frames 21 --columns 7 --size 300\n"
                                  "  anthesis render daisy -o floret.png --organ disk_floret --at 0.6 --view side");
  auto arguments = std::make_shared<Arguments>();
  add_outputs(*command, arguments->outputs, kFormats);
  arguments->growth.detail = kPictureDetail;
  arguments->growth.add_to(*command, true);
  add_number(*command, "--at", arguments->at, {0.0, 1.0}, "Time of development: 0 bud, 1 bloom; 1 if left out");
  add_whole(*command, "--frames", arguments->frames, 1, 1000,
            "Take so many pictures over the development, in files x_0000.png, x_0001.png ...");
  add_whole(*command, "--columns", arguments->columns, 1, 100,
            "Put the pictures of --frames into one, so many in a row");
  command
      ->add_option("--organ", arguments->organ,
                   "One kind of organ alone, as the species file states it; --at and --frames are then its stages")
      ->type_name("NAME");
  arguments->collisions.add_to(*command, ", at detail 1 at most");
  arguments->picture.add_to(*command);
  return {command, [arguments](Console& console) { run(*arguments, console); }};
}

}  // namespace anthesis::cli
