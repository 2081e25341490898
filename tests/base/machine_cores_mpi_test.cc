// SPDX-License-Identifier: MIT
/// Cores that ranks may use, and how busy they are, beside threads that the test itself picks and keeps busy.
#include "base/busy_time.h"
#include "base/core_count.h"
#include "fabseq/base/machine_cores.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/petsc.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <sched.h>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

ThreadSet threads(std::initializer_list<int> numbers) {
  ThreadSet result;
  for (const int number : numbers) result.add(number);
  return result;
}

/// For its lifetime hwloc sees this machine, described in its own words.
class MadeUpMachine {
 public:
  explicit MadeUpMachine(const char* description) {
    if (const char* before = std::getenv(components)) before_ = before;
    ::setenv(components, "synthetic,-gl", 1);
    ::setenv("HWLOC_SYNTHETIC", description, 1);
  }
  MadeUpMachine(MadeUpMachine&&) = delete;
  ~MadeUpMachine() {
    ::unsetenv("HWLOC_SYNTHETIC");
    ::unsetenv(components);
    if (before_) ::setenv(components, before_->c_str(), 1);
  }

 private:
  static constexpr const char* components = "HWLOC_COMPONENTS";
  std::optional<std::string> before_;
};

/// For its lifetime the process runs on these threads only.
class Bound {
 public:
  explicit Bound(std::initializer_list<int> numbers) {
    ::sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t own;
    CPU_ZERO(&own);
    for (const int number : numbers) CPU_SET(number, &own);
    ::sched_setaffinity(0, sizeof own, &own);
  }
  Bound(Bound&&) = delete;
  ~Bound() { ::sched_setaffinity(0, sizeof before_, &before_); }

 private:
  cpu_set_t before_{};
};

/// Numbers of the first threads that this process may run on.
std::vector<int> own_threads() {
  std::vector<int> result;
  const ThreadSet own = threads_of_process();
  for (int thread = 0; thread < ThreadSet::most; ++thread)
    if (own.has(thread)) result.push_back(thread);
  return result;
}

TEST(MachineCores, SetsOfThreadsTakeWhatLinuxNumbers) {
  const ThreadSet some = threads({0, 63, 64, 8191, 8192, -1});
  EXPECT_EQ(some.count(), 4);
  for (const int in : {0, 63, 64, 8191}) EXPECT_TRUE(some.has(in)) << in;
  for (const int out : {1, 8192, -1}) EXPECT_FALSE(some.has(out)) << out;
  EXPECT_GE(threads_of_process().count(), 1);
}

/// Two packages of two cores with two threads, which Linux may number core by core.
TEST(MachineCores, CoresAreNotThreads) {
  const MadeUpMachine machine("package:2 core:2 pu:2");
  const auto counts = [](std::initializer_list<int> numbers) {
    const CoreCount count = count_cores(threads(numbers));
    return std::pair(count.cores, count.threads);
  };
  EXPECT_EQ(counts({0, 1, 2, 3, 4, 5, 6, 7}), std::pair(4, 8));
  EXPECT_EQ(counts({0, 1}), std::pair(1, 2));
  EXPECT_EQ(counts({1, 2}), std::pair(2, 2));
  EXPECT_EQ(counts({7, 100}), std::pair(1, 1));
  EXPECT_EQ(counts({100, 101}), std::pair(2, 2));  // hwloc does not know them: each counts as a core
}

TEST(MachineCores, EachThreadIsACoreWhereHwlocSeesNone) {
  const MadeUpMachine machine("pu:4");
  EXPECT_EQ(count_cores(threads({0, 1, 2})).cores, 3);
}

TEST(MachineCores, AllRanksOfANodeCountTogether) {
  const NodeCores cores = fewest_cores(PETSC_COMM_WORLD);
  EXPECT_GE(cores.cores, 1);
  EXPECT_GE(cores.threads, cores.cores);
  EXPECT_EQ(cores.ranks, size_of(PETSC_COMM_WORLD));
  EXPECT_EQ(cores.nodes, 1);
  EXPECT_LE(cores.per_rank(), 1.0);
  EXPECT_GT(cores.per_rank(), 0.0);
}

/// As a launcher binds its ranks: each to a core, or all to one.
TEST(MachineCores, BoundRanksHaveTheCoresOfAllOfThem) {
  const MadeUpMachine machine("core:8 pu:1");
  const std::vector<int> own = own_threads();
  const int ranks = size_of(PETSC_COMM_WORLD), rank = rank_of(PETSC_COMM_WORLD);
  {
    const Bound bound({own[0]});
    const NodeCores cores = fewest_cores(PETSC_COMM_WORLD);
    EXPECT_EQ(cores.cores, 1);
    EXPECT_DOUBLE_EQ(cores.per_rank(), 1.0 / ranks);
  }
  if (own.size() < 2) return;
  const Bound bound({own[rank % 2]});
  const NodeCores cores = fewest_cores(PETSC_COMM_WORLD);
  EXPECT_EQ(cores.cores, std::min(ranks, 2));
  EXPECT_EQ(cores.threads, std::min(ranks, 2));
}

TEST(MachineCores, BusyTimeIsThatOfTheThreadsAsked) {
  const std::string before =
      "cpu  1000 0 1000 1000 0 0 0 0 0 0\n"
      "cpu0 100 10 50 1000 20 1 2 3 0 0\n"
      "cpu1 100 10 50 1000 20 1 2 3 0 0\n"
      "cpu2 100 10 50 1000\n"
      "intr 7\n";
  const std::string after =
      "cpu  9000 0 9000 9000 0 0 0 0 0 0\n"
      "cpu0 101 11 51 1005 19 2 3 4 9 9\n"  // six busy, four idle; what waits for disks may run backwards
      "cpu1 100 10 50 1010 20 1 2 3 0 0\n"
      "cpu2 105 10 55 1000\n"
      "intr 8\n";
  const auto share = [&](std::initializer_list<int> numbers) {
    return busy_share_between(before, after, threads(numbers)).value_or(-1.0);
  };
  EXPECT_DOUBLE_EQ(share({0}), 0.6);
  EXPECT_DOUBLE_EQ(share({1}), 0.0);
  EXPECT_DOUBLE_EQ(share({2}), 1.0);
  EXPECT_DOUBLE_EQ(share({0, 1}), 0.3);
  EXPECT_EQ(share({3}), -1.0);
  EXPECT_FALSE(busy_share_between("", after, threads({0})));
  EXPECT_FALSE(busy_share_between(after, after, threads({0})));
}

TEST(MachineCores, LookingHowBusyTakesATenthOfASecond) {
  MPI_Barrier(PETSC_COMM_WORLD);
  const auto start = std::chrono::steady_clock::now();
  const std::optional<double> busy = busy_share(PETSC_COMM_WORLD);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  ASSERT_TRUE(busy);
  EXPECT_GE(*busy, 0.0);
  EXPECT_LE(*busy, 1.0);
  EXPECT_GE(taken.count(), 0.08);
  EXPECT_LT(taken.count(), 2.0);  // a busy machine is no failure
}

TEST(MachineCores, TheFullestNodeHasTheFewestCoresPerRank) {
  const NodeCores roomy{4, 8, 1, 3}, even{64, 128, 64, 3}, crowded{32, 64, 64, 3};
  const auto cores_of_fullest = [](std::initializer_list<NodeCores> nodes) {
    return fullest(std::vector<NodeCores>(nodes)).cores;
  };
  EXPECT_EQ(cores_of_fullest({roomy, even, crowded}), 32);
  EXPECT_EQ(cores_of_fullest({crowded, roomy}), 32);
  EXPECT_EQ(cores_of_fullest({roomy, even}), 64);
  EXPECT_DOUBLE_EQ(crowded.per_rank(), 0.5);
  EXPECT_DOUBLE_EQ(even.per_rank(), 1.0);
  EXPECT_DOUBLE_EQ(roomy.per_rank(), 1.0);
}

TEST(MachineCores, ALimitOfTimeCountsLikeFewerCores) {
  const NodeCores half{2, 4, 1, 1, 0.5}, shared{8, 16, 4, 1, 2.0}, enough{2, 4, 2, 1, 8.0};
  EXPECT_DOUBLE_EQ(half.per_rank(), 0.5);
  EXPECT_DOUBLE_EQ(shared.per_rank(), 0.5);
  EXPECT_DOUBLE_EQ(enough.per_rank(), 1.0);
  EXPECT_EQ(fullest(std::vector<NodeCores>{enough, shared}).ranks, 4);
}

TEST(MachineCores, TextNamesWhatThereIs) {
  EXPECT_EQ(machine_text({2, 4, 2, 1}, 0.354), "2 cores (4 threads) for 2 ranks, 35 % busy");
  EXPECT_EQ(machine_text({1, 1, 1, 1}, std::nullopt), "1 core (1 thread) for 1 rank");
  EXPECT_EQ(machine_text({64, 128, 64, 3}, 0.0),
            "3 nodes, the fullest with 64 cores (128 threads) for 64 ranks, 0 % busy");
  EXPECT_EQ(
      machine_text({2, 4, 1, 1, 0.5}, 0.0),
      "2 cores (4 threads), but the time of 0.5 (a limit of the container or the job), for 1 rank, 0 % busy");
  EXPECT_EQ(machine_text({2, 4, 1, 1, 8.0}, 0.0), "2 cores (4 threads) for 1 rank, 0 % busy");
}

}  // namespace
}  // namespace fabseq
