// SPDX-License-Identifier: MIT
/// \file
/// Counts of multigrid levels on any number of ranks, for the scaling model (plan.cc).
#pragma once

#include "multigrid/lane_hierarchy.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <utility>
#include <vector>

namespace scaling {

/// What goes from the ranks of a level to those of the next, one way: in all, and to the rank that gets most.
struct Gather {
  double messages = 0.0, entries = 0.0, own_messages = 0.0, own_entries = 0.0;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Gather, messages, entries, own_messages, own_entries)

/// Counts of a level: over all ranks, and of the one that has most.
struct Level {
  fabseq::Index<3> box{};                     ///< elements along each axis
  fabseq::Index<3> factors{};                 ///< to the next level
  const fabseq::LaneMesh<3>* mesh = nullptr;  ///< of the whole level, if its elements are known
  double fill = 1.0;                          ///< share of the finest level's box, if they are not
  double elements = 0.0, nodes = 0.0;
  double own_elements = elements, own_nodes = nodes;
  int ranks = 1;                                 ///< that hold it
  double halo_messages = 0.0, halo_nodes = 0.0;  ///< of a sum over shared nodes
  double own_neighbors = 0.0, own_halo_nodes = 0.0;
  Gather gathered_nodes{}, gathered_elements{};  ///< from the level above
  /// Of the level above a dealt one: ranks, nodes they send.
  std::vector<std::pair<int, std::int64_t>> holders{};
  bool lanes_dealt = false;
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Level, box, elements, nodes, own_elements, own_nodes, ranks, halo_messages,
                                   halo_nodes, own_neighbors, own_halo_nodes, gathered_nodes,
                                   gathered_elements, holders, lanes_dealt)

/// Levels as one rank alone has them, of a part whose elements are known. `hierarchy` must outlive them.
std::vector<Level> whole_levels(const fabseq::LaneHierarchy<3>& hierarchy);
/// The same of a part that fills this share of the box evenly. `components`: unknowns of a node.
std::vector<Level> whole_levels(fabseq::Index<3> box, double fill, int components);
/// The same levels on ranks that hold the finest one like this.
std::vector<Level> levels_on(const std::vector<Level>& whole, const fabseq::Decomposition<3>& ranges);

}  // namespace scaling
