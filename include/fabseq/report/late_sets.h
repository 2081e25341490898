// SPDX-License-Identifier: MIT
/// \file
/// Node sets that the last layers build.
#pragma once

#include "fabseq/part/node_set.h"
#include "fabseq/responses/term.h"

#include <map>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// A node set that is measured as built, and of which the last `layers` layers build a `share` of the nodes.
/// Where material goes to nominal positions, few layers or none move such a node after its own one, whose
/// motion thinner layers make small in every sequence (docs/formulation.md 4.6): gains on it may vanish.
struct LateSet {
  std::string name;
  double share = 0.0;  ///< of its nodes
  int layers = 0;      ///< a tenth of all, at least one

  /// Describes the set for people, without a full stop.
  std::string words() const;
};

/// The sets that the terms measure before the release and that have half or more of their nodes in the last
/// layers, sorted by name. `layer_index`: Layers::layer_index() of the part elements. The same on all ranks.
/// Collective on the grid's communicator.
template <int Dim>
std::vector<LateSet> late_sets(const Part<Dim>& part, const std::map<std::string, NodeSet>& node_sets,
                               const std::vector<Term>& terms, std::span<const double> layer_index);

}  // namespace fabseq
