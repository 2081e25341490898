// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/strain_source.h"

#include <span>
#include <vector>

namespace fabseq {

/// The strain that each element takes up in the layer that builds it.
struct BuiltStrain {
  bool uniform = false;        ///< the same everywhere
  std::vector<double> values;  ///< [part element][Voigt], or [Voigt] where it is uniform
};

/// The same for the numbers of these layers, from 1 on, of all part elements (Layers::layer_index()). Local.
template <int Dim>
BuiltStrain strain_when_built(const StrainSource<Dim>& strains, std::span<const double> layer);

}  // namespace fabseq
