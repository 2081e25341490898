// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <functional>
#include <span>
#include <vector>

namespace fabseq {

/// How vectors with an entry a design variable are spread over the ranks of a run, which may be more than
/// those of the grid: several grids alike, whose ranks share the entries.
template <int Dim>
struct DesignLayout {
  const Grid<Dim>& grid;
  bool on_nodes;  ///< whether entries belong to nodes or to elements
  /// This rank's entries to values on its owned elements or nodes. Collective on all ranks that share the
  /// vector.
  std::function<std::vector<double>(std::span<const double>)> to_grid;
  /// The other way round; not collective.
  std::function<std::vector<double>(std::span<const double>)> from_grid;
};

}  // namespace fabseq
