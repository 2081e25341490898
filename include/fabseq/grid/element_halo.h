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

/// Gathers an element field on this rank's elements and on all elements of the grid up to `width` elements
/// away along each axis, which may belong to several other ranks. Construction, gather() and scatter_add()
/// are collective on the grid's communicator. The grid need not outlive the object.
template <int Dim>
class ElementHalo {
 public:
  ElementHalo(const Grid<Dim>& grid, const Index<Dim>& width);
  /// The same width along all axes.
  ElementHalo(const Grid<Dim>& grid, int width);

  /// Box of the gathered elements.
  const IndexBox<Dim>& box() const { return box_; }
  /// Returns the field on box(), lexicographic. `owned`: this rank's values, lexicographic in
  /// Grid::owned_elements().
  std::vector<double> gather(std::span<const double> owned) const;
  /// Transpose of gather(): adds the values on box() of all ranks to their owners and returns this rank's
  /// sums.
  std::vector<double> scatter_add(std::span<const double> values) const;

 private:
  IndexBox<Dim> box_;
  VecHandle owned_, extended_;
  ScatterHandle scatter_;
};

}  // namespace fabseq
