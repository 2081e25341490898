// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "fabseq/solve/elasticity_solver.h"

#include <vector>

namespace fabseq {

/// Iterations that the layers' solves of a simulation, or of its adjoints, have taken.
struct SolveCount {
  explicit SolveCount(int layers) : largest(layers, 0), all(layers, 0) {}

  /// Notes solves of layers from `layer` on. Throws NumericalError naming the first of them that did not
  /// converge, as a solve of the kind `what`. Not collective.
  void add(const std::vector<SolveReport>& reports, int layer, const char* what);
  /// From now on of all groups. Collective on the world, in one message.
  void gather(const LayerGroups& groups);

  std::vector<int> largest;  ///< of each layer's solves
  std::vector<int> all;      ///< their sum
};

}  // namespace fabseq
