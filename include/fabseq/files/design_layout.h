// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <functional>
#include <span>
#include <vector>

namespace fabseq {

/// How vectors with one entry per design variable are distributed over the ranks of a run. There may be more
/// ranks than those of the grid: several copies of the grid, whose ranks share the entries.
template <int Dim>
struct DesignLayout {
  const Grid<Dim>& grid;
  bool on_nodes;   ///< whether entries belong to nodes (or to elements)
  int components;  ///< entries of an element or node
  /// Turns this rank's entries into values on its owned elements or nodes, [element or node][component].
  /// Collective on all ranks that share the vector.
  std::function<std::vector<double>(std::span<const double>)> to_grid;
  /// Turns values on this rank's owned elements or nodes into its entries. Not collective.
  std::function<std::vector<double>(std::span<const double>)> from_grid;
};

}  // namespace fabseq
