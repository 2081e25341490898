// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fabseq {

/// Marks, with 1, of part elements that no neighbour leads to or away from in time (part fields). Neighbours
/// are those across faces.
struct InteriorExtrema {
  /// Nothing earlier is beside them: they have no face on plate or substrate, and no neighbour in the part
  /// comes earlier. A layer begins in the air there.
  std::vector<double> minima;
  /// Nothing later is beside them: all their neighbours are in part or substrate and none comes later. They
  /// are closed in when they are deposited.
  std::vector<double> maxima;
};

/// Finds the extrema of a pseudo-time (part field; docs/formulation.md 2.1). Collective on the grid's
/// communicator.
template <int Dim>
InteriorExtrema find_interior_extrema(const Part<Dim>& part, std::span<const double> time);

/// Number of interior minima, summed over all ranks. Collective on the grid's communicator.
template <int Dim>
std::int64_t count_interior_minima(const Part<Dim>& part, std::span<const double> time);

}  // namespace fabseq
