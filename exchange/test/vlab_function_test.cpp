#include "anthesis/exchange/vlab_function.h"

#include <gmock/gmock.h>

#include <cmath>

#include "vlab_reference.h"

namespace anthesis {
namespace {

constexpr const char* kRise =
    "fver 1 1\n"
    "name: rise and rest\n"
    "samples: 100\n"
    "background: scan.png\n"
    "backgroundXY: 0 0.5\n"
    "flip: on\n"
    "points: 4\n"
    "0 0.25\n"
    "0.25 1 2\n"
    "0.75 1\n"
    "1 0.5 1\n";

std::string error_of(const std::string& text) {
  const auto functions = read_vlab_functions(text, "a.func");
  return functions ? "no error" : to_string(functions.error());
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ReadVlabFunctions, KeepsEverythingTheFileSays) {
  const auto read = read_vlab_functions(kRise, "a.func");
  ASSERT_TRUE(read.has_value()) << to_string(read.error());
  const VlabFunction& function = read->front();
  EXPECT_EQ(function.name, "rise and rest");
  EXPECT_EQ(function.samples, 100);
  EXPECT_TRUE(function.flipped);
  EXPECT_EQ(function.background, "scan.png");
  EXPECT_EQ(vlab_controls(function),
            (std::vector<Vec2>{{0.0, 0.25}, {0.25, 1.0}, {0.25, 1.0}, {0.75, 1.0}, {1.0, 0.5}}));
  const auto old = read_vlab_functions("range: 0.0 1.0\npoints: 4\n0 1\n0.3 2\n0.6 3\n1 4\n", "a.func");
  ASSERT_TRUE(old.has_value()) << to_string(old.error());
  EXPECT_EQ(old->front().samples, 0);
}

TEST(ReadVlabFunctions, SaysWhereWhatAndWhy) {
  EXPECT_EQ(error_of(replaced(kRise, "0.75 1\n", "0.75 z\n")), "a.func:10:6: y must be a number, got \"z\"");
  EXPECT_EQ(error_of(replaced(kRise, "0.75 1\n", "0.75 1 0\n")),
            "a.func:10:8: multiplicity must be a whole number from 1 to 10000, got \"0\"");
  EXPECT_EQ(error_of(replaced(kRise, "points: 4", "points: 3")),
            "a.func:7:9: points must be a whole number from 4 to 10000, got \"3\"");
  EXPECT_EQ(error_of(replaced(kRise, "points: 4", "points: 5")),
            "a.func:12:1: x must be a number, got the end of the file");
  EXPECT_EQ(error_of(replaced(kRise, "flip: on", "flip: up")), "a.func:6:7: flip must be on or off, got \"up\"");
  EXPECT_EQ(error_of(kRise + std::string("\n \n0.5 0.5\n")), "a.func:14:1: file must end here, got \"0.5\"");
}

TEST(ReadVlabTimeline, MapsTimeToTheFunction) {
  const std::string text =
      "timeEdit 1 2\nitems: 1\nstart: 2\nend: 6\nname: LEAF\ncolor: 1,2,3\nstartLabel: \n"
      "endLabel: END\ntimelineFunceditFileStart:\n" +
      std::string(kRise) + "timelineFunceditFileEnd:\n";
  const auto read = read_vlab_timeline(text, "a.tset");
  ASSERT_TRUE(read.has_value()) << to_string(read.error());
  ASSERT_EQ(read->size(), 1u);
  const VlabTimedFunction& leaf = read->front();
  EXPECT_EQ(leaf.name, "LEAF");
  EXPECT_EQ(leaf.end_label, "END");
  EXPECT_EQ(leaf.x_at(1.0), 0.0);
  EXPECT_EQ(leaf.x_at(3.0), 0.25);
  EXPECT_EQ(leaf.x_at(9.0), 1.0);
  const auto wrong = read_vlab_timeline(replaced(text, "end: 6", "end: 2"), "a.tset");
  ASSERT_FALSE(wrong.has_value());
  EXPECT_EQ(to_string(wrong.error()), "a.tset:4:6: end must be after the start 2, got 2");
}

TEST(WriteVlabFunctions, ReadBackAsTheSame) {
  const auto functions = read_vlab_functions(kRise, "a.func");
  ASSERT_TRUE(functions.has_value());
  const Expected<std::string> one = write_vlab_function(functions->front());
  ASSERT_TRUE(one.has_value()) << to_string(one.error());
  EXPECT_EQ(*write_vlab_function(read_vlab_functions(*one, "b.func")->front()), *one);
  const Expected<std::string> two = write_vlab_functions({functions->front(), functions->front()});
  ASSERT_TRUE(two.has_value());
  EXPECT_EQ(read_vlab_functions(*two, "b.fset")->size(), 2u);
  VlabFunction bad = functions->front();
  bad.name = "two\nlines";
  EXPECT_FALSE(write_vlab_function(bad).has_value());
  bad = functions->front();
  bad.points.resize(3);
  EXPECT_FALSE(write_vlab_function(bad).has_value());
}

TEST(VlabGraph, IsTheFunctionThatTheTableSamples) {
  VlabFunction function = read_vlab_functions(kRise, "a.func")->front();
  function.samples = 1000;
  const auto graph = vlab_graph(function);
  ASSERT_TRUE(graph.has_value());
  const VlabFunctionTable table(function);
  for (double x = 0.0; x <= 1.0; x += 1.0 / 512.0) {
    EXPECT_NEAR(table(x), (*graph)(x), 1.5e-4);  // steepest slope 9, entries found to 1e-5
  }
  EXPECT_EQ((*graph)(0.0), 0.25);
  std::swap(function.points[1], function.points[2]);
  const auto back_and_forth = vlab_graph(function);
  ASSERT_FALSE(back_and_forth.has_value());
  EXPECT_EQ(to_string(back_and_forth.error()), "rise and rest.points must have points with ascending x, got 0.25");
  EXPECT_TRUE(std::isfinite(VlabFunctionTable(function)(0.5)));
}

TEST(VlabReference, FunctionsAreWhatVlabEvaluates) {
  ANTHESIS_NEEDS_REFERENCE();
  struct Folder {
    const char* file;
    const char* values;
  };
  for (const Folder& folder :
       {Folder{"heads/bellis/functions.fset", "heads/bellis/evaluated/funcs.csv"},
        Folder{"heads/sunflower/functions.fset", "heads/sunflower/evaluated/funcs.csv"},
        Folder{"vlab/lychnis/functions.fset", "vlab/lychnis/evaluated/funcs.csv"},
        Folder{"vlab/lychnis/functions-getting-started.fset", "vlab/lychnis/evaluated-getting-started/funcs.csv"}}) {
    const auto functions = read_vlab_functions(test::reference_file(folder.file), folder.file);
    ASSERT_TRUE(functions.has_value()) << to_string(functions.error());
    std::vector<VlabFunctionTable> tables;
    std::vector<double> height;
    for (const VlabFunction& function : *functions) {
      tables.emplace_back(function);
      double low = 0.0;
      double high = 0.0;
      for (const VlabFunctionPoint& point : function.points) {
        low = std::min(low, point.position.y);
        high = std::max(high, point.position.y);
      }
      height.push_back(high - low);
    }
    std::size_t compared = 0;
    for (const std::vector<double>& row : test::reference_table(folder.values)) {
      const auto i = static_cast<std::size_t>(row[0]) - 1;
      const double error = std::abs(tables.at(i)(row[1]) - row[2]) / height[i];
      EXPECT_LE(error, 3e-4) << folder.file << ' ' << functions->at(i).name << " at " << row[1];
      ++compared;
    }
    EXPECT_EQ(compared, 2001 * tables.size());
  }
}

}  // namespace
}  // namespace anthesis
