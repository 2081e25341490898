// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <span>
#include <vector>

namespace fabseq {

/// Geodesic distance (length unit) of each part element's centre from the plate or the substrate, on paths
/// inside the part (a part field; the same on any number of ranks). Solves |grad s| = 1 by fast sweeping with
/// first-order upwind differences over face neighbours, from s = (half the spacing) in elements with a face
/// there: exact above a straight column. Collective on the grid's communicator.
template <int Dim>
std::vector<double> geodesic_distance(const Part<Dim>& part);

/// The same from the centres of the elements with `start` not 0 (a part field), where it is 0. Infinite where
/// no path leads. Collective.
template <int Dim>
std::vector<double> geodesic_distance_of_elements(const Part<Dim>& part, std::span<const char> start);

/// The same between nodes, along the edges of part elements and across them: from the nodes with `start` not
/// 0, of every owned node. Infinite outside the part. Collective.
template <int Dim>
std::vector<double> geodesic_distance_of_nodes(const Part<Dim>& part, std::span<const char> start);

/// Largest distance of any element's far side from the plate: the largest geodesic_distance plus half the
/// spacing along the plate's normal, all ranks. Collective.
template <int Dim>
double geodesic_height(const Part<Dim>& part, const std::vector<double>& distance);

}  // namespace fabseq
