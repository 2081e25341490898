// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/box_gather.h"
#include "islands/island_graph.h"
#include "multigrid/lane_hierarchy.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fabseq {

/// Islands of one lane, and the nodes of this rank's mesh that are on them.
struct LaneIslands {
  struct Node {
    std::int64_t node = 0;
    int island = 0;
    bool counted = true;  ///< whether this rank counts it in sums over all nodes
  };
  int count = 0;
  std::vector<Node> nodes;  ///< none of them held; ascending
};

/// Finds the stiff islands of each lane: basins of the stiffness field, found by letting it sink. Elements
/// join face-adjacent ones in the order of decreasing stiffness (to about a fifth), down to three times the
/// least there is; find_islands() says which basins are islands. A node belongs to the basin of its stiffest
/// element, the first of equally stiff ones. The islands do not depend on the number of ranks. A rank looks
/// at its own elements and one layer around them; the graph of a lane's basins, which is small next to the
/// field, goes to one rank, another one for each lane.
template <int Dim>
class IslandMap {
 public:
  /// `level` is the finest and must outlive the map. Collective on its communicator.
  explicit IslandMap(const LaneLevel<Dim>& level);

  /// `stiffness`: [element][lane] of this rank's mesh, NaN counting as 0; `contrast`: of
  /// an island's peak to the saddle where it ends; `most`: islands of a lane, the largest. Collective.
  std::vector<LaneIslands> find(std::span<const double> stiffness, int width, double contrast = 100.0,
                                int most = 8) const;

 private:
  /// The basins of all lanes that this rank has a part of.
  struct Found {
    std::vector<std::vector<int>> of_element;  ///< [lane][element of the box]: index of a basin, -1 for none
    std::vector<std::vector<Basin>> basins;    ///< [lane]: those that may be islands
    std::vector<std::vector<int>> numbers;     ///< [lane]: their indices
    std::vector<std::vector<Saddle>> saddles;  ///< [lane]
  };

  std::vector<IslandLimits> limits_of(std::span<const double> stiffness, int width, double contrast,
                                      int most) const;
  std::vector<double> empty_field() const {
    return std::vector<double>(static_cast<std::size_t>(ring_.wanted().count()), 0.0);
  }
  void set_field(std::span<const double> stiffness, int width, int lane, std::vector<double>& field) const;
  Found find_basins(std::span<const double> stiffness, const std::vector<IslandLimits>& limits) const;
  std::vector<BasinIslands> resolve(const Found& found, const std::vector<IslandLimits>& limits) const;
  std::vector<LaneIslands::Node> nodes_of(const std::vector<double>& field,
                                          const std::vector<int>& island_of_element) const;

  const LaneLevel<Dim>& level_;
  IndexBox<Dim> whole_, owned_;
  BoxGather<Dim> ring_;               ///< of the elements around this rank's
  std::vector<std::int64_t> places_;  ///< of the mesh's elements on the ring
  std::vector<char> node_held_, node_counted_;
  std::vector<char> supported_;  ///< whether an element of the box has a held node
};

}  // namespace fabseq
