// Readers of the Virtual Laboratory's files survive any bytes: each reference file cut at line ends and with bytes
// changed gives a valid result or an error with its line.
#include <gtest/gtest.h>

#include "anthesis/base/random.h"
#include "anthesis/exchange/vlab_contour.h"
#include "anthesis/exchange/vlab_function.h"
#include "anthesis/exchange/vlab_head.h"
#include "anthesis/exchange/vlab_surface.h"
#include "vlab_reference.h"

namespace anthesis {
namespace {

constexpr std::string_view kName = "file";

/// What a reader made of some bytes.
struct Outcome {
  bool known = false;  ///< whether there is a reader for this kind of file
  bool read = false;
  std::string error;
};

template <class T, class Use>
Outcome outcome(const Expected<T>& read, const Use& use) {
  if (!read) {
    return {true, false, to_string(read.error())};
  }
  use(*read);
  return {true, true, ""};
}

/// Reads the bytes as the kind of file that `kind` names, and asks what was read for something.
Outcome read_as(const std::string& kind, std::string_view bytes) {
  if (kind == ".con" || kind == ".cset") {
    return outcome(read_vlab_contours(bytes, kName), [](const std::vector<VlabContour>& contours) {
      for (const VlabContour& contour : contours) {
        EXPECT_FALSE(check(contour).has_value());
        EXPECT_GE(VlabCurve(contour).length(), 0.0);
        static_cast<void>(vlab_profile(contour));
      }
      static_cast<void>(vlab_stages(contours, {}));
    });
  }
  if (kind == ".func" || kind == ".fset") {
    return outcome(read_vlab_functions(bytes, kName), [](const std::vector<VlabFunction>& functions) {
      for (const VlabFunction& function : functions) {
        EXPECT_FALSE(check(function).has_value());
        static_cast<void>(VlabFunctionTable(function)(0.5));
        static_cast<void>(vlab_graph(function));
      }
    });
  }
  if (kind == ".tset") {
    return outcome(read_vlab_timeline(bytes, kName), [](const std::vector<VlabTimedFunction>&) {});
  }
  if (kind == ".s") {
    return outcome(read_vlab_surface(bytes, kName), [](const VlabSurface& surface) {
      for (const VlabPatch& patch : surface.patches) {
        static_cast<void>(vlab_patch_point(vlab_placed_controls(surface, patch), 0.5, 0.5));
      }
    });
  }
  if (kind == ".prims") {
    return outcome(read_vlab_primordia(bytes, kName),
                   [](const VlabPrimordia& primordia) { static_cast<void>(write_vlab_primordia(primordia)); });
  }
  if (kind == ".cntrs") {
    return outcome(read_vlab_contour_sequence(bytes, kName), [](const VlabContourSequence& sequence) {
      EXPECT_EQ(sequence.points.size(), sequence.frames() * sequence.points_per_frame());
    });
  }
  if (kind == ".dat") {
    return outcome(read_vlab_knots(bytes, kName), [](const std::vector<double>&) {});
  }
  return {};
}

/// "file:<line>:<column>: ..." within the text's lines.
bool has_place(const std::string& error, std::string_view text) {
  const std::size_t lines = 1 + static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  std::size_t line = 0;
  std::size_t column = 0;
  int end = 0;
  return std::sscanf(error.c_str(), "file:%zu:%zu: %n", &line, &column, &end) == 2 && end > 0 && line >= 1 &&
         line <= lines && column >= 1;
}

/// The bytes with one to three changes, often near the beginning, where the counts are.
std::string changed_bytes(std::string bytes, Rng& rng) {
  using namespace std::string_view_literals;
  constexpr std::string_view kBytes = "0123456789.-+eE:# \t\n\r\0nanif~x\xff\x80/"sv;
  const auto below = [&rng](std::size_t count) {
    return static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
  };
  const bool near_start = below(2) == 0;
  for (std::size_t edits = 1 + below(3); edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = below(near_start ? std::min<std::size_t>(bytes.size(), 400) : bytes.size());
    switch (below(4)) {
      case 0:
        bytes.erase(at, 1 + below(20));
        break;
      case 1:
        bytes.insert(at, 1, kBytes[below(kBytes.size())]);
        break;
      case 2:
        bytes[at] = static_cast<char>(below(256));
        break;
      default:
        bytes[at] = kBytes[below(kBytes.size())];
    }
  }
  return bytes;
}

/// A small file of each kind.
std::vector<std::pair<std::string, std::string>> small_files() {
  const std::string contour =
      "cver 1 3\nname: a\npoints: 4 6\ntype: or\nsamples: 20\nbackground: b.png\nbackgroundXY: 0 1\nmarkers: 1\n"
      "0 0.5 1 2\n0 1 0 3\n1 1 0 1\n2 0.5 0 1\n2 0 0 1\n";
  const std::string function = "fver 1 1\nname: f\nsamples: 20\nflip: off\npoints: 4\n0 1\n0.2 2 1\n0.7 1 2\n1 0\n";
  const std::string old_contour =
      "version: 1.4\ncontact: 0 0 0\nend: 0 0 0\nheading: 0 1 0\nup: 0 0 -1\nsize: 1\npoints: 4\nrange: 0 1\n"
      "dimension: 4\ntype: bspline\n1 0 0 3\n1 1 0 1\n0.5 2 0 1\n0 2 0 3\n";
  const std::string timeline = "timeEdit 1 2\nitems: 1\nstart: 0\nend: 2\nname: t\ntimelineFunceditFileStart:\n" +
                               function + "timelineFunceditFileEnd:\n";
  const std::string surface =
      "0 1 0 1 0 1\nCONTACT POINT X: 0 Y: 0 Z: 0\nEND POINT X: 0 Y: 0 Z: 0\nHEADING X: 0 Y: 1 Z: 0\n"
      "UP X: 0 Y: 0 Z: 1\nSIZE: 1\np\nTOP COLOR: 1\nAL: ~\nL: ~\nBL: ~\n"
      "0 0 0 1 0 0 2 0 0 3 0 0\n0 1 0 1 1 0 2 1 0 3 1 0\n0 2 0 1 2 0 2 2 0 3 2 0\n0 3 0 1 3 0 2 3 0 3 3 0\n";
  return {{".con", contour},
          {".con", old_contour},
          {".con", "4 2 closed\n0 0\n1 0\n1 1\n0 1\n"},
          {".cset", "contourgalleryver 1 1\nitems: 2\n" + contour + contour},
          {".func", function},
          {".fset", "funcgalleryver 1 1\nitems: 2\n" + function + function},
          {".tset", timeline},
          {".s", surface},
          {".prims", "00003\n0 1 0.9 3.14 1\n1 4 0.8 1.5 1\n2 9 0.7 0.2 0\n"},
          {".cntrs", "2\n2\n1\n0\n0 1 0\n1 0 1\n0 2 0\n2 0 1\n0.5 0.5\n1 1\n"},
          {".dat", "0: 0 0 0\n1: 0.5 0 0\n2: 1 0 0\n"}};
}

TEST(VlabReaders, SurviveSmallFilesCutAndChangedAnywhere) {
  Rng rng(11, 0, RandomPurpose::kTest);
  std::size_t refused = 0;
  std::size_t accepted = 0;
  for (const auto& [kind, bytes] : small_files()) {
    ASSERT_TRUE(read_as(kind, bytes).read) << kind << ": " << read_as(kind, bytes).error;
    std::vector<std::string> variants;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      variants.push_back(bytes.substr(0, size));
    }
    for (int round = 0; round < 500; ++round) {
      variants.push_back(changed_bytes(bytes, rng));
    }
    for (const std::string& variant : variants) {
      const Outcome result = read_as(kind, variant);
      result.read ? ++accepted : ++refused;
      ASSERT_TRUE(result.read || has_place(result.error, variant)) << kind << ": " << result.error << '\n' << variant;
    }
  }
  EXPECT_GT(refused, 3000u);
  EXPECT_GT(accepted, 150u);
}

TEST(VlabReference, EveryFileReads) {
  ANTHESIS_NEEDS_REFERENCE();
  std::size_t files = 0;
  for (const std::filesystem::path& path : test::reference_files()) {
    const Outcome result = read_as(path.extension().string(), test::bytes_of(path));
    EXPECT_TRUE(result.known) << path;
    EXPECT_TRUE(result.read) << path << ": " << result.error;
    ++files;
  }
  EXPECT_GE(files, 35u);
}

TEST(VlabReference, FilesCutAtALineEndGiveErrorsWithTheirLine) {
  ANTHESIS_NEEDS_REFERENCE();
  constexpr std::size_t kMostCuts = 400;  // of a file; sequences have 100,000 lines
  for (const std::filesystem::path& path : test::reference_files()) {
    const std::string bytes = test::bytes_of(path);
    const auto lines = static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), '\n'));
    const std::size_t each = 1 + lines / (bytes.size() > 1'000'000 ? 40 : kMostCuts);
    std::size_t line = 0;
    for (std::size_t at = 0; at + 1 < bytes.size(); at = bytes.find('\n', at) + 1, ++line) {
      if (line % each != 0 && line > 8 && line + 8 < lines) {
        continue;
      }
      const std::string_view cut = std::string_view(bytes).substr(0, at);
      const Outcome result = read_as(path.extension().string(), cut);
      if (result.read) {
        // Formats without a count of their rows cannot tell.
        EXPECT_TRUE(path.extension() == ".dat" || bytes.starts_with("00000\n")) << path << " cut after line " << line;
      } else {
        EXPECT_TRUE(has_place(result.error, cut)) << path << " cut after line " << line << ": " << result.error;
      }
    }
  }
}

TEST(VlabReference, FilesWithChangedBytesGiveErrorsWithTheirLineOrAResult) {
  ANTHESIS_NEEDS_REFERENCE();
  Rng rng(7, 0, RandomPurpose::kTest);
  std::size_t refused = 0;
  std::size_t accepted = 0;
  for (const std::filesystem::path& path : test::reference_files()) {
    const std::string bytes = test::bytes_of(path);
    const int rounds = bytes.size() > 1'000'000 ? 20 : 150;
    for (int round = 0; round < rounds; ++round) {
      const std::string changed = changed_bytes(bytes, rng);
      const Outcome result = read_as(path.extension().string(), changed);
      result.read ? ++accepted : ++refused;
      EXPECT_TRUE(result.read || has_place(result.error, changed)) << path << ": " << result.error;
    }
  }
  EXPECT_GT(refused, 2000u);
  EXPECT_GT(accepted, 300u);
}

}  // namespace
}  // namespace anthesis
