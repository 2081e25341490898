// SPDX-License-Identifier: MIT
/// One run at a time in a directory.
#include "fabseq/files/run_lock.h"

#include "fabseq/base/error.h"

#include <gtest/gtest.h>

#include "support/refusal.h"
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace fabseq {
namespace {

class RunLockTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::string refusal() {
    return test::refusal([&] { const RunLock second(folder); });
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("fabseq_run_lock_" + std::to_string(getpid()));
};

TEST_F(RunLockTest, NamesTheProcessThatHoldsIt) {
  auto lock = std::make_unique<const RunLock>(folder);
  const std::string text = refusal();
  EXPECT_NE(text.find("process " + std::to_string(getpid())), std::string::npos) << text;
  EXPECT_NE(text.find("host "), std::string::npos) << text;
  lock.reset();
  EXPECT_FALSE(std::filesystem::exists(folder / "lock"));
  EXPECT_EQ(refusal(), "no error");
}

/// The system gives back what a process held that was killed; its file stays.
TEST_F(RunLockTest, IsTakenOverFromADeadProcess) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const RunLock lock(folder);
    (void)!::write(ready[1], "x", 1);
    while (true) ::pause();
  }
  char byte;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_NE(refusal().find("process " + std::to_string(child)), std::string::npos);
  ASSERT_EQ(::kill(child, SIGKILL), 0);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_TRUE(std::filesystem::exists(folder / "lock"));
  EXPECT_EQ(refusal(), "no error");
  (void)::close(ready[0]);
  (void)::close(ready[1]);
}

}  // namespace
}  // namespace fabseq
