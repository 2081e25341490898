// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "fabseq/parallel/step_dealing.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Exchange between the two ways in which values per element and step are held (docs/architecture.md,
/// distribution): *blocks*, in which a group solves its steps, hold all elements of the rank; *histories*, as
/// the plastic flow of an element needs them, hold all steps for this rank's share of the elements
/// (LayerGroups::share()). Entries of a block are [element][component][lane], those of the histories
/// [element of the share][step][component]. Values are copied, bit for bit: each exchange undoes the other,
/// and is its transpose.
class StepTranspose {
 public:
  /// `deal` says which steps each group solves; every step stands in it once. `elements`: those of this rank,
  /// the same on its copies. Both are at least 0, `components` at least 1. A message holds at most `most`
  /// values of a rank, which MPI can count; more values go in several ones. `groups` must outlive the object.
  /// Not collective.
  StepTranspose(const LayerGroups& groups, const StepDeal& deal, std::size_t elements, int components,
                std::size_t most = std::size_t{1} << 30);

  std::size_t steps() const { return steps_; }
  /// Number of the first element of this rank's share, and how many there are.
  std::size_t first_element() const { return start(groups_.index()); }
  std::size_t elements_of_share() const { return start(groups_.index() + 1) - start(groups_.index()); }
  /// Number of entries of a block.
  std::size_t size_of(const StepBlock& block) const { return elements_ * components_ * block.lanes; }

  /// The histories of the share, from the blocks of all groups. `blocks`: those of this rank's group, in the
  /// order of the deal. Collective on LayerGroups::across().
  std::vector<double> to_histories(std::span<const std::vector<double>> blocks) const;
  /// The blocks of this rank's group, from the histories of all shares. Collective on LayerGroups::across().
  std::vector<std::vector<double>> to_blocks(std::span<const double> histories) const;

 private:
  /// Elements that one exchange takes of a group's share.
  struct Range {
    std::size_t begin, end;
  };
  struct Counts {
    std::vector<int> blocks, histories;  ///< [group] values that this rank sends and gets, either way
  };

  std::size_t start(int group) const { return groups_.first_of_share(elements_, group); }
  Range range(int group, std::size_t pass) const;
  Counts counts(std::size_t pass) const;
  /// Calls f(block number, first entry, number of entries) of this group's blocks for what `group` has.
  template <class Function>
  void for_each_slice(int group, std::size_t pass, Function&& f) const;
  /// Calls f(entry of the histories) for all that goes to or comes from blocks, in the order of the message.
  template <class Function>
  void for_each_entry(std::size_t pass, Function&& f) const;

  const LayerGroups& groups_;
  std::vector<std::vector<StepBlock>> deal_;  ///< [group][block]
  std::vector<std::size_t> steps_of_;         ///< [group]
  std::size_t elements_ = 0, components_ = 1, steps_ = 0, passes_ = 1;
};

}  // namespace fabseq
