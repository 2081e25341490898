// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

namespace fabseq {

/// Walls of so many elements and more are all alike to thinnest_wall().
inline constexpr double thick_wall = 5.0;

/// The place where the part is thinnest.
template <int Dim>
struct ThinWall {
  double elements;  ///< thickness in smallest spacings, at most thick_wall
  Point<Dim> at;    ///< centre of an element there, length unit
};

/// Looks for the thinnest wall of part and substrate together. A wall is measured at the elements that lie
/// deepest in it, which leaves out edges, corners and the tips of wedges: it is the shortest run of elements
/// through one of them along the axes and all diagonals, so up to a third less in bars of one or two
/// elements. Collective on the grid's communicator; the result is the same on all ranks.
template <int Dim>
ThinWall<Dim> thinnest_wall(const Part<Dim>& part);

}  // namespace fabseq
