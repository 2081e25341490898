// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/strain_source.h"

#include <span>
#include <vector>

namespace fabseq {

/// What is strained in a step: elements with load factors and the strains that they multiply (BuildStep).
struct StrainedElements {
  std::vector<int> elements;    ///< part elements whose factor is not 0
  std::vector<double> factors;  ///< [one of these]
  std::vector<double> strains;  ///< [one of these][Voigt]

  template <int Dim>
  std::span<const double> strain(std::size_t number) const {
    return std::span(strains).subspan(number * voigt_size<Dim>, voigt_size<Dim>);
  }
};

/// What is strained in a step, by its number, of some of the part's elements. Local.
template <int Dim>
StrainedElements strained_elements(const ElasticModel<Dim>& model, const StrainSource<Dim>& strains,
                                   const LayerDensities& densities, const BuildStep& step, int number,
                                   std::span<const int> elements);

}  // namespace fabseq
