// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace fabseq {

/// A step of a process (docs/formulation.md 4.1), of which each is one elastic system: a layer is added, or
/// what stands cools, is treated or released. Its stiffness is that of what stands, its load
///
///     f_s = sum_e (drho_j,e)^q int B^T C eps*_s   where layer j is added: the layer alone is strained;
///     f_s = sum_e E(rho_j,e) int B^T C eps*_s     else: all that stands is.
struct BuildStep {
  int layer = 0;     ///< the last one that stands, j, from 0
  bool adds = true;  ///< whether this layer is added
};

/// A step for each layer, which is added.
inline std::vector<BuildStep> steps_of_layers(int layers) {
  std::vector<BuildStep> result;
  for (int layer = 0; layer < layers; ++layer) result.push_back({layer, true});
  return result;
}

}  // namespace fabseq
