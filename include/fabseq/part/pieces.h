// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// The face of the box that is the build plate.
struct BuildPlate {
  int axis = 2;
  bool upper = false;  ///< at the upper end of the axis

  /// The unit vector from the plate into the box.
  template <int Dim>
  Point<Dim> normal() const {
    Point<Dim> result{};
    result[axis] = upper ? -1.0 : 1.0;
    return result;
  }
  /// The face as the config writes it: "z-".
  std::string name() const { return std::string(1, "xyz"[axis]) + (upper ? "+" : "-"); }
  /// Whether an element has a face on the plate. `elements`: number of elements of the grid along each axis.
  template <int Dim>
  bool touches(const Index<Dim>& element, const Index<Dim>& elements) const {
    return element[axis] == (upper ? elements[axis] - 1 : 0);
  }
};

/// A face-connected piece of the part.
template <int Dim>
struct Piece {
  std::int64_t elements = 0;
  Point<Dim> min{}, max{};     ///< bounding box, length unit
  bool touches_plate = false;  ///< at least one element has a face on the build plate or on the substrate
};

/// All pieces, and the piece of each of this rank's elements.
template <int Dim>
struct PieceMap {
  std::vector<Piece<Dim>> pieces;     ///< largest first, ties by lowest element number; the same on all ranks
  std::vector<int> piece_of_element;  ///< index into `pieces` for each owned element, -1 if its density is 0
};

/// Finds the pieces that the elements with `density` > 0 form; `density` has an entry per owned element of
/// the grid. Elements that share only an edge or a corner are not connected. `to_substrate`:
/// Substrate::contact_distance(); empty: none has a face on the substrate. Collective on the grid's
/// communicator.
template <int Dim>
PieceMap<Dim> find_pieces(const Grid<Dim>& grid, std::span<const double> density, const BuildPlate& plate,
                          std::span<const double> to_substrate = {});

}  // namespace fabseq
