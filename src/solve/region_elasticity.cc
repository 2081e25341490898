// SPDX-License-Identifier: MIT
#include "solve/region_elasticity.h"

namespace fabseq {

template <int Dim>
void RegionElasticity<Dim>::set_operators(int first_layer, int lanes, std::span<const double> stiffness,
                                          bool changed) {
  ElasticitySolver<Dim>& before = pool_.current();
  ElasticitySolver<Dim>& solver = pool_.choose(elements_with_values(stiffness, lanes));
  if (&solver != &before) before.give_back_memory();
  if (tolerance_) solver.set_tolerance(*tolerance_);
  solver.set_operators(first_layer, lanes, pool_.picked(stiffness, lanes), changed);
}

template <int Dim>
void RegionElasticity<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  tolerance_ = tolerance;
  pool_.current().set_tolerance(tolerance);
}

template <int Dim>
void RegionElasticity<Dim>::start_cold() {
  pool_.for_each([](ElasticitySolver<Dim>& solver) { solver.start_cold(); });
}

template <int Dim>
void RegionElasticity<Dim>::give_back_memory() {
  pool_.for_each([](ElasticitySolver<Dim>& solver) { solver.give_back_memory(); });
}

FABSEQ_INSTANTIATE_CLASS(RegionElasticity);

}  // namespace fabseq
