// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <limits>
#include <span>
#include <vector>

namespace fabseq {

/// The layer of what is never built, in built_layers().
constexpr double never_built = std::numeric_limits<double>::infinity();

/// The layer that builds each owned element of the grid: 0 for the substrate, never_built for the void.
/// Local. \param layer_index  the layer that builds each part element, from 1 (Layers::layer_index())
template <int Dim>
std::vector<double> built_layers(const Part<Dim>& part, std::span<const double> layer_index);

}  // namespace fabseq
