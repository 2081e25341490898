// SPDX-License-Identifier: MIT
/// Who holds which elements of a level, on any number of ranks.
#include "ranks/level_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

namespace fabseq {
namespace {

Decomposition<3> even_ranges(const Index<3>& elements, const Index<3>& processes) {
  Decomposition<3> result;
  result.processes = processes;
  for (int axis = 0; axis < 3; ++axis)
    for (int process = 0; process <= processes[axis]; ++process)
      result.range_starts[axis].push_back(elements[axis] * process / processes[axis]);
  return result;
}

constexpr Index<3> halves{2, 2, 2};

TEST(LevelShares, AllRanksHoldTheFinest) {
  const auto shares = LevelShares<3>::finest(even_ranges({12, 8, 20}, {3, 2, 5}));
  EXPECT_EQ(shares.count(), 30);
  for (int rank = 0; rank < 30; ++rank) EXPECT_EQ(shares.process_of(rank), rank);
  EXPECT_EQ(shares.process_of(30), -1);
}

TEST(LevelShares, StayInPlaceWhereAllBeginOnTheCoarseGrid) {
  const auto shares = LevelShares<3>::finest(even_ranges({40, 40, 40}, {2, 2, 2}));
  const auto coarse = shares.coarsened(halves, 64000);
  EXPECT_EQ(coarse.ranks, shares.ranks);
  EXPECT_TRUE(shares.stay_in_place(coarse, halves));
  for (int process = 0; process < 8; ++process) {
    EXPECT_EQ(coarse.elements_of(process).start, shares.elements_of(process).coarsened(halves).start);
    EXPECT_EQ(coarse.elements_of(process).size, shares.elements_of(process).coarsened(halves).size);
  }
  const auto odd = LevelShares<3>::finest(even_ranges({40, 40, 42}, {2, 2, 2}));
  EXPECT_FALSE(odd.stay_in_place(odd.coarsened(halves, 64000), halves));
}

/// 64 ranks, whose 8000 elements of the next level are for 16 of them: the shortest ranges are joined first.
TEST(LevelShares, HalveTheRanksWhereTheyHaveTooLittle) {
  const auto shares = LevelShares<3>::finest(even_ranges({40, 40, 80}, {4, 4, 4}));
  const auto coarse = shares.coarsened(halves, 64000);
  EXPECT_EQ(coarse.ranges.processes, (Index<3>{2, 2, 4}));
  EXPECT_EQ(coarse.ranks, (std::vector<int>{0, 2, 8, 10, 16, 18, 24, 26, 32, 34, 40, 42, 48, 50, 56, 58}));
  EXPECT_EQ(coarse.ranges.range_starts[0], (std::vector<int>{0, 10, 20}));
  const auto next = coarse.coarsened(halves, 8000);
  EXPECT_EQ(next.count(), 2);
  EXPECT_EQ(next.coarsened(halves, 1000).ranks, std::vector<int>{0});
}

TEST(LevelShares, AnOddRankGoesOnAlone) {
  const auto shares = LevelShares<3>::finest(even_ranges({50, 8, 8}, {5, 1, 1}));
  const auto coarse = shares.coarsened({1, 1, 1}, 1200);
  EXPECT_EQ(coarse.ranks, (std::vector<int>{0, 2, 4}));
  EXPECT_EQ(coarse.ranges.range_starts[0], (std::vector<int>{0, 20, 40, 50}));
}

/// Whatever the ranges, each element of the next level has a holder, which holds part of the finer level.
TEST(LevelShares, EveryElementHasAHolder) {
  for (const Index<3>& elements : {Index<3>{37, 11, 23}, Index<3>{5, 5, 60}, Index<3>{7, 7, 7}})
    for (const Index<3>& processes : {Index<3>{4, 2, 3}, Index<3>{5, 5, 1}, Index<3>{1, 1, 7}})
      for (const std::int64_t active : {100, 2000, 100000}) {
        auto shares = LevelShares<3>::finest(even_ranges(elements, processes));
        for (int level = 0; level < 3; ++level) {
          const auto coarse = shares.coarsened(halves, active >> (3 * level));
          std::int64_t held = 0;
          for (int process = 0; process < coarse.count(); ++process) {
            EXPECT_GE(shares.process_of(coarse.ranks[process]), 0);
            const auto box = coarse.elements_of(process);
            EXPECT_GT(box.count(), 0);
            held += box.count();
            box.for_each([&](const Index<3>& element, std::int64_t) {
              EXPECT_EQ(coarse.holder_of(element), process);
            });
          }
          std::int64_t all = 1;
          for (int axis = 0; axis < 3; ++axis) all *= (shares.ranges.range_starts[axis].back() + 1) / 2;
          EXPECT_EQ(held, all);
          EXPECT_EQ(std::set<int>(coarse.ranks.begin(), coarse.ranks.end()).size(), coarse.ranks.size());
          shares = coarse;
        }
      }
}

}  // namespace
}  // namespace fabseq
