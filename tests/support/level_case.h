// SPDX-License-Identifier: MIT
/// \file
/// Hierarchies of masked grids, and their levels as they must be.
#pragma once

#include "multigrid/lane_hierarchy.h"
#include "support/masked_grid.h"

#include <vector>

namespace fabseq::test {

/// A level as it must be, whole.
template <int Dim>
struct ExpectedLevel {
  MaskedBox<Dim> box;
  std::vector<int> touching = box.touching_elements();

  /// The next one.
  ExpectedLevel coarsened(const Index<Dim>& factors) const {
    IndexBox<Dim> elements;
    for (int axis = 0; axis < Dim; ++axis)
      elements.size[axis] = (box.elements.size[axis] + factors[axis] - 1) / factors[axis];
    std::vector<char> active(elements.count(), 0);
    box.for_each_active([&](Index<Dim> element, std::int64_t) {
      for (int axis = 0; axis < Dim; ++axis) element[axis] /= factors[axis];
      active[elements.offset(element)] = 1;
    });
    return {{elements, {"", [&](const Index<Dim>& e) { return active[elements.offset(e)] != 0; }}}};
  }
};

/// Some that several ranks hold on several levels, one whose second level is for fewer, some with odd counts,
/// some tiny, some with long elements.
template <int Dim>
std::vector<Index<Dim>> sizes() {
  if constexpr (Dim == 2)
    return {{96, 97}, {70, 58}, {37, 23}, {5, 4}, {3, 400}};
  else
    return {{24, 25, 24}, {12, 21, 22}, {11, 9, 13}, {2, 3, 2}, {1, 60, 20}};
}

template <int Dim>
LaneHierarchy<Dim> hierarchy_of(const MaskedGrid<Dim>& masked) {
  return LaneHierarchy<Dim>(masked.grid, masked.domain);
}

}  // namespace fabseq::test
