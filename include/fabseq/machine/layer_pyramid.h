// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

#include <span>
#include <vector>

namespace fabseq {

/// The earliest layer in blocks of 1, 2, 4, ... elements along each axis of a box, for searches that leave
/// out blocks without anything early enough. Not collective.
template <int Dim>
class LayerPyramid {
 public:
  /// A block of a level: 2^level elements along each axis, fewer at the upper ends of the box.
  struct Block {
    int level = 0;
    Index<Dim> index{};  ///< counts blocks of this level from the lower corner of the box
  };

  /// `layers`: the layer of each element of `box`, lexicographic.
  LayerPyramid(const IndexBox<Dim>& box, std::span<const double> layers);

  /// The block that holds all elements.
  Block root() const { return {static_cast<int>(levels_.size()) - 1, {}}; }
  float earliest(const Block& block) const {
    const Level& level = levels_[block.level];
    return level.earliest[level.box.offset(block.index)];
  }
  /// Number of the half along each axis, and whether the box has that block.
  bool has(const Block& block) const { return levels_[block.level].box.contains(block.index); }
  /// First and last element of a block along an axis, as indices of the grid.
  int first(const Block& block, int axis) const { return start_[axis] + (block.index[axis] << block.level); }
  int last(const Block& block, int axis) const;

 private:
  struct Level {
    IndexBox<Dim> box;
    std::vector<float> earliest;  ///< lexicographic in `box`
  };
  Index<Dim> start_;
  std::vector<Level> levels_;
};

}  // namespace fabseq
