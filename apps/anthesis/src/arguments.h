#pragma once
#include <CLI/App.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "console.h"

namespace anthesis::cli {

/// The range of a number on the command line.
struct Limits {
  double min = 0.0;
  double max = 0.0;
  bool open_min = false;  ///< min itself is refused
  bool open_max = false;  ///< max itself is refused
};

/// The number that `text` states. Throws a Failure of usage: "--at must be in [0, 1], got 7".
double parse_number(std::string_view name, std::string_view text, const Limits& limits);
std::uint64_t parse_whole(std::string_view name, std::string_view text, std::uint64_t min, std::uint64_t max);
/// The same for a part of what was typed; the message shows all of it.
std::uint64_t parse_whole(std::string_view name, std::string_view part, std::uint64_t min, std::uint64_t max,
                          std::string_view typed);

/// Which of `words` was given. Throws a Failure of usage: "--cut must be whole, half or slice, got thin".
std::size_t parse_word(std::string_view flag, std::string_view word, std::span<const std::string_view> words);

/// A flag that takes a number: checked while it is read, and shown with its default in the help.
CLI::Option* add_number(CLI::App& app, const std::string& flag, double& value, const Limits& limits, std::string help);
CLI::Option* add_number(CLI::App& app, const std::string& flag, std::optional<double>& value, const Limits& limits,
                        std::string help);
CLI::Option* add_whole(CLI::App& app, const std::string& flag, std::uint64_t& value, std::uint64_t min,
                       std::uint64_t max, std::string help);
CLI::Option* add_whole(CLI::App& app, const std::string& flag, std::optional<int>& value, int min, int max,
                       std::string help);
CLI::Option* add_whole(CLI::App& app, const std::string& flag, int& value, int min, int max, std::string help);

/// An answer that is an exit status other than kDone, and no failure: thrown by a command when all else is printed.
struct Answer {
  int status = kDone;
};

/// One command of the program. `run` is called after the arguments are read; it throws a Failure if it cannot go on.
struct Command {
  CLI::App* app = nullptr;
  std::function<void(Console&)> run;
};

/// Flags that all commands share which grow a plant.
struct GrowthArguments {
  std::string species;
  std::uint64_t seed = 1;
  int threads = 0;
  double detail = 1.0;
  bool json = false;

  void add_to(CLI::App& app, bool species_required);
};

/// A command with its examples, which --help shows first.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& what, const std::string& examples);

/// `result`, or its error thrown as a Failure.
template <class T>
T value_of(Expected<T> result) {
  if (!result) {
    throw failure(result.error());
  }
  return std::move(*result);
}

// One for each file of the same name.
Command add_check(CLI::App& app);
Command add_grow(CLI::App& app);
Command add_import(CLI::App& app);
Command add_pattern(CLI::App& app);
Command add_render(CLI::App& app);
Command add_species(CLI::App& app);
Command add_vasculature(CLI::App& app);

}  // namespace anthesis::cli
