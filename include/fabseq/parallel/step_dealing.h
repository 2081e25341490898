// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Consecutive steps of a process that are solved together.
struct StepBlock {
  int first = 0;  ///< its first step, from 0
  int lanes = 0;  ///< number of steps
};

/// How the steps of a block are solved, from which the work of the block follows.
enum class BlockSolver {
  lanes,      ///< side by side: the block halves its width when half of its lanes are done
  one_by_one  ///< one step after the other
};

/// Work of a block, in units of one iteration of a full block. `work`: iterations of each of its steps, of
/// which there are 1 to 8.
double block_work(std::span<const double> work, BlockSolver solver);

/// What each layer group solves for.
struct StepDeal {
  std::vector<std::vector<StepBlock>> blocks;  ///< [group][block], in the order of their steps
  double longest = 0.0;                        ///< largest work of a group
  double total = 0.0;                          ///< work of all groups
};

/// Deals steps out to `groups` layer groups. `work` holds the expected iterations of each step. Blocks have
/// `widest` steps (a power of two, at most 8), the last one the rest. Blocks are dealt out in the order of
/// falling work, each to the group with least work so far. They are halved while that pays: when there are
/// fewer blocks than groups, or when their sums per group are uneven. A single group gets whole blocks.
///
/// `layers`: the layer of each step, ascending; empty: each has its own. A block has whole layers: as
/// many as fit in `widest` steps, at least one. The result depends on the arguments only,
/// so all ranks get the same one. Not collective.
StepDeal deal_out_steps(std::span<const double> work, int groups, int widest, BlockSolver solver,
                        std::span<const int> layers = {});

/// Deals consecutive blocks out to the groups in turn, the first to the first group: of those with the same
/// number in their groups, each waits for none but those before it. Blocks are as above. Not collective.
StepDeal deal_out_in_turn(std::size_t steps, int groups, int widest, std::span<const int> layers = {});

}  // namespace fabseq
