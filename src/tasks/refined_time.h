// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"
#include "fabseq/sequence/refined_field.h"
#include "fabseq/sequence/sequence.h"

namespace fabseq {

/// A pseudo-time, with the gradients that it has, on the part of a grid twice as fine (refined_field()).
/// Times of nodes are left out. `beyond`: how the gradients go on at the part's surface. Collective.
template <int Dim>
PseudoTime<Dim> refined_time(const Part<Dim>& part, const PseudoTime<Dim>& time, const Part<Dim>& fine,
                             BeyondCentres beyond = BeyondCentres::slope);

}  // namespace fabseq
