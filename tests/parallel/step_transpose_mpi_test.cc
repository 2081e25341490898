// SPDX-License-Identifier: MIT
/// Blocks of steps to histories of nodes and back, for every division of the ranks into groups.
#include "fabseq/base/mpi.h"
#include "fabseq/parallel/step_transpose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace fabseq {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;
constexpr int components = 3;
using Range = StepTranspose::Range;

/// A value from which its place can be read. `place`: rank within a group; each has other nodes.
double value(int place, std::size_t node, int component, int step) {
  return 1e6 * place + 1e3 * static_cast<double>(node) + 100.0 * component + step;
}

/// Uneven blocks, such that the last groups may have none.
std::vector<StepBlock> blocks_of(int steps, int groups) {
  std::vector<StepBlock> result(groups);
  int first = 0;
  for (int group = 0; group < groups; ++group) {
    const int lanes = std::min(steps - first, 2 + group);
    result[group] = {first, group + 1 == groups ? steps - first : lanes};
    first += lanes;
  }
  return result;
}

/// Values of the nodes in a range, in the steps of a block.
std::vector<double> values_of(const LayerGroups& groups, const Range& range, const StepBlock& block) {
  std::vector<double> result;
  for (std::size_t node = range.begin; node < range.end; ++node)
    for (int component = 0; component < components; ++component)
      for (int lane = 0; lane < block.lanes; ++lane)
        result.push_back(value(rank_of(groups.domain()), node, component, block.first + lane));
  return result;
}

/// In how many of the ranges a node is.
int times(const std::vector<Range>& ranges, std::size_t node) {
  return static_cast<int>(std::ranges::count_if(
      ranges, [node](const Range& range) { return range.begin <= node && node < range.end; }));
}

void compare(const LayerGroups& groups, std::size_t nodes, int steps, const std::vector<Range>& ranges) {
  const std::vector<StepBlock> blocks = blocks_of(steps, groups.count());
  const StepTranspose transpose(groups, blocks, ranges, components);
  ASSERT_EQ(transpose.steps(), static_cast<std::size_t>(steps));
  const StepBlock& own = blocks[groups.index()];
  const std::vector<double> block = values_of(groups, {0, nodes}, own);
  std::vector<double> histories;
  transpose.to_histories(block, histories);
  EXPECT_EQ(histories, values_of(groups, ranges[groups.index()], {0, steps}));
  std::vector<double> back(block.size(), 0.5), expected = block;
  transpose.add_to_block(histories, back);
  for (std::size_t i = 0; i < expected.size(); ++i)
    expected[i] = 0.5 + times(ranges, i / components / own.lanes) * expected[i];
  EXPECT_EQ(back, expected);
}

/// Shares of the nodes, and `more` nodes on either side of each.
std::vector<Range> ranges_of(const LayerGroups& groups, std::size_t nodes, std::size_t more) {
  std::vector<Range> result;
  for (int group = 0; group < groups.count(); ++group) {
    const std::size_t begin = groups.first_of_share(nodes, group);
    result.push_back(
        {begin - std::min(more, begin), std::min(nodes, groups.first_of_share(nodes, group + 1) + more)});
  }
  return result;
}

TEST(StepTransposeTest, EveryValueComesToItsPlaceAndBack) {
  for (int count = 1; count <= size_of(world); ++count) {
    if (size_of(world) % count != 0) continue;
    const LayerGroups groups(world, count);
    for (const std::size_t nodes : {0u, 1u, 2u, 7u, 50u})
      for (const int steps : {1, 2, 9, 24}) compare(groups, nodes, steps, ranges_of(groups, nodes, 0));
  }
}

TEST(StepTransposeTest, WhatOverlappingRangesGiveBackIsAdded) {
  for (int count = 1; count <= size_of(world); ++count) {
    if (size_of(world) % count != 0) continue;
    const LayerGroups groups(world, count);
    for (const std::size_t more : {1u, 3u, 100u}) compare(groups, 50, 9, ranges_of(groups, 50, more));
  }
}

TEST(StepTransposeTest, EqualSharesAreTheDefault) {
  const LayerGroups groups(world, size_of(world));
  const StepTranspose transpose(groups, blocks_of(9, groups.count()), 50, components);
  EXPECT_EQ(transpose.range().begin, groups.first_of_share(50));
  EXPECT_EQ(transpose.size_of_histories(),
            (groups.first_of_share(50, groups.index() + 1) - groups.first_of_share(50)) * components * 9);
}

TEST(StepTransposeTest, RanksMayHaveDifferentNumbersOfNodes) {
  for (int count = 1; count <= size_of(world); ++count) {
    if (size_of(world) % count != 0) continue;
    const LayerGroups groups(world, count);
    const std::size_t nodes = 10 * static_cast<std::size_t>(rank_of(groups.domain()));
    compare(groups, nodes, 5, ranges_of(groups, nodes, 1));
  }
}

}  // namespace
}  // namespace fabseq
