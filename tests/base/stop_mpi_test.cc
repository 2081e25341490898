// SPDX-License-Identifier: MIT
/// Requests to stop reach all ranks, and say what they were.
#include "fabseq/base/error.h"
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "support/io_support.h"

#include <csignal>
#include <ctime>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace fabseq {
namespace {

using test::error_text;
using test::is_first;

bool is_last() { return rank_of(PETSC_COMM_WORLD) == size_of(PETSC_COMM_WORLD) - 1; }

void wait(double seconds) {
  const auto whole = static_cast<time_t>(seconds);
  const timespec time{whole, static_cast<long>((seconds - static_cast<double>(whole)) * 1e9)};
  (void)nanosleep(&time, nullptr);
}

std::string reason() {
  return error_text<Stopped>([] { stop_if_requested(PETSC_COMM_WORLD); });
}

TEST(Stop, NobodyAsks) {
  EXPECT_FALSE(stop_requested());
  EXPECT_NO_THROW(stop_if_requested(PETSC_COMM_WORLD));
  const StopRequests requests(std::nullopt);
  EXPECT_FALSE(stop_requested());
  EXPECT_NO_THROW(stop_if_requested(PETSC_COMM_WORLD));
}

TEST(Stop, ASignalToOneRankStopsAll) {
  for (const auto& [signal, name] :
       {std::pair(SIGUSR1, "USR1"), std::pair(SIGUSR2, "USR2"), std::pair(SIGTERM, "TERM"),
        std::pair(SIGINT, "INT"), std::pair(SIGHUP, "HUP"), std::pair(SIGXCPU, "XCPU"),
        std::pair(SIGPIPE, "PIPE")}) {
    const StopRequests requests(std::nullopt);
    if (is_last()) (void)raise(signal);
    EXPECT_EQ(stop_requested(), is_last());
    EXPECT_EQ(reason(), std::string("stopped by signal ") + name);
    EXPECT_EQ(reason(), std::string("stopped by signal ") + name) << "it does not pass";
  }
  EXPECT_FALSE(stop_requested()) << "requests end with their object";
}

TEST(Stop, TheSameSignalTwiceAtOnceIsOneRequest) {
  const StopRequests requests(std::nullopt);
  for (int i = 0; i < 3; ++i) (void)raise(SIGUSR1);
  EXPECT_EQ(reason(), "stopped by signal USR1");
}

/// Linux sends XCPU every second once the time is over, a logout sends HUP, then TERM, and mpirun repeats
/// TERM.
TEST(Stop, WhatTheSystemSendsAgainLeavesNobody) {
  const StopRequests requests(std::nullopt);
  for (const int signal : {SIGXCPU, SIGHUP, SIGPIPE, SIGTERM, SIGXCPU, SIGHUP, SIGPIPE, SIGTERM}) {
    (void)raise(signal);
    wait(0.11);
  }
  EXPECT_EQ(reason(), "stopped by signal XCPU");
}

TEST(Stop, WhatIsIgnoredStaysSo) {
  for (const int signal : {SIGHUP, SIGXCPU, SIGPIPE}) {
    (void)std::signal(signal, SIG_IGN);
    {
      const StopRequests requests(std::nullopt);
      (void)raise(signal);
      EXPECT_FALSE(stop_requested());
    }
    EXPECT_EQ(std::signal(signal, SIG_DFL), SIG_IGN);
  }
}

/// `ulimit -t` of a shell sets the limit that warns and the one that kills to one value.
TEST(Stop, ALimitOfCpuTimeWarnsFirst) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_CPU, &before), 0);
  if (before.rlim_max != RLIM_INFINITY) GTEST_SKIP() << "the tests themselves have a limit of CPU time";
  const auto soft_limit_of = [](rlim_t soft, rlim_t hard) {
    const std::string text = std::to_string(soft) + ' ' + std::to_string(hard);
    const pid_t child = fork();
    if (child == 0) {
      const rlimit limit{soft, hard};
      (void)setrlimit(RLIMIT_CPU, &limit);
      const StopRequests requests(std::nullopt);
      rlimit now{};
      (void)getrlimit(RLIMIT_CPU, &now);
      std::_Exit(now.rlim_max == hard ? static_cast<int>((hard - now.rlim_cur)) : 255);
    }
    int status = -1;
    EXPECT_EQ(waitpid(child, &status, 0), child) << text;
    return WEXITSTATUS(status);
  };
  EXPECT_EQ(soft_limit_of(100000, 100000), 60);
  EXPECT_EQ(soft_limit_of(400, 400), 41);
  EXPECT_EQ(soft_limit_of(99800, 100000), 200) << "it was warned anyway";
}

TEST(Stop, ATooLargeFileIsAFailedWrite) {
  const StopRequests requests(std::nullopt);
  (void)raise(SIGXFSZ);
  EXPECT_FALSE(stop_requested());
}

TEST(StopDeathTest, ASecondSignalLeavesAtOnce) {
  if (size_of(PETSC_COMM_WORLD) > 1) GTEST_SKIP() << "ranks: needs a process of its own";
  testing::FLAGS_gtest_death_test_style = "fast";
  EXPECT_EXIT(
      {
        const StopRequests requests(std::nullopt);
        (void)raise(SIGUSR1);
        wait(0.2);
        (void)raise(SIGINT);
        std::_Exit(0);
      },
      testing::KilledBySignal(SIGINT), "");
}

TEST(Stop, TimeLimit) {
  const StopRequests later(1e6);
  EXPECT_NO_THROW(stop_if_requested(PETSC_COMM_WORLD));
  const StopRequests now(1e-6);
  EXPECT_EQ(reason(), "stopped: -max_wall_time is over");
}

TEST(Stop, AFile) {
  const test::ScratchDirectory scratch;
  const StopRequests requests(std::nullopt);
  const StopFile stop_file(PETSC_COMM_WORLD, scratch.file("stop"));
  note_iterations(0);
  EXPECT_NO_THROW(stop_if_requested(PETSC_COMM_WORLD));
  remove_stop_files();
  if (is_first()) std::ofstream(scratch.file("stop")) << "";
  note_iterations(1);
  EXPECT_EQ(stop_requested(), is_first());
  EXPECT_EQ(reason(), "stopped by the file 'stop' in the output directory");
  remove_stop_files();
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_FALSE(std::filesystem::exists(scratch.file("stop")));
}

TEST(Stop, AFileIsSeenWithoutANewIteration) {
  const test::ScratchDirectory scratch;
  const StopRequests requests(std::nullopt);
  const StopFile stop_file(PETSC_COMM_WORLD, scratch.file("stop"));
  note_iterations(3);
  if (is_first()) std::ofstream(scratch.file("stop")) << "now\n";
  wait(1.1);
  EXPECT_EQ(reason(), "stopped by the file 'stop' in the output directory");
}

TEST(Stop, AFileThatWaitsForAnIteration) {
  const test::ScratchDirectory scratch;
  const StopRequests requests(std::nullopt);
  const StopFile stop_file(PETSC_COMM_WORLD, scratch.file("stop"));
  if (is_first()) std::ofstream(scratch.file("stop")) << "12\n";
  for (int done = 9; done < 12; ++done) {
    note_iterations(done);
    EXPECT_NO_THROW(stop_if_requested(PETSC_COMM_WORLD)) << done;
  }
  note_iterations(12);
  EXPECT_EQ(reason(), "stopped by the file 'stop' in the output directory");
}

TEST(Stop, ANumberThatIsWrittenALittleAfterItsFile) {
  const test::ScratchDirectory scratch;
  const StopRequests requests(std::nullopt);
  const StopFile stop_file(PETSC_COMM_WORLD, scratch.file("stop"));
  std::ofstream file;
  if (is_first()) file.open(scratch.file("stop"));
  std::thread writer([&file] {
    wait(0.02);
    file << "12\n" << std::flush;
  });
  note_iterations(11);
  writer.join();
  EXPECT_NO_THROW(stop_if_requested(PETSC_COMM_WORLD));
  note_iterations(12);
  EXPECT_EQ(reason(), "stopped by the file 'stop' in the output directory");
}

/// A pipe that nobody reads: nothing waits for it once the run shall stop, and what there was room for is
/// whole.
TEST(StandardStreams, AFullPipeDoesNotKeepFromStopping) {
  const StopRequests requests(std::nullopt);
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
  ASSERT_GT(fcntl(ends[1], F_SETPIPE_SZ, 4096), 0);
  write_text(ends[1], "first\n");
  (void)raise(SIGUSR1);
  const auto start = MPI_Wtime();
  write_text(ends[1], std::string(100000, 'x'));
  write_text(ends[1], "last\n");
  EXPECT_LT(MPI_Wtime() - start, 60.0);
  EXPECT_EQ(fcntl(ends[1], F_GETFL) & O_NONBLOCK, 0) << "the pipe itself has been changed";
  std::string found(8192, ' ');
  found.resize(static_cast<std::size_t>(read(ends[0], found.data(), found.size())));
  EXPECT_EQ(found.substr(0, 7), "first\nx");
  (void)close(ends[0]);
  (void)close(ends[1]);
}

TEST(StandardStreams, OtherwiseItWaitsForTheReader) {
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
  ASSERT_GT(fcntl(ends[1], F_SETPIPE_SZ, 4096), 0);
  const std::string text(100000, 'y');
  std::string found;
  std::thread reader([&] {
    std::string piece(1000, ' ');
    while (found.size() < text.size()) {
      wait(0.002);
      const ssize_t got = read(ends[0], piece.data(), piece.size());
      if (got <= 0) break;
      found.append(piece, 0, static_cast<std::size_t>(got));
    }
  });
  write_text(ends[1], text);
  reader.join();
  EXPECT_EQ(found, text);
  (void)close(ends[0]);
  (void)close(ends[1]);
}

TEST(Stop, Durations) {
  EXPECT_EQ(parse_duration("5400"), 5400.0);
  EXPECT_EQ(parse_duration("0.5"), 0.5);
  EXPECT_EQ(parse_duration("1:30:00"), 5400.0);
  EXPECT_EQ(parse_duration("100:0:1.5"), 360001.5);
  for (const char* wrong :
       {"", "0", "-1", "1:30", "1:2:3:4", "1:30:", ":1:30", "1h", "nan", "inf", "0:0:0", "1 2"})
    EXPECT_FALSE(parse_duration(wrong)) << wrong;
}

}  // namespace
}  // namespace fabseq
