// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <vector>

namespace fabseq {

/// The nodes that the mechanical model is held at (docs/formulation.md 4.1, 4.4): those of the plate's face,
/// or the clamps in its place.
template <int Dim>
struct Supports {
  /// Collective on the grid's communicator. With a substrate and without clamps, the substrate's side towards
  /// the plate. Throws InputError if clamps hold no node of part or substrate, or if a face-connected piece
  /// of both could still move as a rigid body. No reference to the part is kept.
  Supports(const Part<Dim>& part, const PartDescription& description);

  std::vector<char> held;    ///< 1 for owned nodes of the grid that are held, in the void, too
  std::vector<int> holding;  ///< of them, on part or substrate: offsets in Grid::owned_nodes(), ascending
  int pieces = 0;            ///< face-connected pieces of part and substrate together
};

}  // namespace fabseq
