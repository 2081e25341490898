// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

#include <span>
#include <vector>

namespace fabseq {

/// Nodes that move with a stiff island in soft surroundings, which a multigrid cycle does not see.
struct StiffIslands {
  int count = 0;
  std::vector<int> node_island;  ///< of each node of the box, lexicographic; -1: none
};

/// Basins of the stiffness field, found by letting it sink: elements join face-adjacent ones in the order of
/// decreasing stiffness (to about a fifth), down to three times the least there is. A basin is an island if
/// it holds no supported element and its peak is `contrast` times stiffer than the saddle where it meets
/// another. A node belongs to the basin of its stiffest element. At most `most` islands, the largest.
/// `stiffness`: of each element of the box, lexicographic, 0 where there is none. `supported`: whether an
/// element has a held node.
template <int Dim>
StiffIslands find_stiff_islands(const Index<Dim>& elements, std::span<const double> stiffness,
                                std::span<const char> supported, double contrast = 100.0, int most = 8);

}  // namespace fabseq
