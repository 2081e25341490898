// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <span>
#include <vector>

namespace fabseq {

/// Means of a field, [owned node], over the corners of elements. `first_corners`: offset of each one's lowest
/// corner in the ghosted node box. Collective on the grid's communicator.
template <int Dim>
std::vector<double> corner_means(const Grid<Dim>& grid, std::span<const int> first_corners,
                                 std::span<const double> field);

/// The transpose, times a factor: to a field, [owned node], each element adds its value over the number of
/// its corners. Collective on the grid's communicator.
template <int Dim>
std::vector<double> spread_to_corners(const Grid<Dim>& grid, std::span<const int> first_corners,
                                      std::span<const double> values, double factor);

}  // namespace fabseq
