#include "arguments.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace anthesis::cli {
namespace {

std::string rule(const Limits& limits) {
  return std::string("must be in ") + (limits.open_min ? '(' : '[') + to_text(limits.min) + ", " + to_text(limits.max) +
         (limits.open_max ? ')' : ']');
}

Failure refusal(std::string_view name, const std::string& rule_text, std::string_view text) {
  constexpr std::size_t kMostShown = 40;
  return usage(std::string(name) + ' ' + rule_text + ", got " + std::string(text.substr(0, kMostShown)));
}

std::string range_note(const std::string& help, const std::string& low, const std::string& high) {
  return help + " [" + low + " to " + high + "]";
}

template <class Number>
CLI::Option* add_parsed(CLI::App& app, const std::string& flag, std::string help, const std::string& shown_default,
                        Number parse_and_set) {
  if (!shown_default.empty()) {
    help += ", " + shown_default + " if left out";
  }
  // The last of several counts, as in most programs, so that an alias can be overridden.
  return app.add_option_function<std::string>(flag, std::move(parse_and_set), help)
      ->type_name("N")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

std::string long_name(const std::string& flag) {
  return flag.substr(flag.rfind("--"));
}

}  // namespace

double parse_number(std::string_view name, std::string_view text, const Limits& limits) {
  double value = 0.0;
  std::string_view digits = text;
  if (digits.starts_with('+')) {
    digits.remove_prefix(1);
  }
  const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole_text = result.ec == std::errc() && result.ptr == digits.data() + digits.size();
  const bool allowed = (limits.open_min ? value > limits.min : value >= limits.min) &&
                       (limits.open_max ? value < limits.max : value <= limits.max);  // false for NaN
  if (!whole_text || !allowed) {
    throw refusal(name, rule(limits), text);
  }
  return value;
}

std::uint64_t parse_whole(std::string_view name, std::string_view text, std::uint64_t min, std::uint64_t max) {
  return parse_whole(name, text, min, max, text);
}

std::uint64_t parse_whole(std::string_view name, std::string_view text, std::uint64_t min, std::uint64_t max,
                          std::string_view typed) {
  std::uint64_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size() || value < min || value > max) {
    throw refusal(name, "must be a whole number in [" + std::to_string(min) + ", " + std::to_string(max) + "]", typed);
  }
  return value;
}

std::size_t parse_word(std::string_view flag, std::string_view word, std::span<const std::string_view> words) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) {
    return static_cast<std::size_t>(found - words.begin());
  }
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    list += i == 0 ? "" : i + 1 == words.size() ? " or " : ", ";
    list += words[i];
  }
  throw usage(fmt::format("{} must be {}, got {}", flag, list, word));
}

CLI::Option* add_number(CLI::App& app, const std::string& flag, double& value, const Limits& limits, std::string help) {
  return add_parsed(app, flag,
                    range_note(help, (limits.open_min ? "above " : "") + to_text(limits.min),
                               (limits.open_max ? "below " : "") + to_text(limits.max)),
                    to_text(value), [&value, limits, name = long_name(flag)](const std::string& text) {
                      value = parse_number(name, text, limits);
                    });
}

CLI::Option* add_number(CLI::App& app, const std::string& flag, std::optional<double>& value, const Limits& limits,
                        std::string help) {
  return add_parsed(app, flag,
                    range_note(help, (limits.open_min ? "above " : "") + to_text(limits.min),
                               (limits.open_max ? "below " : "") + to_text(limits.max)),
                    "", [&value, limits, name = long_name(flag)](const std::string& text) {
                      value = parse_number(name, text, limits);
                    });
}

CLI::Option* add_whole(CLI::App& app, const std::string& flag, std::uint64_t& value, std::uint64_t min,
                       std::uint64_t max, std::string help) {
  return add_parsed(app, flag, range_note(help, std::to_string(min), std::to_string(max)), std::to_string(value),
                    [&value, min, max, name = long_name(flag)](const std::string& text) {
                      value = parse_whole(name, text, min, max);
                    });
}

CLI::Option* add_whole(CLI::App& app, const std::string& flag, std::optional<int>& value, int min, int max,
                       std::string help) {
  return add_parsed(app, flag, range_note(help, std::to_string(min), std::to_string(max)), "",
                    [&value, min, max, name = long_name(flag)](const std::string& text) {
                      value = static_cast<int>(
                          parse_whole(name, text, static_cast<std::uint64_t>(min), static_cast<std::uint64_t>(max)));
                    });
}

CLI::Option* add_whole(CLI::App& app, const std::string& flag, int& value, int min, int max, std::string help) {
  return add_parsed(app, flag, range_note(help, std::to_string(min), std::to_string(max)), std::to_string(value),
                    [&value, min, max, name = long_name(flag)](const std::string& text) {
                      value = static_cast<int>(
                          parse_whole(name, text, static_cast<std::uint64_t>(min), static_cast<std::uint64_t>(max)));
                    });
}

void GrowthArguments::add_to(CLI::App& app, bool species_required) {
  app.add_option("SPECIES", species, "A built-in species (`anthesis species` lists them) or a species file")
      ->required(species_required)
      ->type_name("");
  add_whole(app, "--seed", seed, 0, std::numeric_limits<std::uint64_t>::max(), "Which individual of the species");
  add_number(app, "--detail", detail, {0.0, 8.0, true, false}, "Factor of the number of triangles along and across");
  add_whole(app, "--threads", threads, 0, 1024, "Threads to use, 0 for all; results do not depend on it");
  app.add_flag("--json", json, "Print one JSON object that says what was made");
}

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& what, const std::string& examples) {
  CLI::App* command = app.add_subcommand(name, what);
  command->footer(examples);  // HelpText in main.cpp puts them first
  command->allow_extras();    // main.cpp refuses them, with the nearest flag
  return command;
}

}  // namespace anthesis::cli
