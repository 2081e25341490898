// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/machine/places.h"

#include <span>
#include <vector>

namespace fabseq {

/// Measures places but for their form and what rests on them; `place_of`: number of each part element's
/// place, -1: none. Other arguments as for find_places(). Collective on the grid's communicator.
template <int Dim>
std::vector<Place> measured_places(const Part<Dim>& part, Fault fault, int count,
                                   std::span<const int> place_of, std::span<const double> marks,
                                   std::span<const double> figures, const CheckedLayers& layers);

}  // namespace fabseq
