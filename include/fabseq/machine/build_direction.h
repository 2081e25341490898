// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/layers/layers.h"

#include <span>
#include <vector>

namespace fabseq {

/// The unit vector along which material is added at each part element, [part element][axis]
/// (docs/formulation.md 13.1): the print direction of multi-planar layers, grad t / |grad t| of others, 0 at
/// elements where that vanishes. Local.
/// \param gradient     TimeGradient::values
/// \param layer_index  the layer that builds each part element, from 1 (Layers::layer_index())
template <int Dim>
std::vector<double> build_direction(std::span<const double> gradient, const LayerDensities& layers,
                                    std::span<const double> layer_index);

}  // namespace fabseq
