// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <span>
#include <vector>

namespace fabseq {

/// The corner of an element (step 1), or the element at a node (step -1), of that number, 0 to 2^Dim - 1: bit
/// a stands for a step along axis a.
template <int Dim>
Index<Dim> stepped(const Index<Dim>& from, int number, int step) {
  Index<Dim> result = from;
  for (int axis = 0; axis < Dim; ++axis) result[axis] += step * (number >> axis & 1);
  return result;
}

/// Gathers an element field on this rank's elements and all elements up to `width` away along each axis
/// (within the grid), also across several ranks. Set-up and calls are collective.
template <int Dim>
class ElementHalo {
 public:
  ElementHalo(const Grid<Dim>& grid, const Index<Dim>& width);

  /// Box of the gathered elements.
  const IndexBox<Dim>& box() const { return box_; }
  /// `owned`: lexicographic in Grid::owned_elements(); returns values lexicographic in box().
  std::vector<double> gather(std::span<const double> owned) const;
  /// Transpose of gather(): adds values on box() to their owners.
  std::vector<double> scatter_add(std::span<const double> values) const;

 private:
  IndexBox<Dim> box_;
  VecHandle owned_, extended_;
  ScatterHandle scatter_;
};

}  // namespace fabseq
