// SPDX-License-Identifier: MIT
/// \file
/// Which layers cannot move the part by more than is asked for (docs/formulation.md 3.2).
#pragma once

namespace fabseq {

/// Layers in which no element's load factor, density^exponent, exceeds `load` divided by the number of slabs
/// may be left out.
struct NegligibleLayers {
  double load = 0.0;  ///< 0: only empty layers
  double exponent = 3.0;

  /// The largest density that is left out.
  double density(int slabs) const;
};

}  // namespace fabseq
