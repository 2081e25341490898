// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/sequence/sequence.h"

namespace fabseq {

/// The pseudo-time of layers that are equally thick along the part, as multi-axis slicers make them
/// (docs/formulation.md 3.4).
template <int Dim>
struct EvenTime {
  PseudoTime<Dim> time;  ///< distance from plate and substrate inside the part, over the largest one
  double height = 0.0;   ///< the largest distance, length unit
};

/// Collective on the grid's communicator.
template <int Dim>
EvenTime<Dim> even_time(const Part<Dim>& part);

}  // namespace fabseq
