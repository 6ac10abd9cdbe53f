#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <vector>

#include "anthesis/base/version.h"
#include "arguments.h"

namespace anthesis::cli {
namespace {

/// Help with the examples first: they are what people look for.
class HelpText : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::Sub) {
      return make_expanded(app);
    }
    return make_description(app) + "\nExamples:\n" + make_footer(app) + '\n' + make_usage(app, std::move(name)) +
           make_positionals(app) + make_groups(app, mode) + make_subcommands(app, mode);
  }
};

std::string hint(std::string_view word, const std::vector<std::string>& known) {
  const std::vector<std::string_view> names(known.begin(), known.end());
  const std::string_view near = nearest_name(word, names.data(), names.size());
  return near.empty() ? "" : "; did you mean " + std::string(near) + "?";
}

std::vector<std::string> flags_of(const CLI::App& app) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return o->nonpositional(); })) {
    for (const std::string& name : option->get_lnames()) {
      flags.push_back("--" + name);
    }
  }
  return flags;
}

/// Arguments that the command does not know.
void refuse_extras(const CLI::App& command) {
  const std::vector<std::string> extras = command.remaining();
  if (extras.empty()) {
    return;
  }
  for (const std::string& extra : extras) {
    if (extra.starts_with('-')) {
      const std::string flag = extra.substr(0, extra.find('='));
      throw usage(flag + " is not a flag of anthesis " + command.get_name() + hint(flag, flags_of(command)));
    }
  }
  throw usage("anthesis " + command.get_name() + " has no use for " + extras.front());
}

void run(int argc, char** argv, Console& console) {
  CLI::App app("Grows flowers: from a species file to an animated 3D flower.", "anthesis");
  app.formatter(std::make_shared<HelpText>());
  app.set_version_flag("--version", std::string("anthesis ") + kVersion, "Print the version");
  app.footer(
      "  anthesis grow sunflower -o sunflower.glb\n"
      "  anthesis render sunflower -o sunflower.png --view side\n"
      "  anthesis species");
  app.get_formatter()->column_width(28);
  const std::array<Command, 7> commands = {add_grow(app),  add_pattern(app), add_render(app),     add_species(app),
                                           add_check(app), add_import(app),  add_vasculature(app)};
  app.require_subcommand(1);

  if (argc > 1 && argv[1][0] != '-') {
    std::vector<std::string> names;
    for (const Command& command : commands) {
      names.push_back(command.app->get_name());
    }
    if (std::find(names.begin(), names.end(), argv[1]) == names.end()) {
      throw usage(std::string("there is no command ") + argv[1] + hint(argv[1], names) +
                  " (anthesis --help lists them)");
    }
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForVersion& version) {
    return print(std::string(version.what()) + '\n');
  } catch (const CLI::CallForHelp&) {
    for (const Command& command : commands) {
      if (command.app->parsed()) {
        return print(command.app->help("anthesis"));
      }
    }
    return print(app.help());
  } catch (const CLI::ParseError& error) {
    throw usage(argc < 2
                    ? "say what to do, such as: anthesis grow sunflower -o sunflower.glb (anthesis --help tells more)"
                    : std::string(error.what()));
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) {
      refuse_extras(*command.app);
      return command.run(console);
    }
  }
}

}  // namespace
}  // namespace anthesis::cli

int main(int argc, char** argv) {
  using namespace anthesis::cli;
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is a failed write, not a reason to die
  Console console;
  try {
    run(argc, argv, console);
    return kDone;
  } catch (const Answer& answer) {
    return answer.status;
  } catch (const Failure& failure) {
    console.say("anthesis: " + failure.message);
    return failure.status;
  } catch (const std::bad_alloc&) {
    console.say("anthesis: not enough memory");
    return kSystemFailed;
  } catch (const std::exception& error) {  // the library throws nothing; this is a mistake of ours or of a library
    console.say(std::string("anthesis: internal error: ") + error.what());
    return kMistake;
  }
}
