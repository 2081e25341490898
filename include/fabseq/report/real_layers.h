// SPDX-License-Identifier: MIT
/// \file
/// What is told of a sequence whose simulated layers stand for several real ones (docs/formulation.md 3.1).
#pragma once

#include "fabseq/report/verdict.h"

#include <string>
#include <vector>

namespace fabseq {

/// The real layers, each a bead high, by which a sequence is judged. The same on all ranks.
struct RealLayers {
  int passes = 1;             ///< of each simulated layer
  int count = 0;              ///< of real layers
  std::vector<int> elements;  ///< of the grid that they are checked on, [axis]
  double per_bead = 0.0;      ///< its elements to the height of a bead
  Verdict simulated;          ///< on the simulated layers
};

/// Says what the verdict goes by: "judged by 36 real layers, 3 to a simulated one, ...". Not collective.
std::string words_of(const RealLayers& layers);

}  // namespace fabseq
