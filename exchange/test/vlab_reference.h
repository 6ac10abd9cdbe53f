#pragma once
// Files of the Virtual Laboratory to test against. They belong to others and are no part of this project: tests find
// them through ANTHESIS_REFERENCE and skip visibly without them.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "anthesis/base/file.h"

namespace anthesis::test {

inline std::filesystem::path reference() {
  const char* given = std::getenv("ANTHESIS_REFERENCE");
  return given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT;
}

inline std::string bytes_of(const std::filesystem::path& path) {
  Expected<std::string> bytes = read_file(path.string(), std::size_t{1} << 30);
  EXPECT_TRUE(bytes.has_value()) << path;
  return bytes ? *bytes : std::string();
}

inline std::string reference_file(const std::string& path) {
  return bytes_of(reference() / path);
}

/// Every reference file that the readers are for, in order.
inline std::vector<std::filesystem::path> reference_files() {
  std::vector<std::filesystem::path> paths;
  for (const char* folder : {"heads", "vlab"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(reference() / folder)) {
      const std::filesystem::path kind = entry.path().extension();
      if (entry.is_regular_file() && kind != ".csv" && kind != ".png") {
        paths.push_back(entry.path());
      }
    }
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Rows of numbers of a CSV file with a line of names.
inline std::vector<std::vector<double>> reference_table(const std::string& path) {
  const std::string text = reference_file(path);
  std::vector<std::vector<double>> rows;
  for (std::size_t at = text.find('\n') + 1; at < text.size();) {
    std::vector<double>& row = rows.emplace_back();
    for (;;) {
      double value = 0.0;
      const auto read = std::from_chars(text.data() + at, text.data() + text.size(), value);
      row.push_back(value);
      at = static_cast<std::size_t>(read.ptr - text.data()) + 1;
      if (read.ptr == text.data() + text.size() || *read.ptr == '\n') {
        break;
      }
    }
  }
  return rows;
}

}  // namespace anthesis::test

/// Ends a test that needs the reference data where there is none.
#define ANTHESIS_NEEDS_REFERENCE()                                                                        \
  if (!std::filesystem::exists(anthesis::test::reference() / "vlab")) {                                   \
    GTEST_SKIP() << "no reference data in " << anthesis::test::reference() << "; set ANTHESIS_REFERENCE"; \
  }
