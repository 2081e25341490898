// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <span>
#include <vector>

namespace fabseq {

/// Gathers an element field on this rank's elements and on all elements of the grid up to `width` elements
/// away along each axis, which may belong to several other ranks. Construction, gather() and scatter_add()
/// are collective on the grid's communicator. The grid need not outlive the object.
template <int Dim>
class ElementHalo {
 public:
  ElementHalo(const Grid<Dim>& grid, const Index<Dim>& width);
  /// The same width along all axes.
  ElementHalo(const Grid<Dim>& grid, int width) : ElementHalo(grid, uniform_index<Dim>(width)) {}

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
