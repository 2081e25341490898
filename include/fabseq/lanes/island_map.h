// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/lanes/lane_hierarchy.h"
#include "fabseq/lanes/stiff_islands.h"

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
  std::vector<Node> nodes;  ///< none of them held
};

/// Finds the stiff islands of each lane: lanes are dealt out to the ranks, and a rank sees its lanes' whole
/// fields.
template <int Dim>
class IslandMap {
 public:
  /// Fields larger than this are not gathered on one rank: their islands stay unknown.
  static constexpr std::int64_t largest = 100'000'000;

  /// `level` is the finest and must outlive the map. Collective on its communicator.
  explicit IslandMap(const LaneLevel<Dim>& level);

  /// `stiffness`: [element][lane] of this rank. Collective.
  std::vector<LaneIslands> find(std::span<const double> stiffness, int width) const;

 private:
  std::vector<int> find_in(std::span<const double> field) const;

  const LaneLevel<Dim>& level_;
  std::vector<char> node_held_, node_counted_, element_supported_;
  std::vector<int> places_;       ///< of this rank's elements in the whole box
  std::vector<int> node_places_;  ///< of its nodes
  std::vector<int> element_counts_, element_starts_, node_counts_, node_starts_;  ///< of all ranks
  std::vector<int> all_places_, all_node_places_;
  std::vector<char> all_supported_;
};

}  // namespace fabseq
