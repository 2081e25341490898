// SPDX-License-Identifier: MIT
#include "process/elastic_adjoint.h"

#include "fabseq/process/superposition.h"
#include "process/case_strain.h"

namespace fabseq {

template <int Dim>
std::size_t ElasticAdjoint<Dim>::begin(std::size_t block) {
  if (run_.deposition != nullptr)
    missing_ = run_.deposition->missing(run_.densities, run_.result.steps_of(block));
  solved_.clear();
  for (std::size_t i = 0; i < functionals_.size(); ++i) {
    if (loads_.any(i, run_.result.blocks[block]))
      solved_.push_back(i);
    else
      add_derivatives(block, functionals_[i], nullptr);
  }
  return solved_.size();
}

template <int Dim>
void ElasticAdjoint<Dim>::set(std::size_t block, std::size_t side, LaneVector& load) {
  const ElasticFunctional& functional = functionals_[solved_[side]];
  loads_.set(*functional.from, solved_[side], run_.result, block, load);
  if (!functional.motion.empty())
    run_.supports.subtract_motion(run_.densities, run_.systems.blocks()[block], functional.motion, load);
}

template <int Dim>
void ElasticAdjoint<Dim>::take(std::size_t block, std::size_t side, LaneVector& solution) {
  const ElasticFunctional& functional = functionals_[solved_[side]];
  if (!functional.motion.empty()) run_.supports.add_motion(functional.motion, solution);
  add_derivatives(block, functional, &solution);
}

template <int Dim>
void ElasticAdjoint<Dim>::add_derivatives(std::size_t block, const ElasticFunctional& functional,
                                          const LaneVector* adjoint) {
  const ProcessDerivatives& to = *functional.to;
  const std::vector<double>& combination = functional.from->combination;
  LaneVector combined;
  if (!combination.empty()) combined = run_.result.superposition->increments(run_.result, combination, block);
  const LaneVector& increments = combination.empty() ? run_.result.increments[block] : combined;
  if (adjoint != nullptr) {
    // Functionals of the same block share its increments.
    if (spread_from_ != &increments)
      spread(increments, run_.result.nodes[block], run_.systems.owned_nodes(), run_.increments);
    spread_from_ = combination.empty() ? &increments : nullptr;
    run_.systems.elements().add_derivatives(
        run_.densities, run_.systems.blocks()[block],
        CaseStrain<Dim>(run_.strains, run_.cases.factors(combination)), run_.increments, *adjoint,
        *to.densities, to.strains != nullptr ? std::span(*to.strains) : std::span<double>());
  }
  if (run_.deposition != nullptr)
    run_.deposition->add_derivatives(missing_, run_.result.steps_of(block), run_.result.nodes[block],
                                     weight_derivatives(*functional.from, run_.result, block, increments),
                                     *to.densities);
  if (to.sink != nullptr) to.sink->flush();
}

FABSEQ_INSTANTIATE_CLASS(ElasticAdjoint);

}  // namespace fabseq
