// SPDX-License-Identifier: MIT
#include "solve/region_heat.h"

namespace fabseq {

template <int Dim>
void RegionHeat<Dim>::set_operator(const HeatOperator& of) {
  HeatSolver<Dim>& before = pool_.current();
  HeatSolver<Dim>& solver = pool_.choose(elements_with_values(of.diffusivity, 1));
  if (&solver != &before) before.give_back_memory();
  if (tolerance_) solver.set_tolerance(*tolerance_);
  const std::vector<double> diffusivity = pool_.picked(of.diffusivity, 1),
                            reaction = pool_.picked(of.reaction, 1);
  solver.set_operator(HeatOperator{diffusivity, reaction, of.diagonal});
}

template <int Dim>
void RegionHeat<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  tolerance_ = tolerance;
  pool_.current().set_tolerance(tolerance);
}

template <int Dim>
void RegionHeat<Dim>::start_cold() {
  pool_.for_each([](HeatSolver<Dim>& solver) { solver.start_cold(); });
}

template <int Dim>
void RegionHeat<Dim>::give_back_memory() {
  pool_.for_each([](HeatSolver<Dim>& solver) { solver.give_back_memory(); });
}

FABSEQ_INSTANTIATE_CLASS(RegionHeat);

}  // namespace fabseq
