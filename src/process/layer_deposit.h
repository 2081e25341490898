// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/elastic_model.h"
#include "fabseq/process/strain_source.h"

#include <span>
#include <vector>

namespace fabseq {

/// What a layer deposits: elements with load factors drho^q and the strains that they multiply
/// (docs/formulation.md 4.1).
struct LayerDeposit {
  std::vector<int> elements;    ///< part elements whose factor is not 0
  std::vector<double> factors;  ///< [one of these]
  std::vector<double> strains;  ///< [one of these][Voigt]

  template <int Dim>
  std::span<const double> strain(std::size_t number) const {
    return std::span(strains).subspan(number * voigt_size<Dim>, voigt_size<Dim>);
  }
};

/// What a layer, by its number, with these densities deposits in some of the part's elements. Local.
template <int Dim>
LayerDeposit layer_deposit(const ElasticModel<Dim>& model, const StrainSource<Dim>& strains,
                           std::span<const double> densities, int layer, std::span<const int> elements);

}  // namespace fabseq
