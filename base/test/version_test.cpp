#include "anthesis/base/version.h"

#include <gtest/gtest.h>

#include <string>

#include "anthesis/base/file.h"
#include "anthesis/base/sha256.h"

namespace anthesis {
namespace {

TEST(Version, IsTheOneOfTheBuild) {
  const Expected<std::string> cmake = read_file(ANTHESIS_SOURCE_DIR "/CMakeLists.txt", 1 << 20);
  ASSERT_TRUE(cmake);
  EXPECT_NE(cmake->find("VERSION " + std::string(kVersion) + " "), std::string::npos);
}

TEST(Sha256, OfTheStandardsExample) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace anthesis
