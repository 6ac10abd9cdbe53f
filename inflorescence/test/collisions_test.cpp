#include "anthesis/inflorescence/collisions.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "anthesis/base/parallel.h"
#include "anthesis/contact/crossings.h"

namespace anthesis {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

Petals blade() {
  Petals petals;
  petals.name = "blade";
  petals.pigment = "green";
  petals.spacing = {{0.0, 0.16}, {1.0, 0.16}};
  petals.vertices = {{0.0, 4.0}, {1.0, 5.0}};
  petals.poses.resize(2);
  petals.poses[0].stage = 0.0;  // upright
  petals.poses[0].midrib_mm = {{0.0, 0.4}, {0.8, 7}, {2.0, 16}, {2.4, 25}};
  petals.poses[0].half_width_mm = {2, 4, 8, 6};
  petals.poses[1].stage = 1.0;  // leaning over the middle
  petals.poses[1].midrib_mm = {{0.0, 0.4}, {0.0, 7}, {-4.0, 16}, {-11.0, 23}};
  petals.poses[1].half_width_mm = {2, 5, 10, 8};
  return petals;
}

/// Two petals rise from a small receptacle and lean through each other: the smallest plant with something to decide.
Species two_petals() {
  Species species;
  species.name = "two";
  Pigment green;
  green.name = "green";
  species.pigments = {green};
  Head& head = species.head;
  head.divergence_deg = 180.0;
  head.interval = 0.01;
  head.meristem_area_mm2 = 8.6;  // room for two, and what is left grows between them
  head.meristem_growth = {{0.0, 1.0}, {0.03, 1.0}, {0.06, 1.0}, {0.09, 1.0}, {0.2, 12.0}, {0.3, 12.0}, {1.0, 12.0}};
  head.area_mm2 = {{0.0, 3.0}, {1.0, 3.0}};
  head.receptacle = {{0.0, {{0, 0.6}, {1.2, 0.6}, {2.4, 0.6}, {3.6, 0.6}, {4.8, 0.59}, {5.3, 0.56}}}};
  head.receptacle_pigment = "green";
  head.zones = {{"petal", 0.0, 1.0}};
  species.peduncle.pigment = "green";
  species.peduncle.length_mm = 20.0;
  species.peduncle.radius_mm = 1.6;
  OrganKind petal;
  petal.name = "petal";
  petal.shape.petals = {blade()};
  petal.growth = {{0.0, 0.05}, {0.2, 0.25}, {0.5, 0.8}, {1.0, 1.0}};
  petal.opening = {{0.0, 0.0}, {0.3, 0.1}, {0.7, 0.9}, {1.0, 1.0}};
  petal.variation.pitch_deg = {-3.0, 3.0};
  petal.variation.yaw_deg = {-2.0, 2.0};
  species.organs = {petal};
  return species;
}

const Development& plant() {
  static const Development grown = *Development::grow(two_petals(), {.detail = 0.7});
  return grown;
}

constexpr int kSteps = 16;

CollisionOptions options_for(const std::string& checkpoint = {}, bool resume = false) {
  CollisionOptions options;
  options.steps = kSteps;
  options.checkpoint = checkpoint;
  options.resume = resume;
  return options;
}

std::vector<Canopy> frames_at(const std::vector<double>& times, const CollisionOptions& options = options_for(),
                              const Development& development = plant()) {
  auto result = resolve_collisions(development, times, options);
  EXPECT_TRUE(result) << result.error().where << " " << result.error().message;
  return result ? std::move(result->frames) : std::vector<Canopy>(times.size());
}

std::uint64_t crossings_in(const Canopy& canopy, const Development& development = plant()) {
  const CanopySurface surface = surface_of(development, canopy);
  return find_crossings(surface.positions_mm, surface.triangles)->count;
}

/// Every coordinate of a frame, to be compared to the last bit.
std::vector<Vec3> bits_of(const Canopy& canopy, const Development& development = plant()) {
  return surface_of(development, canopy).positions_mm;
}

std::vector<std::vector<Vec3>> bits_of(const std::vector<Canopy>& frames) {
  std::vector<std::vector<Vec3>> all;
  for (const Canopy& frame : frames) {
    all.push_back(bits_of(frame));
  }
  return all;
}

/// An empty folder of this test's own, gone with the test.
class Collisions : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("anthesis-") + test->name() + "-" + std::to_string(getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string folder() const { return folder_.string(); }
  std::vector<fs::path> files() const {
    std::vector<fs::path> found;
    if (fs::exists(folder_)) {
      for (const auto& entry : fs::directory_iterator(folder_)) {
        found.push_back(entry.path());
      }
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  /// Stops a run with a checkpoint after that share of its reports of progress.
  void interrupt_at(double share, const std::vector<double>& times) {
    int reports = 0;
    ASSERT_TRUE(resolve_collisions(plant(), times, options_for(), [&](std::string_view, double) {
      ++reports;
      return true;
    }));
    int seen = 0;
    const auto stopped = resolve_collisions(plant(), times, options_for(folder()), [&](std::string_view, double) {
      return seen++ < static_cast<int>(share * reports);
    });
    ASSERT_FALSE(stopped);
    ASSERT_EQ(stopped.error().code, ErrorCode::kCancelled);
  }

 private:
  fs::path folder_;
};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// ---------------------------------------------------------------------------------------------------------------------

TEST_F(Collisions, WhatCrossesWithoutThemIsKeptApart) {
  const std::vector<double> times = {0.0, 0.3, 0.6, 0.8, 1.0};
  const auto result = resolve_collisions(plant(), times, options_for());
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(result->frames.size(), times.size());
  EXPECT_GT(crossings_in(plant().at(1.0)), 0u);  // or this test shows nothing
  for (std::size_t i = 0; i < times.size(); ++i) {
    const Canopy& frame = result->frames[i];
    EXPECT_EQ(frame.time, times[i]);
    EXPECT_EQ(crossings_in(frame), 0u) << "time " << times[i];
    // The same organs and bodies as without.
    const Canopy plain = plant().at(times[i]);
    ASSERT_EQ(frame.organs.size(), plain.organs.size());
    ASSERT_EQ(frame.bodies.size(), plain.bodies.size());
    for (std::size_t k = 0; k < plain.organs.size(); ++k) {
      EXPECT_EQ(frame.organs[k].id, plain.organs[k].id);
      EXPECT_EQ(frame.organs[k].stage, plain.organs[k].stage);
    }
  }
  EXPECT_EQ(result->frames.back().organs.size(), 2u);
  EXPECT_EQ(result->report.steps, kSteps);
  EXPECT_GT(result->report.passes, 0u);
  EXPECT_GT(result->report.contacts, 0u);
  EXPECT_EQ(result->report.triangles, surface_of(plant(), result->frames.back()).triangles.size());
}

TEST_F(Collisions, CoordinatesLieOnALatticeThatSinglePrecisionHolds) {
  for (const Canopy& frame : frames_at({0.4, 1.0})) {
    for (const OrganState& organ : frame.organs) {
      EXPECT_FALSE(organ.deformed_mm.empty());
    }
    for (const Vec3 p : bits_of(frame)) {
      for (const double x : {p.x, p.y, p.z}) {
        EXPECT_EQ(std::nearbyint(16384.0 * x), 16384.0 * x);
        EXPECT_EQ(static_cast<double>(static_cast<float>(x)), x);
      }
    }
  }
}

TEST_F(Collisions, AFrameDoesNotDependOnTheOthers) {
  const std::vector<Vec3> alone = bits_of(frames_at({0.5})[0]);
  const std::vector<Canopy> many = frames_at({0.0, 0.3, 0.5, 0.77, 1.0});
  EXPECT_EQ(bits_of(many[2]), alone);
  // Between two steps, too.
  EXPECT_EQ(bits_of(frames_at({0.77})[0]), bits_of(many[3]));
  // Asked for twice, shown twice: between two steps and at one.
  const std::vector<Canopy> twice = frames_at({0.3, 0.3, 0.875, 0.875, 1.0});
  EXPECT_EQ(bits_of(twice[0]), bits_of(many[1]));
  EXPECT_EQ(bits_of(twice[1]), bits_of(many[1]));
  EXPECT_EQ(bits_of(twice[3]), bits_of(twice[2]));
  EXPECT_EQ(bits_of(twice[4]), bits_of(many[4]));
}

// A vertex that jumps aside and back would change its way, from one frame to the next, by twice the jump.
TEST_F(Collisions, NothingPopsFromFrameToFrame) {
  CollisionOptions options;
  std::vector<double> times;
  for (int i = 24; i <= options.steps; ++i) {  // both petals are there
    times.push_back(static_cast<double>(i) / options.steps);
  }
  std::vector<Canopy> free;
  for (const double time : times) {
    free.push_back(plant().at(time));
  }
  const std::vector<std::vector<Vec3>> alone = bits_of(free);
  const std::vector<std::vector<Vec3>> kept_apart = bits_of(frames_at(times, options));
  double fastest_mm = 0.0;  // in one frame, if nothing were in the way
  double roughest_mm = 0.0;
  for (std::size_t i = 1; i + 1 < times.size(); ++i) {
    for (std::size_t v = 0; v < alone[i].size(); ++v) {
      fastest_mm = std::max(fastest_mm, length(alone[i][v] - alone[i - 1][v]));
      roughest_mm = std::max(roughest_mm, length(kept_apart[i + 1][v] - 2.0 * kept_apart[i][v] + kept_apart[i - 1][v]));
    }
  }
  EXPECT_LT(roughest_mm, 0.5 * fastest_mm);
}

TEST_F(Collisions, TheNumberOfThreadsChangesNoBit) {
  std::vector<std::vector<Vec3>> once;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const std::vector<std::vector<Vec3>> here = bits_of(frames_at({0.33, 1.0}));
    if (once.empty()) {
      once = here;
    }
    EXPECT_EQ(here, once);
  }
}

TEST_F(Collisions, OrgansThatTouchNothingLookAsTheyDoWithout) {
  Species species = two_petals();
  species.organs[0].opening = {{0.0, 0.0}, {1.0, 0.0}};  // upright for ever
  species.organs[0].pitch_deg = {{0.0, 10.0}, {1.0, 10.0}};
  const Development development = *Development::grow(species, {.detail = 0.7});
  const Canopy plain = development.at(1.0);
  ASSERT_EQ(crossings_in(plain, development), 0u);
  const std::vector<Vec3> with = bits_of(frames_at({1.0}, options_for(), development)[0], development);
  const std::vector<Vec3> without = bits_of(plain, development);
  // Organs are set on the receptacle, a hair higher than without.
  for (std::size_t i = 0; i < with.size(); ++i) {
    ASSERT_LT(length(with[i] - without[i]), 0.1);
  }
}

TEST_F(Collisions, ReportsProgressThatNeverGoesBack) {
  double last = 0.0;
  int reports = 0;
  std::string stage = "collisions";
  const auto result = resolve_collisions(plant(), std::vector<double>{0.5, 0.55}, options_for(),
                                         [&](std::string_view now, double done) {
                                           if (now != stage) {
                                             EXPECT_EQ(now, "certificate");
                                             stage = now;
                                             last = 0.0;
                                           }
                                           EXPECT_GE(done, last);
                                           EXPECT_LE(done, 1.0);
                                           last = done;
                                           ++reports;
                                           return true;
                                         });
  EXPECT_TRUE(result);
  EXPECT_GT(reports, kSteps);
}

// ---------------------------------------------------------------------------------------------------------------------

TEST_F(Collisions, AnInterruptedRunGoesOnToEqualFrames) {
  const std::vector<double> times = {0.0, 0.3, 0.5, 0.77, 1.0};
  const auto whole = resolve_collisions(plant(), times, options_for());
  ASSERT_TRUE(whole);
  for (const double share : {0.0, 0.02, 0.4, 0.6, 0.95, 0.999}) {
    interrupt_at(share, times);
    const auto resumed = resolve_collisions(plant(), times, options_for(folder(), true));
    ASSERT_TRUE(resumed) << resumed.error().where << " " << resumed.error().message;
    EXPECT_EQ(bits_of(resumed->frames), bits_of(whole->frames)) << "interrupted at " << share;
    EXPECT_EQ(resumed->report.steps, whole->report.steps);
    EXPECT_EQ(resumed->report.passes, whole->report.passes);
    EXPECT_EQ(resumed->report.residual_mm, whole->report.residual_mm);
    remove_checkpoint(folder());
    EXPECT_FALSE(fs::exists(folder()));
  }
}

TEST_F(Collisions, AResumedRunDoesWhatIsLeftAndNoMore) {
  interrupt_at(0.5, {1.0});
  double first = -1.0;
  const auto resumed = resolve_collisions(plant(), std::vector<double>{1.0}, options_for(folder(), true),
                                          [&](std::string_view, double done) {
                                            first = first < 0.0 ? done : first;
                                            return true;
                                          });
  ASSERT_TRUE(resumed);
  EXPECT_GT(first, 0.2);
}

TEST_F(Collisions, ARunCanBeInterruptedAgainAndAgain) {
  const std::vector<double> times = {0.5, 1.0};
  interrupt_at(0.2, times);
  int rounds = 0;
  for (; rounds < 1000; ++rounds) {
    int seen = 0;
    const auto more = resolve_collisions(plant(), times, options_for(folder(), true),
                                         [&](std::string_view, double) { return seen++ < 20; });
    if (more) {
      EXPECT_EQ(bits_of(more->frames), bits_of(frames_at(times)));
      break;
    }
    ASSERT_EQ(more.error().code, ErrorCode::kCancelled);
  }
  EXPECT_GT(rounds, 1);
  EXPECT_LT(rounds, 1000);
}

TEST_F(Collisions, ResumingWithoutACheckpointStartsAnew) {
  EXPECT_EQ(bits_of(frames_at({0.3}, options_for(folder(), true))), bits_of(frames_at({0.3})));
}

TEST_F(Collisions, ACheckpointIsNotOverwrittenUnlessItIsResumed) {
  interrupt_at(0.5, {1.0});
  const std::vector<fs::path> before = files();
  ASSERT_FALSE(before.empty());
  const auto refused = resolve_collisions(plant(), std::vector<double>{1.0}, options_for(folder()));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidParameter);
  EXPECT_EQ(refused.error().where, "checkpoint");
  EXPECT_THAT(refused.error().message, HasSubstr("must be a folder without a run in it"));
  EXPECT_EQ(files(), before);
}

TEST_F(Collisions, AnotherRunsCheckpointIsRefusedAndKept) {
  interrupt_at(0.5, {1.0});
  const std::vector<fs::path> before = files();
  const Development other = *Development::grow(two_petals(), {.seed = 2, .detail = 0.7});
  CollisionOptions finer = options_for(folder(), true);
  finer.steps = 2 * kSteps;
  CollisionOptions softer = options_for(folder(), true);
  softer.growing.residual_mm *= 0.5;
  const auto refusals = {resolve_collisions(other, std::vector<double>{1.0}, options_for(folder(), true)),
                         resolve_collisions(plant(), std::vector<double>{0.9}, options_for(folder(), true)),
                         resolve_collisions(plant(), std::vector<double>{1.0}, finer),
                         resolve_collisions(plant(), std::vector<double>{1.0}, softer)};
  for (const auto& refused : refusals) {
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidParameter);
    EXPECT_THAT(refused.error().message,
                HasSubstr("must be of the same species, seed, detail, times, options and version"));
  }
  EXPECT_EQ(files(), before);
  EXPECT_EQ(bits_of(frames_at({1.0}, options_for(folder(), true))), bits_of(frames_at({1.0})));
}

TEST_F(Collisions, AChangedSpeciesIsAnotherRun) {
  interrupt_at(0.5, {1.0});
  Species species = two_petals();
  species.sha256 = "another";
  const Development other = *Development::grow(species, {.detail = 0.7});
  EXPECT_FALSE(resolve_collisions(other, std::vector<double>{1.0}, options_for(folder(), true)));
}

TEST_F(Collisions, ADamagedCheckpointIsFoundOutAndKept) {
  interrupt_at(0.5, {0.1, 1.0});
  const std::vector<fs::path> saved = files();
  ASSERT_EQ(saved.size(), 2u);  // the state and a frame
  for (const fs::path& path : saved) {
    const std::string whole = bytes_of(path);
    ASSERT_GT(whole.size(), 100u);
    std::string flipped = whole;
    flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 1);
    for (const std::string& damaged :
         {std::string(), std::string("x"), whole.substr(0, 80), whole.substr(0, whole.size() / 2),
          whole.substr(0, whole.size() - 1), whole + "x", flipped}) {
      write_bytes(path, damaged);
      const auto refused = resolve_collisions(plant(), std::vector<double>{0.1, 1.0}, options_for(folder(), true));
      ASSERT_FALSE(refused) << path << " of " << damaged.size() << " bytes";
      EXPECT_EQ(refused.error().code, ErrorCode::kParse);
      EXPECT_EQ(refused.error().where, path.string() + ":");
      EXPECT_THAT(refused.error().message, HasSubstr("must be a whole checkpoint"));
      EXPECT_EQ(bytes_of(path), damaged);  // it is not ours to remove
    }
    write_bytes(path, whole);
  }
  EXPECT_TRUE(resolve_collisions(plant(), std::vector<double>{0.1, 1.0}, options_for(folder(), true)));
}

TEST_F(Collisions, AMissingFrameIsAnError) {
  interrupt_at(0.5, {0.1, 1.0});
  fs::remove(files()[0]);
  const auto refused = resolve_collisions(plant(), std::vector<double>{0.1, 1.0}, options_for(folder(), true));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kIo);
}

TEST_F(Collisions, ACheckpointFolderThatCannotBeMadeIsAnError) {
  fs::create_directories(folder());
  write_bytes(fs::path(folder()) / "file", "");
  const auto refused = resolve_collisions(plant(), std::vector<double>{1.0},
                                          options_for((fs::path(folder()) / "file" / "sub").string()));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kIo);
}

TEST_F(Collisions, OnlyTheCheckpointIsRemovedFromAFolder) {
  interrupt_at(0.5, {0.1, 1.0});
  write_bytes(fs::path(folder()) / "notes.txt", "mine");
  remove_checkpoint(folder());
  EXPECT_THAT(files(), testing::ElementsAre(fs::path(folder()) / "notes.txt"));
  remove_checkpoint(folder() + "/nowhere");  // nothing happens
}

TEST_F(Collisions, TheStateIsRemovedBeforeItsFrames) {
  // Killed in between, a run must not leave a state behind that lacks its frames: it could not be taken up again.
  interrupt_at(0.5, {0.1, 1.0});
  const fs::path state = fs::path(folder()) / "state.checkpoint";
  fs::remove(state);
  fs::create_directories(state / "stuck");  // cannot be removed
  const std::size_t frames = files().size();
  ASSERT_GT(frames, 1u);
  remove_checkpoint(folder());
  EXPECT_EQ(files().size(), frames);
  fs::remove_all(state);
  EXPECT_TRUE(resolve_collisions(plant(), std::vector<double>{0.1, 1.0}, options_for(folder(), true)));
}

// ---------------------------------------------------------------------------------------------------------------------

TEST_F(Collisions, AnOrganThatCrossesItselfIsNamed) {
  Species species = two_petals();
  // The midrib runs in a loop through itself.
  for (PetalPose& pose : species.organs[0].shape.petals[0].poses) {
    pose.midrib_mm = {{0.0, 0.4}, {30.0, 30.0}, {-20.0, 30.0}, {10.0, 0.4}};
    pose.half_width_mm = {2, 4, 6, 6};
  }
  species.organs[0].shape.petals[0].spacing = {{0.0, 0.05}, {1.0, 0.05}};
  const Development development = *Development::grow(species, {});
  const auto refused = resolve_collisions(development, std::vector<double>{0.5}, options_for());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCrossing);
  EXPECT_EQ(refused.error().where, "collisions");
  EXPECT_THAT(refused.error().message, HasSubstr("petal.1 crosses itself"));
}

TEST_F(Collisions, TimesMustAscendWithinTheDevelopment) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<double>& times :
       {std::vector{0.5, 0.4}, std::vector{-0.1}, std::vector{0.2, 1.5}, std::vector{nan}}) {
    const auto refused = resolve_collisions(plant(), times, options_for());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidParameter);
    EXPECT_EQ(refused.error().where, "times");
    EXPECT_THAT(refused.error().message, HasSubstr("must be ascending and in [0, 1]"));
  }
}

TEST_F(Collisions, OptionsHaveRanges) {
  CollisionOptions options = options_for();
  for (const int steps : {0, 10001}) {
    options.steps = steps;
    const auto refused = resolve_collisions(plant(), std::vector<double>{0.5}, options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidParameter);
    EXPECT_EQ(refused.error().where, "steps");
  }
  const auto refused = resolve_collisions(plant(), std::vector<double>{0.5}, options_for("", true));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "resume");
}

TEST_F(Collisions, NoTimesNoFrames) {
  const auto result = resolve_collisions(plant(), {}, options_for());
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->frames.empty());
}

TEST_F(Collisions, OwnersHaveTheNamesOfTheirOrgans) {
  const Canopy canopy = plant().at(1.0);
  const CanopySurface surface = surface_of(plant(), canopy);
  ASSERT_EQ(surface.owner.size(), surface.triangles.size());
  EXPECT_TRUE(std::ranges::is_sorted(surface.owner));
  EXPECT_EQ(owner_name(plant(), canopy, surface.owner.front()), "petal.1");
  EXPECT_EQ(owner_name(plant(), canopy, surface.owner.back()), "peduncle");
}

}  // namespace
}  // namespace anthesis
