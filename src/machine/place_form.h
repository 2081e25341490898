// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/machine/places.h"

#include <span>
#include <vector>

namespace fabseq {

/// Tells roofs, islands and overhangs apart (docs/formulation.md 13.4): sets Place::form of places that begin
/// in the air. Collective on the grid's communicator.
/// \param numbers   of `places` in `place_of` and `carrying`
/// \param place_of  number of the place of each part element, -1: none
/// \param carrying  places_that_carry()
template <int Dim>
void tell_forms(const Part<Dim>& part, std::vector<Place>& places, std::span<const int> numbers,
                std::span<const int> place_of, std::span<const int> carrying,
                std::span<const double> layer_index);

}  // namespace fabseq
