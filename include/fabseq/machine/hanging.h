// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <span>
#include <vector>

namespace fabseq {

/// Marks the part elements that begin in the air, with 1 (a part field; docs/formulation.md 13.1): no element
/// of the same or an earlier layer, none of the substrate, and no plate lies below them, against the build
/// direction, within half a bead's width. Collective on the grid's communicator.
/// \param direction    build direction, [part element][axis]; the plate's normal where it vanishes, or if
///                     empty
/// \param layer_index  the layer that builds each part element, from 1
/// \param bead_width   length unit; 0: two elements' longest edges
template <int Dim>
std::vector<double> hanging_elements(const Part<Dim>& part, std::span<const double> direction,
                                     std::span<const double> layer_index, double bead_width);

}  // namespace fabseq
