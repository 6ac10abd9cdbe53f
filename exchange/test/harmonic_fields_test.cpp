#include "anthesis/exchange/harmonic_fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "anthesis/base/file.h"
#include "anthesis/base/parallel.h"
#include "published_heads.h"
#include "vlab_reference.h"

namespace anthesis {
namespace {

namespace fs = std::filesystem;

/// A box that becomes a third wider and higher in each frame.
SectionSequence growing_box(std::size_t frames) {
  SectionSequence sections;
  double size = 1.0;
  for (std::size_t f = 0; f < frames; ++f, size *= 4.0 / 3.0) {
    for (const Vec2 p : {Vec2{0, 1}, {0.5, 1}, {1, 1}, {1, 0.5}, {1, 0}, {0.5, 0}, {0, 0}}) {
      sections.points.push_back(size * p);
    }
  }
  sections.points_per_frame = sections.points.size() / frames;
  return sections;
}

InteriorGrowth growth_of(const SectionSequence& sections) {
  return std::move(*InteriorGrowth::make(sections, {.mesh = kVlabSectionMesh}));
}

struct Written {
  std::string bytes;
  std::size_t largest_piece = 0;
  std::optional<Error> error;
};

Written written(const InteriorGrowth& growth, const Progress& progress = {}) {
  Written result;
  const ByteSink sink = [&](std::string_view bytes) -> std::optional<Error> {
    result.bytes += bytes;
    result.largest_piece = std::max(result.largest_piece, bytes.size());
    return std::nullopt;
  };
  result.error = write_harmonic_fields(growth, sink, progress);
  return result;
}

class HarmonicFieldsFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("anthesis-fields-test-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  bool is_empty() const { return fs::directory_iterator(folder_) == fs::directory_iterator(); }
  fs::path folder_;
};

TEST(WriteHarmonicFields, GivesWhatTheReaderOfCagesReads) {
  const SectionSequence sections = growing_box(50);
  InteriorGrowth growth = growth_of(sections);
  const Written all = written(growth);
  ASSERT_FALSE(all.error.has_value()) << to_string(*all.error);
  const Expected<std::vector<VlabCage>> cages = read_vlab_cages(all.bytes, "a.raw");
  ASSERT_TRUE(cages.has_value()) << to_string(cages.error());
  ASSERT_EQ(cages->size(), 50u);
  EXPECT_EQ(write_vlab_cages(*cages), all.bytes);
  for (std::size_t f = 0; f < cages->size(); ++f) {
    const VlabCage& cage = (*cages)[f];
    ASSERT_FALSE(growth.advance(f).has_value());
    const SectionMesh& mesh = growth.mesh();
    ASSERT_EQ(cage.vertices.size(), mesh.points.size());
    ASSERT_EQ(cage.triangles.size(), mesh.triangles.size());
    ASSERT_EQ(cage.controls.size(), sections.points_per_frame);
    EXPECT_TRUE(std::equal(cage.triangles.begin(), cage.triangles.end(), mesh.triangles.begin()));
    for (std::size_t c = 0; c < cage.controls.size(); ++c) {
      EXPECT_EQ(cage.controls[c][0], static_cast<float>(sections.frame(f)[c].x));
      EXPECT_EQ(cage.controls[c][1], static_cast<float>(sections.frame(f)[c].y));
    }
    for (std::size_t v = 0; v < cage.vertices.size(); ++v) {
      float sum = 0.0F;
      float height = 0.0F;
      for (std::size_t c = 0; c < cage.controls.size(); ++c) {
        const float weight = cage.weights[c * cage.vertices.size() + v];
        EXPECT_GE(weight, 0.0F);
        EXPECT_LE(weight, 1.0F);
        sum += weight;
        height += weight * cage.controls[c][1];
      }
      EXPECT_NEAR(sum, 1.0F, 1e-6F);
      EXPECT_NEAR(height, cage.vertices[v][1], 1e-6F * cage.controls[0][1]);
    }
  }
}

TEST(WriteHarmonicFields, HandsOverOneFrameAfterTheOtherAndTheSameBytesForAnyNumberOfThreads) {
  const InteriorGrowth growth = growth_of(growing_box(80));
  const auto on = [&](int threads) {
    const ThreadLimit limit(threads);
    return written(growth);
  };
  const Written one = on(1);
  EXPECT_LT(one.largest_piece, one.bytes.size() / 40);
  EXPECT_EQ(on(4).bytes, one.bytes);
}

TEST(WriteHarmonicFields, StopsWhenAskedAndWhenTheSinkFails) {
  const InteriorGrowth growth = growth_of(growing_box(80));
  double latest = 0.0;
  const Written cancelled = written(growth, [&](std::string_view, double fraction) {
    latest = fraction;
    return fraction < 0.5;
  });
  ASSERT_TRUE(cancelled.error.has_value());
  EXPECT_EQ(cancelled.error->code, ErrorCode::kCancelled);
  EXPECT_DOUBLE_EQ(latest, 0.5);
  std::size_t calls = 0;
  const std::optional<Error> error = write_harmonic_fields(growth, [&](std::string_view) -> std::optional<Error> {
    ++calls;
    return calls < 5 ? std::nullopt : std::optional(Error{ErrorCode::kIo, "sink:", "is full"});
  });
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(to_string(*error), "sink: is full");
  EXPECT_EQ(calls, 5u);
}

TEST_F(HarmonicFieldsFile, AppearsWholeOrNotAtAll) {
  const std::string path = (folder_ / "head.raw").string();
  SectionSequence sections = growing_box(40);
  const std::optional<Error> cancelled = write_harmonic_fields(
      sections, path, kVlabSectionMesh, [](std::string_view, double fraction) { return fraction < 0.5; });
  ASSERT_TRUE(cancelled.has_value());
  EXPECT_TRUE(is_empty());
  ASSERT_FALSE(write_harmonic_fields(sections, path).has_value());
  EXPECT_EQ(*read_file(path, kVlabRawLimit), written(growth_of(sections)).bytes);
  std::swap(sections.points[30 * sections.points_per_frame + 1], sections.points[30 * sections.points_per_frame + 4]);
  const std::string other = (folder_ / "other.raw").string();
  const std::optional<Error> crossed = write_harmonic_fields(sections, other);
  ASSERT_TRUE(crossed.has_value());
  EXPECT_EQ(crossed->where, "frame 30: section");
  EXPECT_FALSE(fs::exists(other));
  EXPECT_TRUE(write_harmonic_fields(sections, (folder_ / "none" / "x.raw").string()).has_value());
}

/// A published sequence as the models of growth take it.
ContourSequence published_contours(const std::string& path) {
  const Expected<VlabContourSequence> read = read_vlab_contour_sequence(test::reference_file(path), path);
  EXPECT_TRUE(read.has_value());
  ContourSequence contours;
  contours.landmarks = read->landmarks;
  contours.times.resize(read->frames());
  contours.ring = read->ring;
  for (const VlabSequencePoint& point : read->points) {
    contours.points.push_back({{point.radius, point.height}, point.s});
  }
  return contours;
}

TEST_F(HarmonicFieldsFile, HoldsAllFieldsOfThePublishedHeads) {
  ANTHESIS_NEEDS_REFERENCE();
  for (const bool is_sunflower : {false, true}) {
    const ContourSequence contours =
        published_contours(is_sunflower ? "heads/sunflower/sunflower-regenerated.cntrs" : "heads/bellis/bellis.cntrs");
    const std::string path = (folder_ / "head.raw").string();
    const std::optional<Error> error = write_harmonic_fields(with_base(contours), path);
    ASSERT_FALSE(error.has_value()) << to_string(*error);
    const Expected<std::vector<VlabCage>> cages = read_vlab_cages(*read_file(path, kVlabRawLimit), "head.raw");
    ASSERT_TRUE(cages.has_value()) << to_string(cages.error());
    ASSERT_EQ(cages->size(), 2214u);
    std::size_t fields = 0;
    std::size_t vertices = 0;
    for (const VlabCage& cage : *cages) {
      fields += cage.controls.size();
      vertices += cage.vertices.size();
    }
    EXPECT_EQ(fields, is_sunflower ? 219186u : 157194u);  // as O24 counts them
    // About as coarse as the published meshes, which have some 145 and 180 points.
    EXPECT_LT(vertices, 2214u * (is_sunflower ? 240u : 160u));
  }
}

TEST(VlabContourSequence, IsTheSequenceOfContours) {
  ContourSequence contours;
  contours.times = {0.0, 1.0};
  contours.landmarks = {true, false, true};
  contours.points = {{{0, 1}, 0}, {{0.5, 0.75}, 0.5}, {{1, 0}, 1}, {{0, 2}, 0}, {{1, 1.5}, 0.5}, {{2, 0}, 1}};
  contours.ring = {{0.25, 1}, {0.125, 2}};
  const VlabContourSequence sequence = vlab_contour_sequence(contours);
  EXPECT_EQ(write_vlab_contour_sequence(sequence),
            "2\n3\n1\n0\n1\n0 1 0\n0.5 0.75 0.5\n1 0 1\n0 2 0\n1 1.5 0.5\n2 0 1\n0.25 1\n0.125 2\n");
}

TEST(VlabContourSequence, GivesThePublishedBytes) {
  ANTHESIS_NEEDS_REFERENCE();
  const std::string path = "heads/bellis/bellis.cntrs";
  EXPECT_TRUE(write_vlab_contour_sequence(vlab_contour_sequence(published_contours(path))) ==
              test::reference_file(path));
}

TEST(VlabPrimordia, TakesTheMomentAndTheCodesAskedFor) {
  std::vector<RingPrimordium> primordia(2);
  primordia[0].born = {.step = 1, .time = 0.0005, .s = 0.75, .azimuth_rad = 3.0, .kind = PrimordiumKind::kBract};
  primordia[0].stable = {.step = 9, .time = 0.0045, .s = 0.75, .azimuth_rad = 3.5, .kind = PrimordiumKind::kBract};
  primordia[1].born = {.step = 2, .time = 0.001, .s = 0.5, .azimuth_rad = 1.0, .kind = PrimordiumKind::kTransFloret};
  primordia[1].stable = {.step = 0, .time = 0.0025, .s = 0.5, .azimuth_rad = 1.5, .kind = PrimordiumKind::kFloret};
  EXPECT_EQ(write_vlab_primordia(vlab_primordia(primordia, VlabPrimordiaMoment::kInitial)),
            "00002\n0 1 0.75 3 1\n1 2 0.5 1 0\n");
  EXPECT_EQ(write_vlab_primordia(vlab_primordia(primordia, VlabPrimordiaMoment::kStable)),
            "00002\n1 6 0.5 1.5 0\n0 9 0.75 3.5 1\n");
  EXPECT_EQ(write_vlab_primordia(vlab_primordia(primordia, VlabPrimordiaMoment::kInitial, VlabOrganCodes::kGerbera)),
            "00002\n0 1 0.75 3 0\n1 2 0.5 1 1\n");
}

/// Single precision turns the pattern aside sooner or later, so not all rows; those before are the very bytes.
TEST(VlabPrimordia, OfTheSunflowerAgreeWithThePublishedFileInManyRowsByteForByte) {
  ANTHESIS_NEEDS_REFERENCE();
  const GrowingReceptacle head(test::head_of(test::PublishedPattern::kSunflower), SectionLookup::kAsPublished);
  const auto primordia = grow_active_ring_as_published(head, test::ring_of(test::PublishedPattern::kSunflower));
  ASSERT_TRUE(primordia.has_value());
  const auto rows = [](const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t at = text.find('\n') + 1; at < text.size(); at = text.find('\n', at) + 1) {
      lines.push_back(text.substr(at, text.find('\n', at) - at));
    }
    return lines;
  };
  const auto made = rows(write_vlab_primordia(vlab_primordia(*primordia, VlabPrimordiaMoment::kInitial)));
  const auto published = rows(test::reference_file("heads/sunflower/sunflower_initial.prims"));
  ASSERT_EQ(made.size(), published.size());
  std::size_t same = 0;
  for (std::size_t i = 0; i < made.size(); ++i) {
    same += made[i] == published[i] ? 1 : 0;
  }
  EXPECT_GT(same, 150u);
}

}  // namespace
}  // namespace anthesis
