// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// The neighbourhood of a surface, such as a face that was exported from a CAD program on its own.
struct NearMesh {
  std::string file;       ///< absolute path; placed like the part's mesh, where the part is one
  double distance = 0.0;  ///< length unit, beside the tolerance of shapes
};

/// A node set as the config describes it: the nodes in or on `shape` that touch the part or the substrate, or
/// `samples` of them.
struct NodeSetDescription {
  Shape shape;
  /// Number of nodes, equally spaced along the longest edge of the set's bounding box. 0: all nodes.
  int samples = 0;
  double within = 0.0;  ///< nodes at most this far outside the shape count, too; length unit
  std::optional<NearMesh> near = std::nullopt;  ///< nodes near a surface, in place of those in a shape
  bool all = false;      ///< every node of a part element, in place of those in a shape
  bool surface = false;  ///< only nodes with fewer than 2^Dim elements of part and substrate around them
};

/// A named set of nodes on which distortion is measured, distributed like the grid's nodes.
struct NodeSet {
  std::string name;
  std::vector<int> owned;  ///< offsets in Grid::owned_nodes(), ascending
  std::int64_t count = 0;  ///< number of nodes, summed over all ranks
};

/// Collects the nodes of a set. Nodes at most max(`within`, 1e-6 of the smallest spacing) outside the shape
/// count. With k samples of n nodes, the nodes are ordered along the longest edge of the set's bounding box,
/// ties by lexicographic node number, and those with index floor(i (n-1)/(k-1) + 1/2) are chosen. Collective
/// on the grid's communicator. Throws InputError naming /node_sets/NAME for a set without nodes or with fewer
/// nodes than samples.
template <int Dim>
NodeSet make_node_set(const Part<Dim>& part, const std::string& name, const NodeSetDescription& description);
/// All of them, by name.
template <int Dim>
std::map<std::string, NodeSet> make_node_sets(const Part<Dim>& part,
                                              const std::map<std::string, NodeSetDescription>& descriptions);

}  // namespace fabseq
