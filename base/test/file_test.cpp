#include "anthesis/base/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

namespace anthesis {
namespace {

namespace fs = std::filesystem;

class FileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("anthesis-file-test-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

TEST_F(FileTest, WritesWhatIsReadBackAndLeavesNoTemporaryFile) {
  const std::string bytes("a\0b\n", 4);
  EXPECT_FALSE(write_file(path("x"), "old and longer"));
  EXPECT_FALSE(write_file(path("x"), bytes));
  const Expected<std::string> read = read_file(path("x"), 100);
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, bytes);
  EXPECT_EQ(entries(), 1u);
}

TEST_F(FileTest, AFileWrittenInPiecesAppearsOnlyWhenItIsFinished) {
  EXPECT_FALSE(write_file(path("x"), "old"));
  {
    Expected<FileWriter> writer = FileWriter::create(path("x"));
    ASSERT_TRUE(writer);
    EXPECT_FALSE(writer->write("first, "));
    EXPECT_EQ(*read_file(path("x"), 100), "old");
    EXPECT_FALSE(writer->write("second"));
    EXPECT_FALSE(writer->finish());
    EXPECT_EQ(*read_file(path("x"), 100), "first, second");
  }
  {
    Expected<FileWriter> given_up = FileWriter::create(path("x"));
    ASSERT_TRUE(given_up);
    EXPECT_FALSE(given_up->write("half"));
  }
  EXPECT_EQ(*read_file(path("x"), 100), "first, second");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(FileTest, WhatAKilledProgramOfTheSameNumberLeftBehindIsInNobodysWay) {
  std::string temporary;
  {
    Expected<FileWriter> writer = FileWriter::create(path("x"));
    ASSERT_TRUE(writer);
    temporary = fs::directory_iterator(folder_)->path().filename().string();
  }
  // x.PROCESS-COUNT.part: the next hundred names are taken.
  const std::size_t dash = temporary.rfind('-');
  ASSERT_NE(dash, std::string::npos);
  const int count = std::stoi(temporary.substr(dash + 1));
  for (int i = 1; i <= 100; ++i) {
    std::ofstream(folder_ / (temporary.substr(0, dash + 1) + std::to_string(count + i) + ".part")) << "left";
  }
  EXPECT_FALSE(write_file(path("x"), "mine"));
  EXPECT_EQ(*read_file(path("x"), 100), "mine");
  EXPECT_EQ(entries(), 101u);
}

TEST_F(FileTest, AFullDiskIsAnErrorAndTheDeviceStays) {
  const auto error = write_file("/dev/full", "x");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::kIo);
  EXPECT_NE(error->message.find("No space left"), std::string::npos) << error->message;
  struct stat status {};
  ASSERT_EQ(::stat("/dev/full", &status), 0);
  EXPECT_TRUE(S_ISCHR(status.st_mode));
}

TEST_F(FileTest, AMissingFolderIsAnErrorThatNamesThePath) {
  const auto error = write_file(path("none/x"), "x");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::kIo);
  EXPECT_NE(to_string(*error).find("none/x"), std::string::npos);
}

TEST_F(FileTest, ALargeFileIsRefusedWithoutReadingIt) {
  std::ofstream(path("big")) << "123456";
  fs::resize_file(path("big"), std::uintmax_t{1} << 40);  // a hole: reading it would take hours
  const Expected<std::string> read = read_file(path("big"), 1000);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kTooLarge);
}

TEST_F(FileTest, AnEndlessFileIsRefusedAtTheLimit) {
  const Expected<std::string> read = read_file("/dev/zero", 1000);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kTooLarge);
}

TEST_F(FileTest, AFolderOrAMissingFileIsAnInputError) {
  EXPECT_EQ(read_file(folder_.string(), 10).error().code, ErrorCode::kIo);
  EXPECT_EQ(read_file(path("absent"), 10).error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace anthesis
