// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <vector>

namespace fabseq {

/// The nodes at which the mechanical model is held (docs/formulation.md 4.1, 4.4): the clamps if there are
/// any, otherwise the substrate's side towards the plate if there is a substrate, otherwise the plate's face
/// of the box.
template <int Dim>
struct Supports {
  /// Collective on the grid's communicator. Keeps no reference to the part. Throws InputError if the clamps
  /// hold no node of part or substrate, or if a face-connected piece of both could still move as a rigid
  /// body.
  Supports(const Part<Dim>& part, const PartDescription& description);

  std::vector<char> held;    ///< 1 for owned nodes of the grid that are held, those in the void included
  std::vector<int> holding;  ///< held nodes on part or substrate: offsets in Grid::owned_nodes(), ascending
  int pieces = 0;            ///< number of face-connected pieces of part and substrate together
};

}  // namespace fabseq
