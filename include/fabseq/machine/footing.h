// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <vector>

namespace fabseq {

/// The width of a bead, length unit: as given, or for 0 two elements' longest edges.
template <int Dim>
double width_of_bead(const Grid<Dim>& grid, double given) {
  return given > 0.0 ? given : 2.0 * grid.largest_spacing();
}

/// Where something must lie on which a bead can rest (docs/formulation.md 13.1): a cylinder below an element,
/// against its build direction, from half the element's extent along it to a whole one, within a radius
/// across it. Lengths are in length units. Nothing here is collective.
template <int Dim>
struct Footing {
  /// `bead_width`: as width_of_bead() takes it.
  Footing(const Grid<Dim>& grid, double bead_width);

  Point<Dim> spacing;
  double radius;        ///< half a bead's width, or half an element's diagonal if that is more
  Index<Dim> elements;  ///< of the grid, along each axis: no step is longer

  /// Whether the centre of the element that is `step` away lies in it. `direction`: of unit length, [axis].
  bool holds(const Index<Dim>& step, const double* direction) const;
  /// Steps from an element to all others that may lie in it, whatever the direction, the nearest first.
  std::vector<Index<Dim>> steps() const;
};

/// The largest step along each axis.
template <int Dim>
Index<Dim> reach_of(const std::vector<Index<Dim>>& steps);

}  // namespace fabseq
