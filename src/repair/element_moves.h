// SPDX-License-Identifier: MIT
#pragma once

#include "repair/cut_time.h"

namespace fabseq {

/// Moves single elements to other layers, where times of nodes are too coarse (docs/developer/repair.md
/// 13.5): what begins in the air waits, layer by layer, until something lies below it, and what then hangs
/// above waits with it; what the torch does not reach comes a layer earlier. Where a fault is left, all moves
/// that are connected to it are undone. Then each element that still fails tries other layers and the build
/// directions of its neighbours. Returns the best layers, or `start` if none are better. At most
/// `most_elements` go to another layer. Collective on the grid's communicator.
template <int Dim>
CutTime<Dim> move_elements(const Model<Dim>& model, const Layers& layers, const CutTime<Dim>& start,
                           double most_elements);

}  // namespace fabseq
