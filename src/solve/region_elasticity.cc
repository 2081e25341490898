// SPDX-License-Identifier: MIT
#include "solve/region_elasticity.h"

namespace fabseq {

template <int Dim>
void RegionElasticity<Dim>::set_operators(int first_layer, int lanes, std::span<const double> stiffness,
                                          bool changed) {
  ElasticitySolver<Dim>& solver = pool_.choose(elements_with_values(stiffness, lanes));
  solver.set_operators(first_layer, lanes, pool_.picked(stiffness, lanes), changed);
}

FABSEQ_INSTANTIATE_CLASS(RegionElasticity);

}  // namespace fabseq
