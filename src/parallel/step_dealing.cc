// SPDX-License-Identifier: MIT
#include "fabseq/parallel/step_dealing.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <functional>
#include <numeric>

namespace fabseq {

namespace {

/// Time of an iteration with 1, 2, 4 or 8 lanes relative to that with 8 (V-shape, 64 x 32 x 64, one core with
/// AVX-512). Narrow blocks fill only part of a register.
constexpr double relative_cost(int lanes) {
  return lanes > 4 ? 1.0 : lanes > 2 ? 0.62 : lanes > 1 ? 0.57 : 0.55;
}

/// Halving blocks must save more than this share of the longest group's work.
constexpr double worthwhile = 0.02;
/// Most halvings per group: more blocks balance no better.
constexpr int most_halvings = 8;
/// Number of blocks, those with most work, that are tried for the next halving.
constexpr std::size_t most_candidates = 32;

struct WeighedBlock {
  StepBlock block;
  double work = 0.0;
};

WeighedBlock weighed(std::span<const double> work, int first, int lanes, BlockSolver solver) {
  return {{first, lanes}, block_work(work.subspan(first, lanes), solver)};
}

/// Deals blocks out by the rule "longest processing time first" and leaves them in that order.
StepDeal deal(std::vector<WeighedBlock>& blocks, int groups) {
  std::sort(blocks.begin(), blocks.end(), [](const WeighedBlock& a, const WeighedBlock& b) {
    return a.work != b.work ? a.work > b.work : a.block.first < b.block.first;
  });
  StepDeal result;
  result.blocks.resize(groups);
  std::vector<double> sums(groups, 0.0);
  for (const WeighedBlock& block : blocks) {
    const auto least = std::min_element(sums.begin(), sums.end()) - sums.begin();
    result.blocks[least].push_back(block.block);
    sums[least] += block.work;
  }
  result.longest = *std::max_element(sums.begin(), sums.end());
  result.total = std::accumulate(sums.begin(), sums.end(), 0.0);
  for (auto& of_group : result.blocks)
    std::sort(of_group.begin(), of_group.end(),
              [](const StepBlock& a, const StepBlock& b) { return a.first < b.first; });
  return result;
}

/// Where blocks may end: behind any step, or behind the last one of a layer.
class BlockEnds {
 public:
  BlockEnds(std::size_t steps, std::span<const int> layers)
      : steps_(static_cast<int>(steps)), layers_(layers) {}

  /// End of a block from `first` on, of at most so many steps, or of a layer's.
  int end(int first, int most) const {
    int result = std::min(first + most, steps_);
    while (result > first && !may_end(result)) --result;
    if (result > first) return result;
    do ++result;
    while (!may_end(result));
    return result;
  }

 private:
  bool may_end(int step) const {
    return step == steps_ || layers_.empty() || layers_[step] != layers_[step - 1];
  }

  int steps_;
  std::span<const int> layers_;
};

/// Halves the block whose halving leaves the least work to the longest group. Empties `blocks` if none can be
/// halved.
StepDeal halve_best(std::vector<WeighedBlock>& blocks, std::span<const double> work, int groups,
                    BlockSolver solver, const BlockEnds& ends) {
  StepDeal best;
  std::vector<WeighedBlock> best_blocks;
  for (std::size_t number = 0; number < std::min(blocks.size(), most_candidates); ++number) {
    const StepBlock whole = blocks[number].block;
    const auto most = static_cast<int>(std::bit_ceil(static_cast<unsigned>(whole.lanes)) / 2);
    const int half = most == 0 ? whole.lanes : ends.end(whole.first, most) - whole.first;
    if (half >= whole.lanes) continue;  // a single step, or a single layer
    std::vector<WeighedBlock> tried = blocks;
    tried[number] = weighed(work, whole.first, half, solver);
    tried.push_back(weighed(work, whole.first + half, whole.lanes - half, solver));
    StepDeal next = deal(tried, groups);
    if (!best_blocks.empty() && next.longest >= best.longest) continue;
    best = std::move(next);
    best_blocks = std::move(tried);
  }
  blocks = std::move(best_blocks);
  return best;
}

}  // namespace

double block_work(std::span<const double> work, BlockSolver solver) {
  if (solver == BlockSolver::one_by_one)
    return relative_cost(8) / 8.0 * std::accumulate(work.begin(), work.end(), 0.0);
  std::vector<double> sorted(work.begin(), work.end());
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  // Lanes are done one after the other: more than `lanes` of them are left up to this iteration.
  const auto left_until = [&](std::size_t lanes) { return lanes < sorted.size() ? sorted[lanes] : 0.0; };
  return relative_cost(8) * left_until(4) + relative_cost(4) * (left_until(2) - left_until(4)) +
         relative_cost(2) * (left_until(1) - left_until(2)) +
         relative_cost(1) * (left_until(0) - left_until(1));
}

StepDeal deal_out_steps(std::span<const double> work, int groups, int widest, BlockSolver solver,
                        std::span<const int> layers) {
  const BlockEnds ends(work.size(), layers);
  std::vector<WeighedBlock> blocks;
  for (int first = 0; first < static_cast<int>(work.size());) {
    const int end = ends.end(first, widest);
    blocks.push_back(weighed(work, first, end - first, solver));
    first = end;
  }
  StepDeal best = deal(blocks, groups);
  double total = 0.0;
  for (const WeighedBlock& block : blocks) total += block.work;
  for (int step = 0; groups > 1 && step < most_halvings * groups; ++step) {
    if (best.longest * groups <= (1.0 + worthwhile) * total) break;
    StepDeal next = halve_best(blocks, work, groups, solver, ends);
    if (blocks.empty()) break;
    if (next.longest < (1.0 - worthwhile) * best.longest) best = std::move(next);
  }
  return best;
}

StepDeal deal_out_in_turn(std::size_t steps, int groups, int widest, std::span<const int> layers) {
  const BlockEnds ends(steps, layers);
  StepDeal result;
  result.blocks.resize(groups);
  std::size_t next = 0;
  for (int first = 0; first < static_cast<int>(steps);) {
    const int end = ends.end(first, widest);
    result.blocks[next++ % groups].push_back({first, end - first});
    first = end;
  }
  result.longest = static_cast<double>(result.blocks.front().size());
  result.total = static_cast<double>(next);
  return result;
}

}  // namespace fabseq
