// SPDX-License-Identifier: MIT
#include "process/layer_deposit.h"

namespace fabseq {

template <int Dim>
LayerDeposit layer_deposit(const ElasticModel<Dim>& model, const StrainSource<Dim>& strains,
                           std::span<const double> densities, int layer, std::span<const int> elements) {
  LayerDeposit result;
  for (const int element : elements) {
    const double factor = model.load(densities[element]);
    if (factor == 0.0) continue;
    result.elements.push_back(element);
    result.factors.push_back(factor);
  }
  result.strains.resize(result.elements.size() * voigt_size<Dim>);
  strains.set_strains(result.elements, {layer, 1}, result.strains);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(layer_deposit);

}  // namespace fabseq
