// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <span>
#include <vector>

namespace fabseq {

/// What two elements share at least that count as connected.
enum class Contact { face, corner };

/// Connected components of marked elements.
struct Components {
  int count = 0;                ///< over all ranks
  std::vector<int> of_element;  ///< component of each owned element, -1 if it is not marked
};

/// Finds the connected components of the elements with a mark > 0, numbered in the order of their lowest
/// elements, so that the numbers do not depend on the ranks. `marks` has an entry per owned element of the
/// grid. Collective on the grid's communicator.
template <int Dim>
Components find_components(const Grid<Dim>& grid, std::span<const double> marks, Contact contact);

}  // namespace fabseq
