// SPDX-License-Identifier: MIT
/// Balance of the decomposition against brute force over all splits, and on shapes with known answers.
#include "fabseq/base/mpi.h"
#include "fabseq/grid/decomposition.h"
#include "support/refusal.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace fabseq {
namespace {

double heaviest_range(const std::vector<double>& weights, const std::vector<int>& starts) {
  double heaviest = 0.0;
  for (std::size_t part = 0; part + 1 < starts.size(); ++part)
    heaviest = std::max(
        heaviest, std::accumulate(weights.begin() + starts[part], weights.begin() + starts[part + 1], 0.0));
  return heaviest;
}

/// Smallest heaviest range by trying everything.
double best_split(const std::vector<double>& weights, int start, int parts) {
  const int count = static_cast<int>(weights.size());
  if (parts == 1) return std::accumulate(weights.begin() + start, weights.end(), 0.0);
  double best = 1e300, here = 0.0;
  for (int end = start + 1; end <= count - parts + 1; ++end) {
    here += weights[end - 1];
    best = std::min(best, std::max(here, best_split(weights, end, parts - 1)));
  }
  return best;
}

TEST(SplitEvenly, IsOptimalAndLeavesNoRangeEmpty) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int trial = 0; trial < 200; ++trial) {
    const int count = 1 + trial % 11;
    std::vector<double> weights(static_cast<std::size_t>(count));
    for (double& weight : weights) weight = uniform(random) < 0.3 ? 0.0 : uniform(random);
    if (trial % 7 == 0) std::fill(weights.begin(), weights.end(), 1.0);
    for (int parts = 1; parts <= count; ++parts) {
      const std::vector<int> starts = split_evenly(weights, parts);
      EXPECT_EQ(starts.size(), static_cast<std::size_t>(parts) + 1);
      EXPECT_EQ(starts.front(), 0);
      EXPECT_EQ(starts.back(), count);
      for (int part = 0; part < parts; ++part) EXPECT_LT(starts[part], starts[part + 1]);
      EXPECT_NEAR(heaviest_range(weights, starts), best_split(weights, 0, parts), 1e-9);
    }
  }
}

TEST(SplitEvenly, SpreadsEqualWeights) {
  EXPECT_EQ(split_evenly(std::vector<double>(10, 1.0), 4), (std::vector<int>{0, 2, 5, 7, 10}));
  EXPECT_EQ(split_evenly(std::vector<double>(12, 0.1), 3), (std::vector<int>{0, 4, 8, 12}));
}

TEST(Decomposition, ListsTheProcessGridsThatFit) {
  EXPECT_EQ(fitting_process_grids<2>(6, {3, 2}), (std::vector<Index<2>>{{3, 2}}));
  EXPECT_EQ(fitting_process_grids<2>(6, {6, 3}).size(), 3u);  // 6x1, 3x2, 2x3
  EXPECT_EQ(fitting_process_grids<3>(8, {100, 100, 100}).size(), 10u);
  EXPECT_TRUE(fitting_process_grids<3>(7, {6, 6, 6}).empty());
}

TEST(Decomposition, RankOrderHasXFastest) {
  Decomposition<3> d;
  d.processes = {2, 3, 4};
  EXPECT_EQ(d.rank_at({1, 2, 3}), 1 + 2 * (2 + 3 * 3));
  EXPECT_EQ(d.position_of(23), (Index<3>{1, 2, 3}));
}

template <int Dim>
double heaviest_rank(const Decomposition<Dim>& decomposition, const ElementWeights<Dim>& weights, int ranks) {
  double heaviest = 0.0;
  for (int rank = 0; rank < ranks; ++rank) {
    const std::vector<double> own = weights(decomposition.elements_of(decomposition.position_of(rank)));
    heaviest = std::max(heaviest, std::accumulate(own.begin(), own.end(), 0.0));
  }
  return heaviest;
}

/// An L: weight 1 below z = 6 and beyond x = 12, else 0.1.
template <int Dim>
std::vector<double> l_shape(const IndexBox<Dim>& box) {
  std::vector<double> weights(static_cast<std::size_t>(box.count()));
  box.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    weights[offset] = element[Dim - 1] < 6 || element[0] >= 12 ? 1.0 : 0.1;
  });
  return weights;
}

TEST(Decomposition, BalancesAnExtrudedLExactly) {
  const MPI_Comm comm = PETSC_COMM_WORLD;
  const int ranks = size_of(comm);
  const Index<3> elements{20, 12, 20};
  const auto decomposition = choose_decomposition<3>(comm, size_of(comm), elements, l_shape<3>);
  const std::vector<double> all = l_shape<3>({{}, elements});
  const double mean = std::accumulate(all.begin(), all.end(), 0.0) / ranks;
  // Cutting the extrusion gives every rank the same; within the tie of 1 % another cut may win.
  EXPECT_LE(heaviest_rank<3>(decomposition, l_shape<3>, ranks), 1.01 * mean * (1 + 1e-12));
}

TEST(Decomposition, IsNoWorseThanEqualRangesOnAPlaneL) {
  const MPI_Comm comm = PETSC_COMM_WORLD;
  const int ranks = size_of(comm);
  const Index<2> elements{20, 20};
  const auto decomposition = choose_decomposition<2>(comm, size_of(comm), elements, l_shape<2>);
  double best_equal = 1e300;
  for (const Index<2>& grid : fitting_process_grids<2>(ranks, elements)) {
    Decomposition<2> equal;
    equal.processes = grid;
    for (int axis = 0; axis < 2; ++axis)
      for (int p = 0; p <= grid[axis]; ++p)
        equal.range_starts[axis].push_back(elements[axis] * p / grid[axis]);
    best_equal = std::min(best_equal, heaviest_rank<2>(equal, l_shape<2>, ranks));
  }
  EXPECT_LE(heaviest_rank<2>(decomposition, l_shape<2>, ranks), 1.01 * best_equal);
}

TEST(Decomposition, PrefersLittleSurfaceAmongEquals) {
  const MPI_Comm comm = PETSC_COMM_WORLD;
  // Ranges begin at multiples of 4, which divide these counts evenly.
  const auto decomposition = choose_decomposition<3>(comm, size_of(comm), {96, 40, 64}, nullptr);
  const std::vector<Index<3>> expected = {{1, 1, 1}, {2, 1, 1}, {3, 1, 1}, {2, 1, 2}};
  if (size_of(comm) > 4) GTEST_SKIP() << "ranks: written for up to 4 ranks";
  EXPECT_EQ(decomposition.processes, expected[size_of(comm) - 1]);
}

TEST(Decomposition, BeginsOnCoarseGridsWhereThereIsRoom) {
  const MPI_Comm comm = PETSC_COMM_WORLD;
  const auto decomposition = choose_decomposition<3>(comm, size_of(comm), {83, 41, 19}, nullptr);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<int>& starts = decomposition.range_starts[axis];
    const int count = starts.back(), processes = static_cast<int>(starts.size()) - 1;
    const int block = count >= 16 * processes ? 4 : count >= 6 * processes ? 2 : 1;
    for (int process = 0; process < processes; ++process) EXPECT_EQ(starts[process] % block, 0);
  }
}

/// Blocks grow as far as all ranks hold the level, and cost 2 % at most: ranks of 2,000 elements get the
/// least block, and those of 2,000,000 may get one of 64 elements.
TEST(Decomposition, BeginsAtHighPowersOfTwoWhereRanksHaveMuch) {
  const auto common_factor = [](const Index<3>& elements) {
    const auto decomposition = choose_decomposition<3>(PETSC_COMM_SELF, 5, elements, nullptr);
    int common = 0;
    for (const auto& starts : decomposition.range_starts)
      for (std::size_t process = 1; process + 1 < starts.size(); ++process) common |= starts[process];
    return common & -common;
  };
  EXPECT_EQ(common_factor({100, 10, 10}), 4);
  EXPECT_EQ(common_factor({1590, 78, 78}), 64);  // ranges of 320 rather than of 316 and 320
  EXPECT_EQ(common_factor({1620, 78, 78}), 8);   // 328 rather than 324; 336 would cost too much
}

TEST(Decomposition, AllowsMoreRanksThanLongestAxis) {
  // Slabs of some ranks are empty then.
  const MPI_Comm comm = PETSC_COMM_WORLD;
  if (size_of(comm) != 4) GTEST_SKIP() << "ranks: needs 4";
  const auto decomposition = choose_decomposition<2>(comm, size_of(comm), {2, 2}, [](const IndexBox<2>& box) {
    return std::vector<double>(static_cast<std::size_t>(box.count()), 1.0);
  });
  EXPECT_EQ(decomposition.processes, (Index<2>{2, 2}));
}

TEST(Decomposition, OneRankFindsWhatAllWouldChoose) {
  const int ranks = size_of(PETSC_COMM_WORLD);
  const Index<3> elements{20, 12, 20};
  for (const ElementWeights<3>& weights : {ElementWeights<3>(l_shape<3>), ElementWeights<3>()}) {
    const auto chosen = choose_decomposition<3>(PETSC_COMM_WORLD, ranks, elements, weights);
    const auto found = choose_decomposition<3>(PETSC_COMM_SELF, ranks, elements, weights);
    EXPECT_EQ(found.processes, chosen.processes);
    EXPECT_EQ(found.range_starts, chosen.range_starts);
  }
}

TEST(Decomposition, RefusesTooManyRanks) {
  const MPI_Comm comm = PETSC_COMM_WORLD;
  if (size_of(comm) == 1) GTEST_SKIP() << "ranks: needs several";
  const std::string text = test::refusal([&] {
    (void)choose_decomposition<3>(comm, size_of(comm), {1, 1, 1}, nullptr);
  });
  EXPECT_NE(text.find("/domain/elements: [1,1,1] cannot be dealt out to"), std::string::npos) << text;
}

}  // namespace
}  // namespace fabseq
