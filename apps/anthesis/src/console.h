#pragma once
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"

namespace anthesis::cli {

/// Exit statuses; those of errors in data come from exit_code(ErrorCode).
inline constexpr int kDone = 0;
inline constexpr int kUsage = 2;
inline constexpr int kMistake = 70;       // EX_SOFTWARE of sysexits.h
inline constexpr int kSystemFailed = 71;  // EX_OSERR

/// Why a command stops: the exit status, and the sentence that follows "anthesis: ".
struct Failure {
  int status = kUsage;
  std::string message;
};

Failure usage(std::string message);
Failure failure(const Error& error);

/// Reports progress; throws the Failure of being stopped if the user asked for that.
void go_on(const Progress& progress, std::string_view stage, double fraction);

/// Standard error for people: one line of progress that is rewritten, only if it is a terminal; and Ctrl-C.
class Console {
 public:
  Console();
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  bool on_terminal() const { return on_terminal_; }

  /// For the library's long stages. Answers "stop" after Ctrl-C; a second Ctrl-C ends the program at once.
  Progress progress();

  /// A line on standard error; progress makes way for it.
  void say(std::string_view line);

 private:
  using Clock = std::chrono::steady_clock;

  /// How far a stage had come at a time.
  struct Mark {
    Clock::time_point time;
    double share = 0.0;
  };

  void draw(std::string_view stage, double fraction);
  void clear();

  bool on_terminal_ = false;
  bool drawn_ = false;
  std::string stage_;
  Clock::time_point stage_began_ = Clock::now();
  std::array<Mark, 2> marks_;  ///< older first: how fast the stage has been of late
  Clock::time_point last_drawn_ = Clock::now();
};

/// What --json prints: one object. Also measures how long each stage takes.
class Report {
 public:
  nlohmann::ordered_json values = nlohmann::ordered_json::object();

  /// Runs `work`, and adds the time it took to `stage`.
  template <class Work>
  auto time(const char* stage, Work&& work) {
    const Clock::time_point began = Clock::now();
    if constexpr (std::is_void_v<decltype(work())>) {
      std::forward<Work>(work)();
      add_time(stage, began);
    } else {
      auto result = std::forward<Work>(work)();
      add_time(stage, began);
      return result;
    }
  }

  void add_output(const std::string& path, std::string_view bytes);
  void add_hashed_output(const std::string& path, const std::string& sha256_digits);

  /// The object with `seconds` and `outputs`, as one line.
  std::string text() const;

 private:
  using Clock = std::chrono::steady_clock;

  void add_time(const char* stage, Clock::time_point began);

  Clock::time_point began_ = Clock::now();
  nlohmann::ordered_json seconds_ = nlohmann::ordered_json::object();
  nlohmann::ordered_json outputs_ = nlohmann::ordered_json::array();
};

/// Writes to standard output and sees that it arrived.
void print(std::string_view text);

}  // namespace anthesis::cli
