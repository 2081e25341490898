// SPDX-License-Identifier: MIT
#pragma once

#include "machine/feet.h"

#include <span>
#include <vector>

namespace fabseq {

/// Finds what begins on places that begin in the air: the place whose elements are all that carries a part
/// element, directly or by other elements, -1 for elements that something else carries as well. Of several
/// such places it is the first. Collective on the grid's communicator.
/// \param layer_index  the layer that builds each part element, from 1
/// \param places       of each part element that begins in the air (hanging_elements()); -1 of others
template <int Dim>
std::vector<int> places_that_carry(const Part<Dim>& part, const Feet<Dim>& feet,
                                   std::span<const double> layer_index, std::span<const int> places);

}  // namespace fabseq
