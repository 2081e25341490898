// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <span>
#include <vector>

namespace fabseq {

/// Geodesic distance of each part element's centre from the plate or the substrate on paths inside the part:
/// a part field, length unit, the same on any number of ranks. Solves |grad s| = 1 by fast sweeping with
/// first-order upwind differences over face neighbours. Elements with a face on the plate or the substrate
/// start with s = half the spacing, so that s is exact above a straight column. Collective on the grid's
/// communicator.
template <int Dim>
std::vector<double> geodesic_distance(const Part<Dim>& part);

/// The same distance from the centres of the elements whose `start` (a part field) is not 0; it is 0 there
/// and infinite where no path leads. Collective on the grid's communicator.
template <int Dim>
std::vector<double> geodesic_distance_of_elements(const Part<Dim>& part, std::span<const char> start);

/// The same distance for every owned node, along the edges of part elements and across them, from the nodes
/// whose `start` (one entry per owned node) is not 0. Infinite for nodes outside the part and where no path
/// leads. Collective on the grid's communicator.
template <int Dim>
std::vector<double> geodesic_distance_of_nodes(const Part<Dim>& part, std::span<const char> start);

/// Largest distance from the plate of an element's far side, over all ranks: the maximum of `distance`, a
/// geodesic_distance(), plus half the spacing along the plate's normal. Length unit. Collective on the grid's
/// communicator.
template <int Dim>
double geodesic_height(const Part<Dim>& part, const std::vector<double>& distance);

}  // namespace fabseq
