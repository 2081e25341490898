// SPDX-License-Identifier: MIT
#include "process/step_results.h"

namespace fabseq {

template <int Dim>
void set_steps(const StepSystems<Dim>& systems, ProcessResult& result) {
  const std::size_t blocks = systems.blocks().size();
  result.steps = systems.steps();
  result.blocks.clear();
  for (const BlockRegion& block : systems.blocks()) result.blocks.push_back(block.block);
  result.nodes.assign(blocks, systems.model().nodes);
  result.weights.resize(systems.model().settings.deposition == DepositionModel::nominal ? blocks : 0);
  for (std::size_t number = 0; number < result.case_count(); ++number) {
    result.of_case(number).displacement.assign(systems.model().domain.fixed.size(), 0.0);
    result.of_case(number).increments.resize(blocks);
  }
}

template <int Dim>
void count_block(const Deposition<Dim>* deposition, const LayerDensities& densities, std::size_t block,
                 ProcessResult& result) {
  if (deposition != nullptr)
    result.weights[block] = deposition->weights(densities, result.steps_of(block), result.nodes[block]);
  for (std::size_t number = 0; number < result.case_count(); ++number)
    result.add_counted(block, result.of_case(number));
}

void sum_displacements(const LayerGroups& groups, ProcessResult& result) {
  for (std::size_t number = 0; number < result.case_count(); ++number)
    groups.sum(result.of_case(number).displacement);
}

FABSEQ_INSTANTIATE_FUNCTION(set_steps);
FABSEQ_INSTANTIATE_FUNCTION(count_block);

}  // namespace fabseq
