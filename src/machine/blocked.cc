// SPDX-License-Identifier: MIT
#include "fabseq/machine/blocked.h"

#include "fabseq/grid/element_halo.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

/// The earliest layer in blocks of 1, 2, 4, ... elements along each axis of a box, for searches that leave
/// out blocks without anything early enough.
template <int Dim>
class LayerPyramid {
 public:
  /// A block of a level: 2^level elements along each axis, fewer at the upper ends of the box.
  struct Block {
    int level = 0;
    Index<Dim> index{};  ///< counts blocks of this level from the lower corner of the box
  };

  /// `layers`: the layer of each element of `box`, lexicographic.
  LayerPyramid(const IndexBox<Dim>& box, std::span<const double> layers) : start_(box.start) {
    levels_.push_back({{{}, box.size}, std::vector<float>(layers.begin(), layers.end())});
    while (levels_.back().box.count() > 1) {
      const Level& finer = levels_.back();
      Level level;
      for (int axis = 0; axis < Dim; ++axis) level.box.size[axis] = (finer.box.size[axis] + 1) / 2;
      level.earliest.assign(static_cast<std::size_t>(level.box.count()),
                            std::numeric_limits<float>::infinity());
      finer.box.for_each([&](Index<Dim> index, std::int64_t offset) {
        for (int& entry : index) entry /= 2;
        float& earliest = level.earliest[level.box.offset(index)];
        earliest = std::min(earliest, finer.earliest[offset]);
      });
      levels_.push_back(std::move(level));
    }
  }

  /// The block that holds all elements.
  Block root() const { return {static_cast<int>(levels_.size()) - 1, {}}; }
  float earliest(const Block& block) const {
    const Level& level = levels_[block.level];
    return level.earliest[level.box.offset(block.index)];
  }
  /// Whether the box has that block.
  bool has(const Block& block) const { return levels_[block.level].box.contains(block.index); }
  /// First and last element of a block along an axis, as indices of the grid.
  int first(const Block& block, int axis) const { return start_[axis] + (block.index[axis] << block.level); }
  int last(const Block& block, int axis) const {
    const int end = std::min((block.index[axis] + 1) << block.level, levels_.front().box.size[axis]);
    return start_[axis] + end - 1;
  }

 private:
  struct Level {
    IndexBox<Dim> box;
    std::vector<float> earliest;  ///< lexicographic in `box`
  };
  Index<Dim> start_;
  std::vector<Level> levels_;
};

/// Finds the deepest of all centres that are in the torch's way: branch and bound on blocks of elements.
template <int Dim>
class DeepestSearch {
 public:
  DeepestSearch(const LayerPyramid<Dim>& pyramid, const Torch& torch, const Point<Dim>& spacing)
      : pyramid_(pyramid), torch_(torch), spacing_(spacing) {
    // What the torch only touches, but for rounding, is not in its way.
    rounding_ = 1e-9 * *std::min_element(spacing.begin(), spacing.end());
  }

  /// \param layer  of the element; what is earlier is in the way
  double depth(const Index<Dim>& element, const double* axis, double layer) {
    double deepest = rounding_;
    waiting_.clear();
    add(pyramid_.root(), element, axis, layer, deepest);
    while (!waiting_.empty()) {
      const auto [block, bound] = waiting_.back();
      waiting_.pop_back();
      if (bound <= deepest) continue;
      if (block.level == 0)
        deepest = bound;  // of a single centre the bound is the depth
      else
        add_parts(block, element, axis, layer, deepest);
    }
    return deepest > rounding_ ? deepest : 0.0;
  }

 private:
  using Block = typename LayerPyramid<Dim>::Block;
  struct Candidate {
    Block block;
    double bound;
  };

  void add(const Block& block, const Index<Dim>& element, const double* axis, double layer, double deepest) {
    if (static_cast<double>(pyramid_.earliest(block)) >= layer) return;
    const double bound = largest_depth(block, element, axis);
    if (bound > deepest) waiting_.push_back({block, bound});
  }

  /// Adds the blocks of which a block consists, the most promising one last.
  void add_parts(const Block& block, const Index<Dim>& element, const double* axis, double layer,
                 double deepest) {
    const std::size_t first = waiting_.size();
    for (int number = 0; number < corner_count<Dim>; ++number) {
      Block part{block.level - 1, block.index};
      for (int i = 0; i < Dim; ++i) part.index[i] = 2 * block.index[i] + (number >> i & 1);
      if (pyramid_.has(part)) add(part, element, axis, layer, deepest);
    }
    std::sort(waiting_.begin() + static_cast<std::ptrdiff_t>(first), waiting_.end(),
              [](const Candidate& a, const Candidate& b) { return a.bound < b.bound; });
  }

  /// An upper bound of the depth of the centres in a block, and the depth itself if there is one centre.
  double largest_depth(const Block& block, const Index<Dim>& element, const double* axis) const {
    Point<Dim> offset;
    double along = 0.0, half_along = 0.0, half_square = 0.0, square = 0.0;
    for (int i = 0; i < Dim; ++i) {
      const int first = pyramid_.first(block, i), last = pyramid_.last(block, i);
      // Integers first: a height that is a multiple of an element's edge has no other rounding.
      offset[i] = 0.5 * (first + last - 2 * element[i]) * spacing_[i];
      const double half = 0.5 * (last - first) * spacing_[i];
      along += offset[i] * axis[i];
      half_along += half * std::abs(axis[i]);
      half_square += half * half;
    }
    for (int i = 0; i < Dim; ++i) square += std::pow(offset[i] - along * axis[i], 2);
    const double distance = std::sqrt(square) - std::sqrt(half_square);
    return torch_.largest_radius(along - half_along, along + half_along) - std::max(distance, 0.0);
  }

  const LayerPyramid<Dim>& pyramid_;
  const Torch& torch_;
  Point<Dim> spacing_;
  double rounding_;
  std::vector<Candidate> waiting_;
};

}  // namespace

template <int Dim>
std::vector<double> blocked_depth(const Part<Dim>& part, const Torch& torch, std::span<const double> axis,
                                  std::span<const double> layer_index) {
  const Grid<Dim>& grid = part.grid();
  const ElementHalo<Dim> halo(grid, torch_halo(grid, torch));
  const LayerPyramid<Dim> pyramid(halo.box(), halo.gather(part.expand(layer_index, INFINITY, 0.0)));
  DeepestSearch<Dim> search(pyramid, torch, grid.spacing());
  std::vector<double> result;
  for (std::size_t e = 0; e < layer_index.size(); ++e)
    result.push_back(
        search.depth(grid.owned_elements().index(part.elements()[e]), &axis[e * Dim], layer_index[e]));
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(blocked_depth);

}  // namespace fabseq
