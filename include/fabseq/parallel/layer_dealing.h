// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

namespace fabseq {

/// Neighbouring layers that are solved together.
struct LayerBlock {
  int first = 0;  ///< layer
  int lanes = 0;  ///< number of layers
};

/// How the work of a block follows from that of its layers.
enum class BlockSolver {
  lanes,      ///< side by side: lanes that are done leave when half of them are
  one_by_one  ///< one layer after the other
};

/// Work of a block in units of a full block's iteration. `work`: iterations of each of its layers, 1 to 8.
double block_work(std::span<const double> work, BlockSolver solver);

/// What each group solves for, as blocks in the order of their layers.
struct LayerDeal {
  std::vector<std::vector<LayerBlock>> blocks;  ///< of each group
  double longest = 0.0;                         ///< work of the group with most
};

/// Deals layers out to `groups` in blocks of `widest` layers (a power of two, at most 8) and one of the rest,
/// the block with most work first, each to the group with least so far. Blocks are halved, as long as that
/// pays: while there are fewer of them than groups, or they do not add up to equal sums. A single group gets
/// whole blocks. The same arguments give the same deal.
/// `work`: expected iterations of each layer.
LayerDeal deal_out_layers(std::span<const double> work, int groups, int widest, BlockSolver solver);

}  // namespace fabseq
