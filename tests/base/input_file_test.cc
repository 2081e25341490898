// SPDX-License-Identifier: MIT
/// What may be read as input: regular files only.
#include "fabseq/base/input_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

namespace fabseq {
namespace {

class InputFileTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("fabseq_input_file_" + std::to_string(getpid()));
};

TEST_F(InputFileTest, TakesRegularFilesAndLinksToThem) {
  const std::filesystem::path file = folder / "file", link = folder / "link";
  std::ofstream(file) << "text";
  std::filesystem::create_symlink(file, link);
  EXPECT_EQ(reading_problem(file), "");
  EXPECT_EQ(reading_problem(link), "");
}

TEST_F(InputFileTest, SaysWhatElseItIs) {
  const std::filesystem::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(reading_problem(pipe), "is no regular file");
  EXPECT_EQ(reading_problem("/dev/zero"), "is no regular file");
  EXPECT_EQ(reading_problem(folder), "is a directory");
  EXPECT_EQ(reading_problem(folder / "nothing"), "No such file or directory");
}

}  // namespace
}  // namespace fabseq
