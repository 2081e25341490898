// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/decomposition.h"
#include "fabseq/grid/index_box.h"

#include <cstdint>
#include <vector>

namespace fabseq {

/// Which ranks hold a level of the multigrid, and which of its elements: ranges like those of the grid, over
/// ever fewer ranks. Every rank knows all shares; nothing here is collective.
template <int Dim>
struct LevelShares {
  Decomposition<Dim> ranges;  ///< of the level's elements, in a grid of processes
  std::vector<int> ranks;     ///< of the grid's communicator, by process

  /// Shares of the finest level: all ranks hold it.
  static LevelShares finest(const Decomposition<Dim>& ranges);

  int count() const { return static_cast<int>(ranks.size()); }
  /// Process that a rank is on this level, or -1.
  int process_of(int rank) const;
  /// Elements of a process.
  IndexBox<Dim> elements_of(int process) const { return ranges.elements_of(ranges.position_of(process)); }
  /// Process that holds an element.
  int holder_of(const Index<Dim>& element) const {
    return ranges.rank_at(ranges.position_of_element(element));
  }

  /// Shares of the next level. It is taken to have this level's `active` elements over the product of the
  /// factors; thin parts leave it more. Range starts between coarse elements are rounded up. Processes that
  /// would get none, or fewer than least_blocks on average, are joined with their neighbours in
  /// pairs, along the axis where the ranges are shortest; the lower one of a pair goes on.
  LevelShares coarsened(const Index<Dim>& factors, std::int64_t active) const;
  /// Whether on the next level the same ranks hold just what their elements lie in.
  bool stay_in_place(const LevelShares& next, const Index<Dim>& factors) const;

 private:
  void halve(int axis);
};

}  // namespace fabseq
