// SPDX-License-Identifier: MIT
/// \file
/// Inherent strains of a whole process, or derivatives by them.
#pragma once

#include <vector>

namespace fabseq {

/// Voigt, engineering shear: a strain of its own for each part element or for each layer; if both are empty,
/// the material's for all.
struct StrainField {
  std::vector<double> of_elements;  ///< [part element][Voigt]
  std::vector<double> of_layers;    ///< [layer][Voigt]

  bool uniform() const { return of_elements.empty() && of_layers.empty(); }
};

}  // namespace fabseq
