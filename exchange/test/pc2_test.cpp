#include "anthesis/exchange/pc2.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "anthesis/base/parallel.h"
#include "anthesis/exchange/obj.h"
#include "bent_plant.h"
#include "tiny_species.h"

namespace anthesis {
namespace {

constexpr std::array<double, 4> kTimes = {0.0, 0.3, 0.7, 1.0};

template <class Value>
Value at(const std::string& bytes, std::size_t offset) {
  Value value;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

TEST(ToPc2, LastSampleIsTheObjOfTheLastFrameVertexByVertex) {
  const Development development = test::grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const Expected<std::string> bytes = to_pc2(development, frames);
  ASSERT_TRUE(bytes.has_value());
  EXPECT_EQ(std::memcmp(bytes->data(), "POINTCACHE2\0", 12), 0);
  EXPECT_EQ(at<std::int32_t>(*bytes, 12), 1);
  EXPECT_EQ(at<float>(*bytes, 20), 0.0f);
  EXPECT_EQ(at<float>(*bytes, 24), 1.0f);
  EXPECT_EQ(at<std::int32_t>(*bytes, 28), 4);
  const auto points = static_cast<std::size_t>(at<std::int32_t>(*bytes, 16));
  ASSERT_EQ(bytes->size(), 32 + 4 * 12 * points);

  std::stringstream stream(to_obj(development, frames.back(), "a.mtl")->obj);
  std::size_t offset = 32 + 3 * 12 * points;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("v ")) {
      std::stringstream words(line.substr(2));
      for (std::string word; words >> word; offset += 4) {
        ASSERT_EQ(at<float>(*bytes, offset), std::stof(word));
      }
    }
  }
  EXPECT_EQ(offset, bytes->size());
}

TEST(ToPc2, EarlierSamplesHaveTheGivenNumbersAndPointsForTheUnborn) {
  const Development development = test::grow_tiny();
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const Expected<std::string> bytes = to_pc2(development, frames);
  ASSERT_TRUE(bytes.has_value());
  const auto points = static_cast<std::size_t>(at<std::int32_t>(*bytes, 16));
  std::size_t unborn = 0;
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    std::size_t offset = 32 + frame * 12 * points;
    std::size_t next = 0;  // ids ascend in all frames
    for (const OrganState& state : frames.back().organs) {
      const bool born = next < frames[frame].organs.size() && frames[frame].organs[next].id == state.id;
      for (std::size_t v = 0; v < state.deformed_mm.size(); ++v, offset += 12) {
        if (born) {
          ASSERT_EQ(std::memcmp(bytes->data() + offset, frames[frame].organs[next].deformed_mm[v].data(), 12), 0);
        } else {
          ASSERT_EQ(std::memcmp(bytes->data() + offset, bytes->data() + (offset - 12 * v), 12), 0);
        }
      }
      next += born ? 1 : 0;
      unborn += born ? 0 : 1;
    }
  }
  EXPECT_GT(unborn, 10u);
}

TEST(ToPc2, RefusesNoFramesAndGivesTheSameBytesForAnyNumberOfThreads) {
  const Development development = test::grow_tiny();
  EXPECT_EQ(to_pc2(development, {}).error().where, "frames");
  const std::vector<Canopy> frames = test::bent_at(development, kTimes);
  const std::string once = *to_pc2(development, frames);
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(*to_pc2(development, frames), once);
  }
}

}  // namespace
}  // namespace anthesis
