// SPDX-License-Identifier: MIT
#include "process/strained_elements.h"

#include "process/load_factors.h"

namespace fabseq {

template <int Dim>
StrainedElements strained_elements(const ElasticModel<Dim>& model, const StrainSource<Dim>& strains,
                                   const LayerDensities& densities, const BuildStep& step, int number,
                                   std::span<const int> elements) {
  StrainedElements result;
  const LoadFactors<Dim> factors(model, densities, step);
  for (const int element : elements) {
    const double factor = factors(element);
    if (factor == 0.0) continue;
    result.elements.push_back(element);
    result.factors.push_back(factor);
  }
  result.strains.resize(result.elements.size() * voigt_size<Dim>);
  strains.set_strains(result.elements, {number, 1}, result.strains);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(strained_elements);

}  // namespace fabseq
