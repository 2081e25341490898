#include "fabseq/process/layer_dealing.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <functional>
#include <numeric>

namespace fabseq {

namespace {

/// Seconds of an iteration with 1, 2, 4 and 8 lanes, over those with 8 (V-shape, 64 x 32 x 64, one core): four
/// lanes cost half of eight, but a single one no less than a third.
constexpr double relative_cost(int lanes) {
  return lanes > 4 ? 1.0 : lanes > 2 ? 0.49 : lanes > 1 ? 0.33 : 0.30;
}

/// Halving a block must save more of the longest group's work than this.
constexpr double worthwhile = 0.02;
/// Halvings that are tried, a group: more blocks than that balance no better.
constexpr int most_halvings = 8;

struct WeighedBlock {
  LayerBlock block;
  double work = 0.0;
};

class Dealer {
 public:
  Dealer(std::span<const double> work, BlockSolver solver) : work_(work), solver_(solver) {}

  void add(LayerBlock block) {
    blocks_.push_back({block, block_work(work_.subspan(block.first, block.lanes), solver_)});
  }

  /// Longest processing time first.
  LayerDeal deal(int groups) {
    std::sort(blocks_.begin(), blocks_.end(), [](const WeighedBlock& a, const WeighedBlock& b) {
      return a.work != b.work ? a.work > b.work : a.block.first < b.block.first;
    });
    LayerDeal result;
    result.blocks.resize(groups);
    std::vector<double> sums(groups, 0.0);
    for (const WeighedBlock& block : blocks_) {
      const auto least = std::min_element(sums.begin(), sums.end()) - sums.begin();
      result.blocks[least].push_back(block.block);
      sums[least] += block.work;
    }
    const auto most = std::max_element(sums.begin(), sums.end());
    result.longest = *most;
    longest_group_ = result.blocks[most - sums.begin()];
    for (auto& blocks : result.blocks)
      std::sort(blocks.begin(), blocks.end(),
                [](const LayerBlock& a, const LayerBlock& b) { return a.first < b.first; });
    return result;
  }

  /// Halves the block with most work of the last deal's longest group; false if all of its blocks are single
  /// layers.
  bool halve() {
    for (const LayerBlock& block : longest_group_) {
      if (block.lanes == 1) continue;
      std::erase_if(blocks_, [&](const WeighedBlock& other) { return other.block.first == block.first; });
      const auto half = static_cast<int>(std::bit_ceil(static_cast<unsigned>(block.lanes)) / 2);
      add({block.first, half});
      add({block.first + half, block.lanes - half});
      return true;
    }
    return false;
  }

 private:
  std::span<const double> work_;
  BlockSolver solver_;
  std::vector<WeighedBlock> blocks_;
  std::vector<LayerBlock> longest_group_;  ///< its blocks, the one with most work first
};

}  // namespace

double block_work(std::span<const double> work, BlockSolver solver) {
  if (solver == BlockSolver::one_by_one)
    return relative_cost(8) / 8.0 * std::accumulate(work.begin(), work.end(), 0.0);
  std::vector<double> sorted(work.begin(), work.end());
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  // With lanes done one after the other, entry l is when more than l are left.
  const auto left_until = [&](std::size_t lanes) { return lanes < sorted.size() ? sorted[lanes] : 0.0; };
  return relative_cost(8) * left_until(4) + relative_cost(4) * (left_until(2) - left_until(4)) +
         relative_cost(2) * (left_until(1) - left_until(2)) +
         relative_cost(1) * (left_until(0) - left_until(1));
}

LayerDeal deal_out_layers(std::span<const double> work, int groups, int widest, BlockSolver solver) {
  const int layers = static_cast<int>(work.size());
  Dealer dealer(work, solver);
  for (int first = 0; first < layers; first += widest) dealer.add({first, std::min(widest, layers - first)});
  LayerDeal best = dealer.deal(groups);
  if (groups == 1) return best;
  for (int step = 0; step < most_halvings * groups && dealer.halve(); ++step) {
    LayerDeal next = dealer.deal(groups);
    if (next.longest < (1.0 - worthwhile) * best.longest) best = std::move(next);
  }
  return best;
}

}  // namespace fabseq
