// SPDX-License-Identifier: MIT
/// \file
/// Counts of multigrid levels on any number of ranks, for the scaling model (plan.cc).
#pragma once

#include "fabseq/lanes/lane_hierarchy.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
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
  double elements = 0.0, nodes = 0.0;
  double own_elements = 0.0, own_nodes = 0.0;
  int ranks = 1;                                 ///< that hold it
  double halo_messages = 0.0, halo_nodes = 0.0;  ///< of a sum over shared nodes
  double own_neighbors = 0.0, own_halo_nodes = 0.0;
  Gather gathered_nodes, gathered_elements;  ///< from the level above
  std::vector<std::pair<int, std::int64_t>>
      holders;  ///< of the level above a dealt one: ranks, nodes they send
  bool lanes_dealt = false;
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Level, box, elements, nodes, own_elements, own_nodes, ranks, halo_messages,
                                   halo_nodes, own_neighbors, own_halo_nodes, gathered_nodes,
                                   gathered_elements, holders, lanes_dealt)

/// The levels of a system as one rank alone has them, and as others would.
class System {
 public:
  /// The system of a part whose elements are known.
  System(const fabseq::Grid<3>& grid, const fabseq::SystemDomain& domain);
  /// The system of a part that fills this share of the box evenly.
  System(fabseq::Index<3> box, double fill);

  /// Its levels on ranks that hold the finest one like this.
  std::vector<Level> on(const fabseq::Decomposition<3>& ranges) const;

 private:
  using Shares = fabseq::LevelShares<3>;

  void add(const fabseq::Index<3>& box, const fabseq::Index<3>& factors, double elements, double nodes,
           const fabseq::LaneMesh<3>* mesh);
  void hold(Level& level, const Shares& shares) const;
  void gather(Level& level, const Level& fine, const Shares& shares, const Shares& coarse) const;
  void deal_lanes(Level& level, const Level& fine, const Shares& shares) const;
  /// Nodes of so many elements of the box, where no more is known.
  double nodes_of(double elements) const;

  std::unique_ptr<fabseq::LaneHierarchy<3>> hierarchy_;
  double fill_ = 1.0;
  std::vector<Level> whole_;
};

}  // namespace scaling
