// SPDX-License-Identifier: MIT
/// Blocks of steps to histories of elements and back, for every division of the ranks into groups.
#include "fabseq/base/mpi.h"
#include "fabseq/parallel/step_transpose.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace fabseq {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;
constexpr int components = 3;

/// A value that says where it belongs: each place in a group has elements of its own.
double value(int place, std::size_t element, int step, int component) {
  return 1e6 * place + 1e3 * static_cast<double>(element) + 10.0 * step + component;
}

/// Uneven blocks, such that some groups may have none.
StepDeal deal_of(int steps, int groups) {
  std::vector<double> work(steps);
  std::iota(work.begin(), work.end(), 1.0);
  return deal_out_steps(work, groups, 4, BlockSolver::one_by_one);
}

std::vector<std::vector<double>> blocks_of(const LayerGroups& groups, const StepDeal& deal,
                                           std::size_t elements) {
  std::vector<std::vector<double>> result;
  for (const StepBlock& block : deal.blocks[groups.index()]) {
    std::vector<double>& values = result.emplace_back();
    for (std::size_t element = 0; element < elements; ++element)
      for (int component = 0; component < components; ++component)
        for (int lane = 0; lane < block.lanes; ++lane)
          values.push_back(value(rank_of(groups.domain()), element, block.first + lane, component));
  }
  return result;
}

std::vector<double> histories_of(const LayerGroups& groups, std::size_t first, std::size_t count, int steps) {
  std::vector<double> result;
  for (std::size_t element = first; element < first + count; ++element)
    for (int step = 0; step < steps; ++step)
      for (int component = 0; component < components; ++component)
        result.push_back(value(rank_of(groups.domain()), element, step, component));
  return result;
}

void compare(const LayerGroups& groups, std::size_t elements, int steps, std::size_t most) {
  const StepDeal deal = deal_of(steps, groups.count());
  const StepTranspose transpose(groups, deal, elements, components, most);
  ASSERT_EQ(transpose.steps(), static_cast<std::size_t>(steps));
  const auto blocks = blocks_of(groups, deal, elements);
  const auto histories =
      histories_of(groups, transpose.first_element(), transpose.elements_of_share(), steps);
  EXPECT_EQ(transpose.to_histories(blocks), histories);
  EXPECT_EQ(transpose.to_blocks(histories), blocks);
}

TEST(StepTransposeTest, EveryValueComesToItsPlaceAndBack) {
  for (int count = 1; count <= size_of(world); ++count) {
    if (size_of(world) % count != 0) continue;
    const LayerGroups groups(world, count);
    for (const std::size_t elements : {0u, 1u, 2u, 7u, 50u})
      for (const int steps : {1, 2, 9, 24}) compare(groups, elements, steps, std::size_t{1} << 30);
  }
}

TEST(StepTransposeTest, MoreThanAMessageHoldsGoesInSeveral) {
  for (int count = 1; count <= size_of(world); ++count) {
    if (size_of(world) % count != 0) continue;
    const LayerGroups groups(world, count);
    for (const std::size_t most : {1u, 40u, 1000u}) compare(groups, 50, 9, most);
  }
}

TEST(StepTransposeTest, RanksMayHaveDifferentNumbersOfElements) {
  const LayerGroups groups(world, 1);
  compare(groups, 10 * static_cast<std::size_t>(rank_of(world)), 5, 64);
}

}  // namespace
}  // namespace fabseq
