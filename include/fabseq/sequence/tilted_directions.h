// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/pieces.h"

#include <vector>

namespace fabseq {

/// A build direction of unit length, and how far it leans from the plate's normal.
template <int Dim>
struct TiltedDirection {
  Point<Dim> direction;
  double tilt;  ///< degrees
};

/// Directions to try for planar layers (docs/formulation.md 3.3): the plate's normal, and in equal steps of
/// at most 15 degrees up to `largest_tilt` (degrees) those that lean from it, in two dimensions to either
/// side, in three to eight. Not collective.
template <int Dim>
std::vector<TiltedDirection<Dim>> tilted_directions(const BuildPlate& plate, double largest_tilt);

}  // namespace fabseq
