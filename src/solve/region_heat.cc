// SPDX-License-Identifier: MIT
#include "solve/region_heat.h"

namespace fabseq {

template <int Dim>
void RegionHeat<Dim>::set_operator(const HeatOperator& of) {
  HeatSolver<Dim>& solver = pool_.choose(elements_with_values(of.diffusivity, 1));
  const std::vector<double> diffusivity = pool_.picked(of.diffusivity, 1),
                            reaction = pool_.picked(of.reaction, 1);
  solver.set_operator(HeatOperator{diffusivity, reaction, of.diagonal});
}

FABSEQ_INSTANTIATE_CLASS(RegionHeat);

}  // namespace fabseq
