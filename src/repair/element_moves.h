// SPDX-License-Identifier: MIT
#pragma once

#include "repair/cut_time.h"

namespace fabseq {

/// Moves single elements to other layers, where times of nodes are too coarse (docs/formulation.md 13.5):
/// what begins in the air waits, layer by layer, until something lies below it, and what then hangs above
/// waits with it; what the torch does not reach comes a layer earlier. Moves that end with a fault among the
/// elements that they join are undone together. The best layers on the way; those of `start` if none are
/// better. Of no more than `most_elements`. Collective on the grid's communicator.
template <int Dim>
CutTime<Dim> move_elements(const Model<Dim>& model, const Layers& layers, const CutTime<Dim>& start,
                           double most_elements);

}  // namespace fabseq
