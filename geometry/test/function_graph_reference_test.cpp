// Function graphs against those of another program: drawn functions of published flower-head models and their values,
// as the Virtual Laboratory of Calgary evaluates them. Skipped where the reference data is absent.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "anthesis/geometry/function_graph.h"

namespace anthesis {
namespace {

std::filesystem::path reference() {
  const char* given = std::getenv("ANTHESIS_REFERENCE");
  return given != nullptr ? given : ANTHESIS_REFERENCE_DEFAULT;
}

/// The control points of each function of a gallery, repeated points written out.
std::vector<std::vector<Vec2>> read_gallery(const std::filesystem::path& path) {
  std::vector<std::vector<Vec2>> functions;
  std::ifstream file(path);
  std::string line;
  int left = 0;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    if (left > 0) {
      Vec2 point;
      int multiplicity = 1;
      words >> point.x >> point.y >> multiplicity;
      functions.back().insert(functions.back().end(), words.fail() && !words.eof() ? 1 : std::max(multiplicity, 1),
                              point);
      --left;
    } else if (line.starts_with("points:")) {
      std::string key;
      words >> key >> left;
      functions.emplace_back();
    }
  }
  return functions;
}

TEST(FunctionGraphReference, IsWhatTheVirtualLaboratoryEvaluates) {
  const std::filesystem::path heads = reference() / "heads";
  if (!std::filesystem::exists(heads)) {
    GTEST_SKIP() << "no reference data in " << reference() << "; set ANTHESIS_REFERENCE";
  }
  for (const char* head : {"bellis", "sunflower"}) {
    const auto functions = read_gallery(heads / head / "functions.fset");
    ASSERT_FALSE(functions.empty());
    std::vector<FunctionGraph> graphs;
    for (const std::vector<Vec2>& points : functions) {
      graphs.emplace_back(points);
    }
    std::ifstream values(heads / head / "evaluated" / "funcs.csv");
    std::string line;
    std::getline(values, line);
    std::size_t compared = 0;
    while (std::getline(values, line)) {
      std::size_t id = 0;
      double x = 0.0;
      double value = 0.0;
      ASSERT_EQ(std::sscanf(line.c_str(), "%zu,%lf,%lf", &id, &x, &value), 3) << line;
      // That program tabulates 1,000 samples, each found to 1e-5 in x: so much for steep places.
      ASSERT_NEAR(graphs.at(id - 1)(x), value, 5e-4) << head << " function " << id << " at " << x;
      ++compared;
    }
    EXPECT_EQ(compared, 2001 * functions.size());
  }
}

}  // namespace
}  // namespace anthesis
