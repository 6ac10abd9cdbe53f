#include "anthesis/exchange/vlab_function.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/exchange/vlab_contour.h"
#include "text.h"
#include "vlab_text.h"

namespace anthesis {
namespace {

using detail::append_fixed;
using detail::TextPlace;
using detail::VlabText;

constexpr std::int64_t kMostPoints = 10'000;
constexpr std::size_t kLongestName = 100;  // VLab's buffer holds 127 characters
constexpr int kDefaultSamples = 1000;

bool read_points(VlabText& text, VlabFunction& function) {
  const TextPlace place = text.place();
  std::int64_t count = 0;
  if (!text.expect("points:") || !text.whole("points", count, 4, kMostPoints) || !text.end_line()) {
    return false;
  }
  std::int64_t sum = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    VlabFunctionPoint point;
    std::int64_t multiplicity = 1;
    if (!text.number("x", point.position.x) || !text.number("y", point.position.y) ||
        (!text.next_is("") && !text.whole("multiplicity", multiplicity, 1, kMostPoints)) || !text.end_line()) {
      return false;
    }
    point.multiplicity = static_cast<int>(multiplicity);
    function.points.push_back(point);
    sum += multiplicity;
  }
  return sum <= kMostPoints ||
         text.fail_at(place, "points", "must be at most 10000 with their multiplicities, got " + std::to_string(sum));
}

/// From "fver" on.
bool read_function(VlabText& text, VlabFunction& function) {
  std::int64_t version = 0;
  std::int64_t samples = 0;
  if (!text.expect("fver") || !text.whole("version", version, 1, 1) || !text.whole("version", version, 1, 1) ||
      !text.end_line() || !text.expect("name:")) {
    return false;
  }
  function.name = text.rest_of_line();
  if (!text.expect("samples:") || !text.whole("samples", samples, 1, 1'000'000) || !text.end_line()) {
    return false;
  }
  function.samples = static_cast<int>(samples);
  if (text.next_is("background:")) {
    text.take_word();
    function.background = text.rest_of_line();
    if (!text.expect("backgroundXY:") || !text.number("backgroundXY", function.background_offset.x) ||
        !text.number("backgroundXY", function.background_offset.y) || !text.end_line()) {
      return false;
    }
  }
  if (!text.expect("flip:")) {
    return false;
  }
  if (!text.next_is("on") && !text.next_is("off")) {
    return text.fail("flip", "must be on or off");
  }
  function.flipped = text.take_word() == "on";
  return text.end_line() && read_points(text, function);
}

bool read_functions(VlabText& text, std::vector<VlabFunction>& functions) {
  if (text.next_is("funcgalleryver")) {
    std::int64_t version = 0;
    std::int64_t items = 0;
    text.take_word();
    if (!text.whole("version", version, 1, 1) || !text.whole("version", version, 1, 1) || !text.end_line() ||
        !text.expect("items:") || !text.whole("items", items, 0, 1'000'000) || !text.end_line()) {
      return false;
    }
    for (std::int64_t i = 0; i < items; ++i) {
      if (!read_function(text, functions.emplace_back())) {
        return false;
      }
    }
    return text.expect_end();
  }
  VlabFunction& function = functions.emplace_back();
  if (text.next_is("range:")) {  // the oldest format: no name, no samples
    double first = 0.0;
    double last = 0.0;
    text.take_word();
    return text.number("range", first, 0.0, 0.0) && text.number("range", last, 1.0, 1.0) && text.end_line() &&
           read_points(text, function) && text.expect_end();
  }
  return read_function(text, function) && text.expect_end();
}

bool read_timed_function(VlabText& text, VlabTimedFunction& timed) {
  if (!text.expect("start:") || !text.number("start", timed.start) || !text.end_line() || !text.expect("end:")) {
    return false;
  }
  const TextPlace place = text.place();
  if (!text.number("end", timed.end) || !text.end_line()) {
    return false;
  }
  if (!(timed.end > timed.start)) {
    return text.fail_at(place, "end",
                        "must be after the start " + to_text(timed.start) + ", got " + to_text(timed.end));
  }
  if (!text.expect("name:")) {
    return false;
  }
  timed.name = text.rest_of_line();
  const auto optional_text = [&text](std::string_view key, std::string& value) {
    if (text.next_is(key)) {
      text.take_word();
      value = text.rest_of_line();
    }
  };
  optional_text("color:", timed.color);
  optional_text("startLabel:", timed.start_label);
  optional_text("endLabel:", timed.end_label);
  return text.expect("timelineFunceditFileStart:") && text.end_line() && read_function(text, timed.function) &&
         text.expect("timelineFunceditFileEnd:") && text.end_line();
}

bool read_timeline(VlabText& text, std::vector<VlabTimedFunction>& timeline) {
  std::int64_t version = 0;
  std::int64_t items = 0;
  if (!text.expect("timeEdit") || !text.whole("version", version, 1, 1) || !text.whole("version", version, 2, 2) ||
      !text.end_line() || !text.expect("items:") || !text.whole("items", items, 0, 1'000'000) || !text.end_line()) {
    return false;
  }
  for (std::int64_t i = 0; i < items; ++i) {
    if (!read_timed_function(text, timeline.emplace_back())) {
      return false;
    }
  }
  return text.expect_end();
}

void append_function(std::string& text, const VlabFunction& function) {
  detail::append(text, "fver 1 1\nname: ", function.name,
                 "\nsamples: ", function.samples > 0 ? function.samples : kDefaultSamples, "\n");
  if (!function.background.empty()) {
    detail::append(text, "background: ", function.background, "\nbackgroundXY: ");
    append_fixed(text, function.background_offset.x);
    text += ' ';
    append_fixed(text, function.background_offset.y);
    text += '\n';
  }
  detail::append(text, "flip: ", function.flipped ? "on" : "off", "\npoints: ", function.points.size(), "\n");
  for (const VlabFunctionPoint& point : function.points) {
    append_fixed(text, point.position.x);
    text += ' ';
    append_fixed(text, point.position.y);
    detail::append(text, " ", point.multiplicity, "\n");
  }
}

std::optional<Error> check_writable(const VlabFunction& function) {
  for (const std::string& line : {function.name, function.background}) {
    if (line.size() > kLongestName || detail::one_line(line) != line) {
      return invalid_parameter("name", "must be one line of at most 100 characters", detail::shown_value(line));
    }
  }
  return check(function);
}

}  // namespace

double VlabTimedFunction::x_at(double time) const {
  const double x = (time - start) / (end - start);
  return x > 0.0 ? std::min(x, 1.0) : 0.0;
}

std::optional<Error> check(const VlabFunction& function) {
  if (function.points.size() < 4) {
    return invalid_parameter(function.name + ".points", "must be at least 4",
                             static_cast<double>(function.points.size()));
  }
  std::int64_t sum = 0;
  for (const VlabFunctionPoint& point : function.points) {
    if (point.multiplicity < 1 || point.multiplicity > kMostPoints) {
      return invalid_parameter(function.name + ".multiplicity", "must be between 1 and 10000", point.multiplicity);
    }
    sum += point.multiplicity;
    for (const double value : {point.position.x, point.position.y}) {
      if (!(std::abs(value) <= 1e30)) {
        return invalid_parameter(function.name + ".points", "must be between -1e+30 and 1e+30", value);
      }
    }
  }
  if (sum > kMostPoints) {
    return invalid_parameter(function.name + ".points", "must be at most 10000 with their multiplicities",
                             static_cast<double>(sum));
  }
  return std::nullopt;
}

Expected<std::vector<VlabFunction>> read_vlab_functions(std::string_view text, std::string_view file_name) {
  VlabText reader(text, file_name);
  std::vector<VlabFunction> functions;
  if (!reader.fits(kVlabTextLimit) || !read_functions(reader, functions)) {
    return unexpected(reader.error);
  }
  return functions;
}

Expected<std::vector<VlabTimedFunction>> read_vlab_timeline(std::string_view text, std::string_view file_name) {
  VlabText reader(text, file_name);
  std::vector<VlabTimedFunction> timeline;
  if (!reader.fits(kVlabTextLimit) || !read_timeline(reader, timeline)) {
    return unexpected(reader.error);
  }
  return timeline;
}

Expected<std::string> write_vlab_function(const VlabFunction& function) {
  if (auto error = check_writable(function)) {
    return unexpected(*error);
  }
  std::string text;
  append_function(text, function);
  return text;
}

Expected<std::string> write_vlab_functions(const std::vector<VlabFunction>& functions) {
  std::string text;
  detail::append(text, "funcgalleryver 1 1\nitems: ", functions.size(), "\n");
  for (const VlabFunction& function : functions) {
    if (auto error = check_writable(function)) {
      return unexpected(*error);
    }
    append_function(text, function);
  }
  return text;
}

std::vector<Vec2> vlab_controls(const VlabFunction& function) {
  std::vector<Vec2> controls;
  for (const VlabFunctionPoint& point : function.points) {
    controls.insert(controls.end(), static_cast<std::size_t>(std::max(point.multiplicity, 0)), point.position);
  }
  return controls;
}

Expected<FunctionGraph> vlab_graph(const VlabFunction& function) {
  if (auto error = check(function)) {
    return unexpected(*error);
  }
  std::vector<Vec2> controls = vlab_controls(function);
  if (auto error = check_function(function.name + ".points", controls)) {
    return unexpected(*error);
  }
  return FunctionGraph(std::move(controls));
}

VlabFunctionTable::VlabFunctionTable(const VlabFunction& function) {
  ANTHESIS_ASSERT(!check(function));
  const BSplineCurve<Vec2> curve{3, vlab_controls(function)};
  const int samples = std::clamp(function.samples == 0 ? kDefaultSamples : function.samples, 10, 1000);
  const double near_enough = 0.01 / samples;
  values_.reserve(static_cast<std::size_t>(samples));
  for (int i = 0; i < samples; ++i) {
    const double x = static_cast<double>(i) / (samples - 1);
    double low = 0.0;
    double high = 1.0;
    Vec2 point;
    for (int step = 0; step < 60; ++step) {  // jumps in x are never met: halve until nothing is left
      const double middle = 0.5 * (low + high);
      point = curve.at(middle);
      if (std::abs(point.x - x) <= near_enough) {
        break;
      }
      (point.x < x ? low : high) = middle;
    }
    values_.push_back(point.y);
  }
}

double VlabFunctionTable::operator()(double x) const {
  const double place = (x > 0.0 ? std::min(x, 1.0) : 0.0) * static_cast<double>(values_.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), values_.size() - 2);
  return std::lerp(values_[i], values_[i + 1], place - static_cast<double>(i));
}

}  // namespace anthesis
