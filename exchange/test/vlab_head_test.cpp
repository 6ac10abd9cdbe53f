#include "anthesis/exchange/vlab_head.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "vlab_reference.h"

namespace anthesis {
namespace {

using testing::HasSubstr;

template <class T>
std::string message(const Expected<T>& read) {
  return read ? "no error" : to_string(read.error());
}

TEST(ReadVlabPrimordia, KnowsFilesWithAndWithoutRadius) {
  const std::string plain = "00002\n1 35 0.873912 6.27159 1\n0 1 0.914578 3.14159 0\n";
  const auto read = read_vlab_primordia(plain, "a.prims");
  ASSERT_TRUE(read.has_value()) << message(read);
  EXPECT_FALSE(read->with_radius);
  ASSERT_EQ(read->primordia.size(), 2u);
  EXPECT_EQ(read->primordia[0].id, 1u);
  EXPECT_EQ(read->primordia[0].step, 35u);
  EXPECT_EQ(read->primordia[0].type, 1);
  EXPECT_EQ(write_vlab_primordia(*read), plain);
  const std::string with_radius = "00001\n0 1 0.914578 3.14159 2 1\n";
  const auto wide = read_vlab_primordia(with_radius, "a.prims");
  ASSERT_TRUE(wide.has_value()) << message(wide);
  EXPECT_TRUE(wide->with_radius);
  EXPECT_EQ(wide->primordia[0].radius, 2.0);
  EXPECT_EQ(write_vlab_primordia(*wide), with_radius);
}

TEST(ReadVlabPrimordia, CountsRowsWhereTheProgramWasStopped) {
  const auto stopped = read_vlab_primordia("00000\n0 1 0.5 1 0\n1 2 0.5 2 0\n", "a.prims");
  ASSERT_TRUE(stopped.has_value()) << message(stopped);
  EXPECT_EQ(stopped->primordia.size(), 2u);
  EXPECT_EQ(message(read_vlab_primordia("00003\n0 1 0.5 1 0\n1 2 0.5 2 0\n", "a.prims")),
            "a.prims:1:1: count must be the number of rows, 2, or 0, got 3");
}

TEST(ReadVlabPrimordia, SaysWhereWhatAndWhy) {
  EXPECT_EQ(message(read_vlab_primordia("00001\n0 1 1.5 1 0\n", "a.prims")),
            "a.prims:2:5: s must be between 0 and 1, got \"1.5\"");
  EXPECT_EQ(message(read_vlab_primordia("00001\n0 1 0.5 7 0\n", "a.prims")),
            "a.prims:2:9: azimuth must be between 0 and 6.28319, got \"7\"");
  EXPECT_THAT(message(read_vlab_primordia("00000\n0 1 0.5 1 0\n0 2 0.5 2 0\n", "a.prims")),
              HasSubstr("id must stand in one row only, 0 is in two"));
  EXPECT_EQ(message(read_vlab_primordia("00000\n0 1 0.5 1 0\n1 2 0.5 2 3.5 0\n", "a.prims")),
            "a.prims:3:11: type must be a whole number from 0 to 255, got \"3.5\"");
}

TEST(ReadVlabContourSequence, ReadsFramesAndTheRing) {
  const std::string text = "2\n3\n1\n0\n1\n0 1 0\n0.5 1 0.25\n1 0 1\n0 2 0\n0.5 2 0.25\n2 0 1\n0.75 0.5\n0 2\n";
  const auto read = read_vlab_contour_sequence(text, "a.cntrs");
  ASSERT_TRUE(read.has_value()) << message(read);
  EXPECT_EQ(read->frames(), 2u);
  EXPECT_EQ(read->landmarks, (std::vector<bool>{true, false, true}));
  ASSERT_EQ(read->frame(1).size(), 3u);
  EXPECT_EQ(read->frame(1)[2].radius, 2.0);
  EXPECT_EQ(read->frame(1)[1].s, 0.25);
  EXPECT_EQ(read->ring[0], (Vec2{0.75, 0.5}));
  EXPECT_EQ(write_vlab_contour_sequence(*read), text);
  EXPECT_EQ(message(read_vlab_contour_sequence(text + "1 1\n", "a.cntrs")),
            "a.cntrs:14:1: file must end here, got \"1\"");
  EXPECT_EQ(message(read_vlab_contour_sequence("1000000\n100000\n1\n", "a.cntrs")),
            "a.cntrs:4:1: landmark must be a whole number from 0 to 1, got the end of the file");
}

TEST(ReadVlabKnots, TakesTheFirstNumberOfEachLine) {
  const auto knots = read_vlab_knots("0: -0.01 -0.1 0\n1: 0 -0.1 0\n2: 0.5 -0.1 0\n3: 1.02 -0.1 0\n", "k.dat");
  ASSERT_TRUE(knots.has_value()) << message(knots);
  EXPECT_EQ(*knots, (std::vector<double>{0.0, 0.0, 0.5, 1.0}));
  EXPECT_EQ(message(read_vlab_knots("0: 0.5 0 0\n1: 0.25 0 0\n", "k.dat")),
            "k.dat:2:4: knot must not be below the knot before, 0.5, got 0.25");
  EXPECT_EQ(message(read_vlab_knots("0: 0 0 0\n2: 1 0 0\n", "k.dat")),
            "k.dat:2:1: line must have \"1:\" here, got \"2:\"");
}

VlabCage small_cage(float shift) {
  VlabCage cage;
  cage.vertices = {{0.0f, shift}, {1.0f, shift}, {0.0f, 1.0f}};
  cage.triangles = {{0, 1, 2}};
  cage.controls = {{0.0f, 2.0f}, {2.0f, shift}};
  cage.weights = {0.25f, 0.0f, 1.0f, 0.75f, 1.0f, 0.0f};
  return cage;
}

TEST(ReadVlabCages, ReadsBackWhatWasWritten) {
  const std::vector<VlabCage> cages = {small_cage(0.0f), small_cage(-1.5f)};
  const std::string bytes = write_vlab_cages(cages);
  EXPECT_EQ(bytes.size(), 4 + 2 * (3 * 4 + 3 * 8 + 12 + 2 * 8 + 6 * 4));
  const auto read = read_vlab_cages(bytes, "a.raw");
  ASSERT_TRUE(read.has_value()) << message(read);
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ((*read)[1].vertices, cages[1].vertices);
  EXPECT_EQ((*read)[1].weights, cages[1].weights);
  EXPECT_EQ(write_vlab_cages(*read), bytes);
}

TEST(ReadVlabCages, SurvivesAnyCutAndAnyByte) {
  const std::vector<VlabCage> cages = {small_cage(0.0f), small_cage(-1.5f)};
  const std::string bytes = write_vlab_cages(cages);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto read = read_vlab_cages(std::string_view(bytes).substr(0, size), "a.raw");
    ASSERT_FALSE(read.has_value()) << size;
    EXPECT_THAT(read.error().where, testing::StartsWith("a.raw:byte "));
  }
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const char value : {'\x00', '\x01', '\x7f', '\xff'}) {
      std::string changed = bytes;
      changed[at] = value;
      const auto read = read_vlab_cages(changed, "a.raw");
      EXPECT_TRUE(!read.has_value() || write_vlab_cages(*read) == changed) << at;
    }
  }
  VlabCage wrong = small_cage(0.0f);
  wrong.triangles[0][2] = 3;
  EXPECT_EQ(message(read_vlab_cages(write_vlab_cages(std::vector{wrong}), "a.raw")),
            "a.raw:byte 36: frame 1: triangles must name vertices below 3, got 3");
  wrong = small_cage(std::numeric_limits<float>::infinity());
  EXPECT_EQ(message(read_vlab_cages(write_vlab_cages(std::vector{wrong}), "a.raw")),
            "a.raw:byte 12: frame 1: vertices must be finite numbers");
}

std::vector<VlabContour> three_stages() {
  std::vector<VlabContour> contours(4);
  for (std::size_t i = 0; i < 4; ++i) {
    contours[i].name = "stage" + std::to_string(i);
    contours[i].points = {{{0.0, 1.0, 0.0}, 3}, {{1.0, 0.0, 0.0}, 3}};
    if (i < 3) {
      contours[i].markers = {{1.0, {}}, {0.8 - 0.1 * static_cast<double>(i), {}}};
    }
  }
  return contours;
}

TEST(VlabStages, BlendFromTheFirstStageToTheLast) {
  const auto stages = vlab_stages(three_stages(), {});
  ASSERT_TRUE(stages.has_value()) << message(stages);
  ASSERT_EQ(stages->contours.size(), 3u);  // the fourth has no markers: decoration
  EXPECT_EQ(stages->ring[1], 0.8 - 0.1);
  EXPECT_EQ(stages->landmarks[1], std::vector<double>{1.0});
  EXPECT_EQ(stages->knots, (std::vector<double>{0.0, 0.0, 0.0, 1.0, 1.0, 1.0}));
  // One piece: Bernstein polynomials of degree 2.
  const std::vector<double> middle = stages->weights(0.25);
  EXPECT_NEAR(middle[0], 0.5625, 1e-15);
  EXPECT_NEAR(middle[1], 0.375, 1e-15);
  EXPECT_NEAR(middle[2], 0.0625, 1e-15);
  EXPECT_EQ(stages->weights(-1.0), (std::vector<double>{1.0, 0.0, 0.0}));
  EXPECT_EQ(stages->weights(2.0), (std::vector<double>{0.0, 0.0, 1.0}));
}

TEST(VlabStages, WeightsAreThoseOfAQuadraticSpline) {
  VlabStages stages;
  stages.contours.resize(5);
  stages.knots = {0.0, 0.0, 0.0, 0.25, 0.625, 1.0, 1.0, 1.0};
  for (double time = 0.0; time <= 1.0; time += 1.0 / 64.0) {
    const std::vector<double> weights = stages.weights(time);
    double sum = 0.0;
    double mean = 0.0;  // of the means of inner knots: the time itself
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_GE(weights[i], 0.0);
      sum += weights[i];
      mean += weights[i] * 0.5 * (stages.knots[i + 1] + stages.knots[i + 2]);
    }
    EXPECT_NEAR(sum, 1.0, 1e-15);
    EXPECT_NEAR(mean, time, 1e-15);
  }
}

TEST(VlabStages, SaysWhichStageIsWrong) {
  EXPECT_EQ(message(vlab_stages(three_stages(), {0.0, 0.0, 1.0, 1.0})),
            "knots must be three more than the 3 stages, got 4");
  std::vector<VlabContour> contours = three_stages();
  contours[1].markers.clear();
  EXPECT_EQ(message(vlab_stages(contours, {})), "stage1.markers must end with the active ring, got no markers");
  contours = three_stages();
  contours[2].markers[1].s = 1.0;
  EXPECT_EQ(message(vlab_stages(contours, {})), "stage2.markers must descend from the base inwards, got 1");
  contours.resize(2);
  EXPECT_EQ(message(vlab_stages(contours, {})), "contours must have at least 3 stages with markers, got 2");
}

// ---- the published heads --------------------------------------------------------------------------------------------

TEST(VlabReference, PrimordiaAreAsManyAsPublished) {
  ANTHESIS_NEEDS_REFERENCE();
  struct Head {
    const char* path;
    std::size_t florets;
    std::size_t bracts;
  };
  // Bellis: the paper's head under vasculature/, and a later state of the model.
  for (const Head& head :
       {Head{"heads/bellis/vasculature/bellis_stable.prims", 392, 28},
        Head{"heads/bellis/bellis_stable.prims", 321, 46}, Head{"heads/sunflower/sunflower_stable.prims", 416, 81},
        Head{"heads/sunflower/sunflower_final.prims", 414, 83}}) {
    const auto read = read_vlab_primordia(test::reference_file(head.path), head.path);
    ASSERT_TRUE(read.has_value()) << message(read);
    std::size_t bracts = 0;
    for (const VlabPrimordium& one : read->primordia) {
      bracts += one.type == 1 ? 1 : 0;
    }
    EXPECT_EQ(bracts, head.bracts) << head.path;
    EXPECT_EQ(read->primordia.size() - bracts, head.florets) << head.path;
  }
}

TEST(VlabReference, WritersGiveTheBytesThatVlabWrote) {
  ANTHESIS_NEEDS_REFERENCE();
  std::size_t files = 0;
  for (const std::filesystem::path& path : test::reference_files()) {
    const std::string bytes = test::bytes_of(path);
    if (path.extension() == ".prims") {
      const auto read = read_vlab_primordia(bytes, path.filename().string());
      ASSERT_TRUE(read.has_value()) << message(read);
      const std::string text = write_vlab_primordia(*read);
      EXPECT_EQ(text.substr(text.find('\n')), bytes.substr(bytes.find('\n'))) << path;  // some headers state 00000
      ++files;
    } else if (path.extension() == ".cntrs") {
      const auto read = read_vlab_contour_sequence(bytes, path.filename().string());
      ASSERT_TRUE(read.has_value()) << message(read);
      EXPECT_TRUE(write_vlab_contour_sequence(*read) == bytes) << path;
      ++files;
    }
  }
  EXPECT_EQ(files, 15u);
}

TEST(VlabReference, SequencesHaveTheSizesOfTheModels) {
  ANTHESIS_NEEDS_REFERENCE();
  const auto bellis = read_vlab_contour_sequence(test::reference_file("heads/bellis/bellis.cntrs"), "bellis.cntrs");
  ASSERT_TRUE(bellis.has_value()) << message(bellis);
  EXPECT_EQ(bellis->frames(), 2214u);
  EXPECT_EQ(bellis->points_per_frame(), 51u);
  EXPECT_EQ(std::count(bellis->landmarks.begin(), bellis->landmarks.end(), true), 20);  // 18, the apex and the rim
  const auto sunflower = read_vlab_contour_sequence(test::reference_file("heads/sunflower/sunflower-regenerated.cntrs"),
                                                    "sunflower.cntrs");
  ASSERT_TRUE(sunflower.has_value()) << message(sunflower);
  EXPECT_EQ(sunflower->frames(), 2214u);
  EXPECT_EQ(sunflower->points_per_frame(), 79u);
}

/// The first and last frame of a sequence are the first and last stage, three times as large.
TEST(VlabReference, SequencesBeginAndEndWithTheDrawnContours) {
  ANTHESIS_NEEDS_REFERENCE();
  const auto contours =
      read_vlab_contours(test::reference_file("heads/bellis/contours_markers.cset"), "contours_markers.cset");
  ASSERT_TRUE(contours.has_value()) << message(contours);
  const auto stages = vlab_stages(*contours, {});
  ASSERT_TRUE(stages.has_value()) << message(stages);
  const auto sequence = read_vlab_contour_sequence(test::reference_file("heads/bellis/bellis.cntrs"), "bellis.cntrs");
  ASSERT_TRUE(sequence.has_value());
  for (const bool last : {false, true}) {
    const VlabCurve curve(last ? stages->contours.back() : stages->contours.front());
    const double size = 3.0 * curve.length();
    for (const VlabSequencePoint& point : sequence->frame(last ? sequence->frames() - 1 : 0)) {
      const Vec3 drawn = 3.0 * curve.at(point.s);
      EXPECT_NEAR(point.radius, drawn.x, 4e-4 * size) << point.s;
      EXPECT_NEAR(point.height, drawn.y, 4e-4 * size) << point.s;
    }
  }
}

/// O24's active ring: a primordium arises at the ring of the step before. This ties contours, markers, knots and
/// primordia together to all six digits of the files.
TEST(VlabReference, PrimordiaAriseOnTheActiveRing) {
  ANTHESIS_NEEDS_REFERENCE();
  for (const std::string head : {"bellis", "sunflower"}) {
    const auto contours =
        read_vlab_contours(test::reference_file("heads/" + head + "/contours_markers.cset"), "contours_markers.cset");
    const auto knots = read_vlab_knots(test::reference_file("heads/" + head + "/knotPositions.dat"), "knots");
    ASSERT_TRUE(contours.has_value() && knots.has_value());
    const auto stages = vlab_stages(*contours, *knots);
    ASSERT_TRUE(stages.has_value()) << message(stages);
    const auto born = read_vlab_primordia(test::reference_file("heads/" + head + "/" + head + "_initial.prims"), head);
    ASSERT_TRUE(born.has_value()) << message(born);
    std::size_t compared = 0;
    for (const VlabPrimordium& one : born->primordia) {
      const std::vector<double> weights = stages->weights(0.0005 * (one.step - 1.0));
      const double ring = std::inner_product(weights.begin(), weights.end(), stages->ring.begin(), 0.0);
      if (ring > 0.01) {  // near the apex the model slows its clock
        EXPECT_NEAR(one.s, ring, 1e-6) << head << ' ' << one.id;
        ++compared;
      }
    }
    EXPECT_GT(compared, 300u);
  }
}

}  // namespace
}  // namespace anthesis
