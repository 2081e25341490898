// SPDX-License-Identifier: MIT
/// One run at a time in a directory, on file systems with and without locks.
#include "fabseq/files/run_lock.h"

#include "fabseq/base/error.h"
#include "faults/no_locks.cc"
#include "support/io_support.h"
#include "support/refusal.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <memory>
#include <poll.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace fabseq {
namespace {

/// Short, because other processes wait for as long as its patience.
constexpr Pulse quick{std::chrono::milliseconds(200), std::chrono::milliseconds(2000)};
/// Longer than any pause of a busy machine: a lock that nobody waits for is taken sooner.
constexpr Pulse patient{std::chrono::milliseconds(200), std::chrono::minutes(2)};

/// A process that holds a lock until it is killed.
class Holder {
 public:
  explicit Holder(const std::string& folder) {
    int ready[2];
    EXPECT_EQ(::pipe(ready), 0);
    process_ = ::fork();
    if (process_ == 0) hold(folder, ready[1]);
    char byte;
    EXPECT_EQ(::read(ready[0], &byte, 1), 1);
    (void)::close(ready[0]);
    (void)::close(ready[1]);
  }
  Holder(Holder&&) = delete;
  ~Holder() { kill(); }

  std::string name() const { return "process " + std::to_string(process_); }
  void kill() {
    if (process_ > 0) {
      (void)::kill(process_, SIGKILL);
      (void)::waitpid(process_, nullptr, 0);
    }
    process_ = -1;
  }
  /// Kills the process, of which a zombie is left.
  void kill_without_asking() const {
    (void)::kill(process_, SIGKILL);
    siginfo_t ignored;
    (void)::waitid(P_PID, process_, &ignored, WEXITED | WNOWAIT);
  }

 private:
  [[noreturn]] static void hold(const std::string& folder, int ready) {
    const RunLock lock(folder, quick);
    (void)!::write(ready, "x", 1);
    while (true) ::pause();
  }

  pid_t process_;
};

/// With the calls that are not implemented (no_locks.cc).
class RunLockTest : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    (void)::setenv("NO_LOCKS", GetParam(), 1);
    std::filesystem::create_directory(folder);
  }
  void TearDown() override {
    (void)::unsetenv("NO_LOCKS");
    std::filesystem::remove_all(folder);
  }

  bool has_locks() const { return std::string(GetParam()) != "all"; }
  std::string file() const { return folder / "lock"; }
  std::string refusal(const Pulse& pulse = quick) const {
    return test::refusal([&] { const RunLock second(folder, pulse); });
  }
  /// The warnings of a process that takes the lock and gives it back.
  std::string warnings(const Pulse& pulse = quick) const {
    testing::internal::CaptureStderr();
    EXPECT_EQ(refusal(pulse), "no error");
    return testing::internal::GetCapturedStderr();
  }
  /// Writes the mark of a process of another machine into the file, which stays the same.
  void move_elsewhere() const {
    std::string text = test::file_text(file());
    std::string words = text.substr(text.find('\n') + 1);
    words =
        "elsewhere 1 no-such-boot" + words.substr(words.find(' ', words.find(' ', words.find(' ') + 1) + 1));
    std::ofstream(file()) << "host elsewhere, process 1\n" << words;
  }

  /// For a process of its own: status 0 if it had the lock, which it keeps until the pipe's other end is
  /// closed, and 2 if it was refused.
  [[noreturn]] void take_until_released(const int (&release)[2]) const {
    (void)::close(release[1]);
    try {
      const RunLock lock(folder, quick);
      pollfd end{release[0], POLLIN, 0};
      (void)::poll(&end, 1, 30000);  // two that have it both wait for this long
    } catch (const InputError&) {
      ::_exit(2);
    }
    ::_exit(0);
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("fabseq_run_lock_" + std::to_string(getpid()));
};

TEST_P(RunLockTest, NamesTheProcessThatHoldsIt) {
  auto lock = std::make_unique<const RunLock>(folder, quick);
  const std::string text = refusal();
  EXPECT_NE(text.find("process " + std::to_string(getpid())), std::string::npos) << text;
  EXPECT_NE(text.find("host "), std::string::npos) << text;
  lock.reset();
  EXPECT_FALSE(std::filesystem::exists(file()));
  EXPECT_EQ(warnings(), "");
}

/// The system gives back what a process held that was killed; its file stays.
TEST_P(RunLockTest, IsTakenOverFromADeadProcess) {
  Holder holder(folder);
  EXPECT_NE(refusal().find(holder.name()), std::string::npos);
  holder.kill();
  EXPECT_TRUE(std::filesystem::exists(file()));
  EXPECT_EQ(warnings(), "");
  EXPECT_FALSE(std::filesystem::exists(file()));
}

TEST_P(RunLockTest, IsTakenOverFromAProcessWhoseStatusNobodyAskedFor) {
  const Holder holder(folder);
  holder.kill_without_asking();
  EXPECT_EQ(warnings(), "");
}

TEST_P(RunLockTest, IsTakenOverWhereAnotherProcessHasTheNumber) {
  const std::string text = ProcessMark::own().text();
  const std::string other_start = text.substr(0, text.rfind(' ')) + " 1\n";
  std::ofstream(file()) << other_start;
  EXPECT_EQ(warnings(), "");
}

/// By a process that ended between making the file and writing into it, or by somebody else.
TEST_P(RunLockTest, IsTakenOverFromAFileWithoutAMark) {
  std::ofstream(file()) << (has_locks() ? "something else\n" : "");
  const std::string text = warnings();
  EXPECT_EQ(text.empty(), has_locks());
  EXPECT_EQ(text.find("which did not get far") == std::string::npos, has_locks()) << text;
}

TEST_P(RunLockTest, OfAnotherMachineIsTakenOverWithAWarning) {
  {
    Holder holder(folder);
    move_elsewhere();
    holder.kill();
  }
  const Pulse& pulse = has_locks() ? patient : quick;
  const auto begin = std::chrono::steady_clock::now();
  const std::string text = warnings(pulse);
  const bool has_waited = std::chrono::steady_clock::now() - begin >= pulse.patience;
  EXPECT_EQ(text.find("warning: output directory '" + folder.string() +
                      "': the lock of a run (host elsewhere, process 1)"),
            0)
      << text;
  EXPECT_NE(text.find(has_locks() ? "on another machine" : "has no locks"), std::string::npos) << text;
  EXPECT_NE(text.find("make sure that it has ended"), std::string::npos) << text;
  EXPECT_EQ(has_waited, !has_locks());
}

/// What is there to be seen of a run on another machine: it touches its file.
TEST_P(RunLockTest, OfAnotherMachineIsRefusedWhileItLives) {
  const Holder holder(folder);
  move_elsewhere();
  const std::string text = refusal();
  EXPECT_NE(text.find("in use by a run (host elsewhere, process 1)"), std::string::npos) << text;
}

TEST_P(RunLockTest, IsTakenByOneOfManyThatBeginTogether) {
  constexpr int count = 6;
  for (const bool left_behind : {false, true}) {
    if (left_behind) Holder(folder).kill();
    int release[2];  // whose writing end is closed once all but one have ended
    ASSERT_EQ(::pipe(release), 0);
    for (int process = 0; process < count; ++process)
      if (::fork() == 0) take_until_released(release);
    int taken = 0;
    for (int ended = 1; ended <= count; ++ended) {
      int status = 0;
      EXPECT_GT(::wait(&status), 0);
      EXPECT_TRUE(WIFEXITED(status));
      taken += WEXITSTATUS(status) == 0 ? 1 : 0;
      if (ended == count - 1) (void)::close(release[1]);
    }
    (void)::close(release[0]);
    EXPECT_EQ(taken, 1) << left_behind;
    EXPECT_FALSE(std::filesystem::exists(file()));
  }
}

INSTANTIATE_TEST_SUITE_P(FileSystems, RunLockTest, testing::Values("none", "flock", "all"));

}  // namespace
}  // namespace fabseq
