// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/part/part.h"

#include <vector>

namespace fabseq {

/// What stands when a layer comes (docs/formulation.md 4.8): elements whose stage density exceeds a least one
/// in one of eight layers, layers 1 to 8, 9 to 16 and so on, and the substrate. However the layers are dealt
/// out, blocks lie in such eights, so that results do not depend on the deal.
template <int Dim>
class StandingElements {
 public:
  /// The part must outlive the object. `least`: what a stage density has to exceed. Local.
  StandingElements(const Part<Dim>& part, double least) : part_(part), least_(least) {}

  /// 1 for elements that stand in a layer's eight, else 0, on the owned elements. Local.
  std::vector<double> of(const LayerDensities& densities, int layer) const;
  /// The same with the elements of part and substrate that touch one of these, if only in a corner.
  /// Collective on the grid's communicator.
  std::vector<double> with_neighbors(const LayerDensities& densities, int layer) const;

 private:
  const Part<Dim>& part_;
  double least_;
};

}  // namespace fabseq
