// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <span>
#include <vector>

namespace fabseq {

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
