// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/part/part.h"
#include "fabseq/sequence/sequence_settings.h"

namespace fabseq {

/// What the heat solves of a part have in common (docs/formulation.md 2.1): the whole box conducts, void
/// included; the temperature is prescribed on the plate's nodes of the part and on the substrate's.
template <int Dim>
struct HeatModel {
  /// The model holds no reference to the part.
  HeatModel(const Part<Dim>& part, const SequenceSettings& settings);

  const SquareMatrix<corner_count<Dim>>& mass() const {
    return lumped ? element.lumped_mass() : element.consistent_mass();
  }

  ElementMatrices<Dim> element;
  double reaction;      ///< alpha, in units of diffusivity / length^2
  bool lumped;          ///< whether the mass matrix is diagonal
  SystemDomain domain;  ///< all elements
};

}  // namespace fabseq
