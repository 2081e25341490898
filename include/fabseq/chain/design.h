// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace fabseq {

/// A point in the space of design variables, or a derivative with respect to them.
struct Design {
  std::vector<double> field;            ///< of the sequence: this rank's share (LayerGroups::share)
  std::vector<double> layer_variables;  ///< those of the layers (LayerVariables); the same on all ranks
};

}  // namespace fabseq
