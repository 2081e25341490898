// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "fabseq/process/built_region.h"
#include "fabseq/solve/elasticity_solver.h"

#include <cstddef>
#include <vector>

namespace fabseq {

/// Iterations that the steps' solves of a simulation, or of its adjoints, have taken.
struct SolveCount {
  explicit SolveCount(std::size_t steps) : largest(steps, 0), all(steps, 0) {}

  /// Notes solves of a block of steps. Throws NumericalError naming the layer of the first of them that did
  /// not converge, as a solve of the kind `what`. Not collective.
  void add(const std::vector<SolveReport>& reports, const BlockRegion& block, const char* what);
  /// Makes the counts those of all groups. Collective on the world, in one message.
  void gather(const LayerGroups& groups);

  std::vector<int> largest;  ///< of each step's solves
  std::vector<int> all;      ///< their sum
};

}  // namespace fabseq
