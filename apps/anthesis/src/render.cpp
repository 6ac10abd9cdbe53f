#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "anthesis/base/parallel.h"
#include "growth.h"
#include "outputs.h"
#include "picture_options.h"

namespace anthesis::cli {
namespace {

constexpr std::array<std::string_view, 1> kFormats = {"png"};

struct Arguments {
  GrowthArguments growth;
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
std::string numbered(const std::string& path, int frame) {
  return fmt::format("{}_{:04d}.png", without_extension(path), frame);
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
  const Output output = check_outputs(arguments.outputs, kFormats).front();
  Photographer photographer(arguments.picture);

  const ThreadLimit threads(arguments.growth.threads);
  const Progress progress = console.progress();
  Report report;
  const Species species = report.time("species", [&] { return find_plant(arguments.growth.species); });
  const Development development = grow(arguments.growth, species, report, progress);
  describe_plant(development, arguments.at.value_or(1.0), report);

  const std::optional<std::size_t> kind =
      arguments.organ.empty() ? std::nullopt : std::optional(kind_named(species, arguments.organ));
  const auto photograph = [&](double time, double framed_time, const Progress& watch) {
    return report.time("render", [&] {
      return kind ? photographer.photograph(species, *kind, arguments.growth.detail, time, arguments.frames.has_value(),
                                            watch)
                  : photographer.photograph(development, time, framed_time, watch);
    });
  };
  const auto write = [&](const std::string& path, const Image& image, double time) {
    write_output(report, path, value_of(encode_png(image, provenance_texts(development, time))));
  };
  if (arguments.frames) {
    const int count = *arguments.frames;
    report.values["frames"] = count;
    std::vector<Image> images;
    for (int i = 0; i < count; ++i) {
      const double time = count > 1 ? static_cast<double>(i) / (count - 1) : 1.0;
      const std::string stage = fmt::format("picture {} of {}:", i + 1, count);
      const Progress watch = [&](std::string_view part, double fraction) {
        return progress(stage + ' ' + std::string(part), fraction);
      };
      images.push_back(photograph(time, 1.0, watch));
      if (!arguments.columns) {
        write(numbered(output.path, i), images.back(), time);
        images.clear();
      }
    }
    if (arguments.columns) {
      write(output.path, contact_sheet(images, std::min(*arguments.columns, count)), 1.0);
    }
  } else {
    const double time = arguments.at.value_or(1.0);
    write(output.path, photograph(time, time, progress), time);
  }
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
  arguments->growth.detail = 2.0;  // outlines show facets in a large picture that nobody sees in a model
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
  arguments->picture.add_to(*command);
  return {command, [arguments](Console& console) { run(*arguments, console); }};
}

}  // namespace anthesis::cli
