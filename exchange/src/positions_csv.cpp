#include "anthesis/exchange/positions_csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "anthesis/base/file.h"

namespace anthesis {
namespace {

constexpr std::size_t kMostBytes = std::size_t{64} << 20;
constexpr std::size_t kMostRows = 1'000'000;

/// A part of a line and where it begins, 1-based.
struct Field {
  std::string_view text;
  std::size_t column = 1;
};

std::vector<Field> fields_of(std::string_view line) {
  std::vector<Field> fields;
  const bool by_space = line.find_first_of(",;\t") == std::string_view::npos;
  std::size_t at = 0;
  while (at <= line.size()) {
    if (by_space) {
      at = std::min(line.find_first_not_of(' ', at), line.size());
      if (at == line.size()) {
        break;
      }
    }
    const std::size_t end = std::min(line.find_first_of(by_space ? " " : ",;\t", at), line.size());
    std::string_view text = line.substr(at, end - at);
    while (!text.empty() && (text.front() == ' ' || text.front() == '"')) {
      text.remove_prefix(1);
    }
    while (!text.empty() && (text.back() == ' ' || text.back() == '"')) {
      text.remove_suffix(1);
    }
    fields.push_back({text, at + 1});
    at = end + 1;
  }
  return fields;
}

Error refuse(std::string_view file, std::size_t line, std::size_t column, std::string message) {
  std::string where(file);
  where += ':';
  where += std::to_string(line);
  where += ':';
  where += std::to_string(column);
  where += ':';
  return Error{ErrorCode::kParse, std::move(where), std::move(message)};
}

std::string shown(std::string_view text) {
  std::string result;
  for (const char c : text.substr(0, 40)) {
    result += static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f ? '?' : c;
  }
  return result;
}

}  // namespace

Expected<std::vector<Vec3>> read_positions(std::string_view text, std::string_view file_name) {
  if (text.size() > kMostBytes) {
    return unexpected(
        Error{ErrorCode::kTooLarge, std::string(file_name),
              "must be at most " + std::to_string(kMostBytes) + " bytes, got " + std::to_string(text.size())});
  }
  if (text.substr(0, 3) == "\xEF\xBB\xBF") {
    text.remove_prefix(3);
  }
  constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
  std::array<std::size_t, 3> column_of{};
  bool named = false;
  std::vector<Vec3> positions;
  std::size_t line_number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++line_number;
    if (!line.empty() && line.back() == '\r') {
      line.remove_suffix(1);
    }
    if (line.find_first_not_of(" \t,;") == std::string_view::npos || line.front() == '#') {
      continue;
    }
    const std::vector<Field> fields = fields_of(line);
    if (!named) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& field) {
          return field.text.substr(0, 1) == kAxes[axis] && (field.text.size() == 1 || field.text.substr(1) == "_mm");
        });
        if (found == fields.end()) {
          return unexpected(refuse(file_name, line_number, 1, "must name the columns x, y and z, got " + shown(line)));
        }
        column_of[axis] = static_cast<std::size_t>(found - fields.begin());
      }
      named = true;
      continue;
    }
    if (positions.size() == kMostRows) {
      return unexpected(Error{ErrorCode::kTooLarge, std::string(file_name),
                              "must have at most " + std::to_string(kMostRows) + " rows, got more"});
    }
    std::array<double, 3> values{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (column_of[axis] >= fields.size()) {
        return unexpected(refuse(file_name, line_number, line.size() + 1,
                                 "must have a field for " + std::string(kAxes[axis]) + ", got " +
                                     std::to_string(fields.size()) + " fields"));
      }
      const Field& field = fields[column_of[axis]];
      const char* const last = field.text.data() + field.text.size();
      const auto read = std::from_chars(field.text.data(), last, values[axis]);
      if (read.ec != std::errc() || read.ptr != last || !std::isfinite(values[axis])) {
        return unexpected(
            refuse(file_name, line_number, field.column,
                   "must be a finite number for " + std::string(kAxes[axis]) + ", got " + shown(field.text)));
      }
    }
    positions.push_back({values[0], values[1], values[2]});
  }
  if (!named) {
    return unexpected(refuse(file_name, 1, 1, "must name the columns x, y and z, got nothing"));
  }
  return positions;
}

Expected<std::vector<Vec3>> load_positions(const std::string& path) {
  return read_file(path, kMostBytes).and_then([&](const std::string& text) { return read_positions(text, path); });
}

}  // namespace anthesis
