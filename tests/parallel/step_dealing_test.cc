// SPDX-License-Identifier: MIT
/// Layers dealt out to groups: every layer once, in blocks as wide as balance allows.
#include "fabseq/parallel/step_dealing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace fabseq {
namespace {

std::vector<double> equal_work(int layers) { return std::vector<double>(layers, 10.0); }

/// Work of each group, added up from its blocks.
std::vector<double> sums(const StepDeal& deal, const std::vector<double>& work, BlockSolver solver) {
  std::vector<double> result;
  for (const auto& blocks : deal.blocks) {
    double sum = 0.0;
    for (const StepBlock& block : blocks)
      sum += block_work(std::span(work).subspan(block.first, block.lanes), solver);
    result.push_back(sum);
  }
  return result;
}

std::vector<int> widths(const StepDeal& deal) {
  std::vector<int> result;
  for (const auto& blocks : deal.blocks)
    for (const StepBlock& block : blocks) result.push_back(block.lanes);
  std::sort(result.begin(), result.end());
  return result;
}

TEST(StepDealingTest, EveryLayerBelongsToOneGroup) {
  for (const BlockSolver solver : {BlockSolver::lanes, BlockSolver::one_by_one})
    for (const int layers : {1, 2, 7, 8, 9, 12, 25, 48, 100})
      for (const int groups : {1, 2, 3, 4, 7, 16}) {
        std::vector<double> work;
        for (int layer = 0; layer < layers; ++layer) work.push_back(1.0 + (layer * 37) % 11);
        const StepDeal deal = deal_out_steps(work, groups, 8, solver);
        ASSERT_EQ(deal.blocks.size(), static_cast<std::size_t>(groups));
        std::vector<int> owners(layers, 0);
        for (const auto& blocks : deal.blocks) {
          int end = 0;
          for (const StepBlock& block : blocks) {
            EXPECT_GE(block.first, end);  // ascending
            EXPECT_GE(block.lanes, 1);
            EXPECT_LE(block.lanes, 8);
            end = block.first + block.lanes;
            for (int layer = block.first; layer < end; ++layer) ++owners[layer];
          }
        }
        EXPECT_EQ(owners, std::vector<int>(layers, 1)) << layers << " on " << groups;
        const auto of_groups = sums(deal, work, solver);
        EXPECT_NEAR(deal.longest, *std::max_element(of_groups.begin(), of_groups.end()), 1e-9);
        EXPECT_NEAR(deal.total, std::accumulate(of_groups.begin(), of_groups.end(), 0.0), 1e-9);
      }
}

TEST(StepDealingTest, OneGroupTakesWholeBlocks) {
  const StepDeal deal = deal_out_steps(equal_work(25), 1, 8, BlockSolver::lanes);
  ASSERT_EQ(deal.blocks[0].size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(deal.blocks[0][i].first, 8 * i);
    EXPECT_EQ(deal.blocks[0][i].lanes, i < 3 ? 8 : 1);
  }
}

TEST(StepDealingTest, BlocksStayWholeWhereTheyBalance) {
  EXPECT_EQ(widths(deal_out_steps(equal_work(16), 2, 8, BlockSolver::lanes)), (std::vector<int>{8, 8}));
  EXPECT_EQ(widths(deal_out_steps(equal_work(48), 3, 8, BlockSolver::lanes)), std::vector<int>(6, 8));
}

TEST(StepDealingTest, BlocksAreHalvedForGroupsWithoutOne) {
  EXPECT_EQ(widths(deal_out_steps(equal_work(8), 2, 8, BlockSolver::lanes)), (std::vector<int>{4, 4}));
  EXPECT_EQ(widths(deal_out_steps(equal_work(8), 4, 8, BlockSolver::lanes)), (std::vector<int>{2, 2, 2, 2}));
  EXPECT_EQ(widths(deal_out_steps(equal_work(3), 4, 8, BlockSolver::one_by_one)),
            (std::vector<int>{1, 1, 1}));
}

TEST(StepDealingTest, AnOddBlockIsHalvedForBalance) {
  const StepDeal deal = deal_out_steps(equal_work(24), 2, 8, BlockSolver::lanes);
  EXPECT_EQ(widths(deal), (std::vector<int>{4, 4, 8, 8}));
  for (const auto& blocks : deal.blocks) EXPECT_EQ(blocks.size(), 2u);
}

/// A layer with three times the work of the others keeps its block apart from them.
TEST(StepDealingTest, FollowsTheExpectedWork) {
  for (const int heavy : {0, 5, 23}) {
    std::vector<double> work = equal_work(24);
    work[heavy] = 30.0;
    for (const BlockSolver solver : {BlockSolver::lanes, BlockSolver::one_by_one}) {
      const auto of_groups = sums(deal_out_steps(work, 2, 8, solver), work, solver);
      const double total = of_groups[0] + of_groups[1];
      EXPECT_LT(std::abs(of_groups[0] - of_groups[1]), 0.12 * total) << heavy;
    }
  }
}

/// All steps of a layer are in one block, however many fit beside each other.
TEST(StepDealingTest, BlocksHaveWholeLayers) {
  std::vector<int> layers;
  for (int layer = 0; layer < 11; ++layer) layers.insert(layers.end(), 2, layer);
  layers.push_back(10);  // three steps of the last one
  for (const int widest : {1, 2, 4, 8})
    for (const int groups : {1, 2, 3, 8}) {
      const StepDeal deal = deal_out_steps(equal_work(static_cast<int>(layers.size())), groups, widest,
                                           BlockSolver::lanes, layers);
      std::vector<int> owners(layers.size(), 0);
      for (const auto& blocks : deal.blocks)
        for (const StepBlock& block : blocks) {
          const int end = block.first + block.lanes;
          EXPECT_LE(block.lanes, std::max(widest, layers[block.first] == 10 ? 3 : 2));
          EXPECT_TRUE(block.first == 0 || layers[block.first - 1] != layers[block.first]);
          EXPECT_TRUE(end == static_cast<int>(layers.size()) || layers[end - 1] != layers[end]);
          for (int step = block.first; step < end; ++step) ++owners[step];
        }
      EXPECT_EQ(owners, std::vector<int>(layers.size(), 1));
    }
}

/// Lanes leave a block when half of them are done: its time is not that of eight times the slowest.
TEST(StepDealingTest, BlocksInTurnFollowEachOther) {
  const std::vector<int> layers = {0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 5};
  const StepDeal deal = deal_out_in_turn(layers.size(), 2, 4, layers);
  ASSERT_EQ(deal.blocks.size(), 2u);
  int next = 0;
  for (std::size_t wave = 0; wave < deal.blocks[0].size(); ++wave)
    for (const auto& blocks : deal.blocks) {
      if (wave >= blocks.size()) continue;
      EXPECT_EQ(blocks[wave].first, next);
      EXPECT_LE(blocks[wave].lanes, 4);
      next += blocks[wave].lanes;
    }
  EXPECT_EQ(next, static_cast<int>(layers.size()));
  EXPECT_EQ(deal.blocks[0][0].lanes, 4);
  EXPECT_EQ(deal.blocks[1].back().lanes, 3);  // a layer stays whole
}

TEST(StepDealingTest, WorkOfABlockFollowsTheLanesLeft) {
  const auto work = [](std::vector<double> layers) { return block_work(layers, BlockSolver::lanes); };
  const double eight = work(std::vector<double>(8, 1.0)), four = work({1, 1, 1, 1}), two = work({1, 1}),
               one = work({1});
  EXPECT_GT(eight, four);
  EXPECT_GT(four, two);
  EXPECT_GT(two, one);
  EXPECT_DOUBLE_EQ(eight, work({1, 1, 1, 1, 1}));
  EXPECT_NEAR(work({9, 7, 5, 5, 3, 3, 2, 1}), 3 * eight + 2 * four + 2 * two + 2 * one, 1e-12);
  EXPECT_NEAR(work({4, 10, 6}), 4 * four + 2 * two + 4 * one, 1e-12);
  EXPECT_DOUBLE_EQ(block_work(std::vector<double>{4, 10, 6}, BlockSolver::one_by_one),
                   block_work(std::vector<double>{20}, BlockSolver::one_by_one));
}

}  // namespace
}  // namespace fabseq
