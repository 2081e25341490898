/// \file
/// Distance from the build plate, or the substrate, inside the part, for the start of the optimization and the automatic layer
/// count.
#pragma once

#include "fabseq/grid/part.h"

#include <vector>

namespace fabseq {

/// Geodesic distance (length unit) of each part element's centre from the plate or the substrate, on paths inside the
/// part (a part field; the same on any number of ranks). Solves |grad s| = 1 by fast sweeping with first-order upwind
/// differences over face neighbours, from s = (half the spacing) in elements with a face there: exact
/// above a straight column. Collective on the grid's communicator.
template <int Dim>
std::vector<double> geodesic_distance(const Part<Dim>& part);

/// Largest distance of any element's far side from the plate: the largest geodesic_distance plus half the
/// spacing along the plate's normal, all ranks. Collective.
template <int Dim>
double geodesic_height(const Part<Dim>& part, const std::vector<double>& distance);

extern template std::vector<double> geodesic_distance<2>(const Part<2>&);
extern template std::vector<double> geodesic_distance<3>(const Part<3>&);
extern template double geodesic_height<2>(const Part<2>&, const std::vector<double>&);
extern template double geodesic_height<3>(const Part<3>&, const std::vector<double>&);

}  // namespace fabseq
