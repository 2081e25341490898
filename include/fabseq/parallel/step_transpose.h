// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "fabseq/parallel/step_dealing.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Exchange between the two ways in which values per node and step are held (docs/architecture.md,
/// distribution): a *block*, in which a group solves its steps, holds all nodes of the rank; *histories* hold
/// all steps for a range of the nodes. A block is ordered as [node][component][lane], histories as [node of
/// the range][component][step]. The ranges of two copies may overlap: both get the values of a node that they
/// share, and the values that they send back for it are added. So either exchange is the transpose of the
/// other. Where every node is in one range, what is added to a block of zeros is what came from it.
class StepTranspose {
 public:
  /// Nodes from `begin` to `end` - 1.
  struct Range {
    std::size_t begin = 0, end = 0;
    std::size_t count() const { return end - begin; }
  };

  /// `blocks`: [group], the steps that each group solves, counted from 0; no lanes: none. Every step stands
  /// in one block. `ranges`: [group], the nodes whose histories the copies of this rank get. `components`: at
  /// least 1. Nodes times steps, of a block and of what a rank sends or gets, are fewer than 2^31. `groups`
  /// must outlive the object. Not collective.
  StepTranspose(const LayerGroups& groups, std::vector<StepBlock> blocks, std::vector<Range> ranges,
                int components);
  /// Every copy gets the same share of `nodes`.
  StepTranspose(const LayerGroups& groups, std::vector<StepBlock> blocks, std::size_t nodes, int components);

  std::size_t steps() const { return steps_; }
  const Range& range() const { return ranges_[groups_.index()]; }
  std::size_t size_of_histories() const { return range().count() * components_ * steps_; }

  /// Sets the histories of this rank's range from the blocks of all groups. `block`: this rank's; empty, if
  /// it has no steps. Collective on LayerGroups::across().
  void to_histories(std::span<const double> block, std::vector<double>& histories) const;
  /// Adds the steps that this rank solves, from the histories of all copies, to its block. Copies are added
  /// in the order of their groups. Collective on LayerGroups::across().
  void add_to_block(std::span<const double> histories, std::span<double> block) const;

 private:
  /// Calls f(number of node and component in the range, block, where its steps begin in range_message_).
  template <class Function>
  void for_each_piece(Function&& f) const;

  const LayerGroups& groups_;
  std::vector<StepBlock> blocks_;
  std::vector<Range> ranges_;
  std::size_t components_ = 1, steps_ = 0;
  // [group], in units of `components` values:
  std::vector<int> of_block_, of_range_;  ///< what goes from the block to a copy, and comes into the range
  std::vector<int> in_block_;             ///< where the range of a copy begins in the block
  std::vector<int> of_block_starts_, of_range_starts_;         ///< where they begin in the messages
  mutable std::vector<double> block_message_, range_message_;  ///< scratch
};

}  // namespace fabseq
