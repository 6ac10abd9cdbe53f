#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "anthesis/base/sha256.h"

namespace anthesis::cli {
namespace {

volatile std::sig_atomic_t stop_asked = 0;

void ask_to_stop(int) {
  stop_asked = 1;
}

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

std::string duration(double seconds) {
  return seconds < 90.0 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60.0);
}

}  // namespace

Failure usage(std::string message) {
  return {kUsage, std::move(message)};
}

Failure failure(const Error& error) {
  return {exit_code(error.code), error.code == ErrorCode::kCancelled ? "stopped" : to_string(error)};
}

void go_on(const Progress& progress, std::string_view stage, double fraction) {
  if (!report(progress, stage, fraction)) {
    throw failure({ErrorCode::kCancelled, "", "cancelled"});
  }
}

Console::Console() : on_terminal_(::isatty(STDERR_FILENO) == 1) {
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);  // the second Ctrl-C does not wait for anything
  ::sigaction(SIGINT, &action, nullptr);
}

Console::~Console() {
  clear();
}

Progress Console::progress() {
  return [this](std::string_view stage, double fraction) {
    if (on_terminal_) {
      draw(stage, fraction);
    }
    return stop_asked == 0;
  };
}

void Console::say(std::string_view line) {
  clear();
  std::fputs((std::string(line) + '\n').c_str(), stderr);
}

void Console::draw(std::string_view stage, double fraction) {
  constexpr double kPatience = 0.3;  // seconds: what is quicker needs no line
  constexpr double kFrame = 0.1;
  constexpr double kGuessAfter = 1.0;
  constexpr double kLately = 15.0;  // what the guess is made from: plants get slower as they grow
  const Clock::time_point now = Clock::now();
  const double share = std::clamp(fraction, 0.0, 1.0);
  if (stage != stage_) {
    stage_ = stage;
    stage_began_ = now;
    marks_ = {Mark{now, share}, Mark{now, share}};  // a stage that is resumed does not begin at 0
  }
  if (seconds_between(marks_[1].time, now) > kLately) {
    marks_ = {marks_[1], Mark{now, share}};
  }
  const double taken = seconds_between(stage_began_, now);
  if (taken < kPatience || seconds_between(last_drawn_, now) < kFrame) {
    return;
  }
  last_drawn_ = now;
  drawn_ = true;
  std::string line = fmt::format("\r\033[K{} {:.0f} %", stage_, 100.0 * share);
  const double gained = share - marks_[0].share;
  const double lately = seconds_between(marks_[0].time, now);
  if (lately > kGuessAfter && gained > 1e-3) {
    line += ", " + duration(lately * (1.0 - share) / gained) + " left";
  }
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

void Console::clear() {
  if (drawn_) {
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
    drawn_ = false;
  }
}

void Report::add_time(const char* stage, Clock::time_point began) {
  auto& seconds = seconds_[stage];
  seconds = (seconds.is_null() ? 0.0 : seconds.get<double>()) + seconds_between(began, Clock::now());
}

void Report::add_output(const std::string& path, std::string_view bytes) {
  add_hashed_output(path, sha256(bytes));
}

void Report::add_hashed_output(const std::string& path, const std::string& sha256_digits) {
  outputs_.push_back({{"path", path}, {"sha256", sha256_digits}});
}

std::string Report::text() const {
  nlohmann::ordered_json result = values;
  result["seconds"] = seconds_;
  result["seconds"]["total"] = seconds_between(began_, Clock::now());
  result["outputs"] = outputs_;
  // A path may hold any bytes; JSON holds text.
  return result.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw failure({ErrorCode::kIo, "standard output:", std::string("cannot write: ") + std::strerror(errno)});
  }
}

}  // namespace anthesis::cli
