// SPDX-License-Identifier: MIT
#include "fabseq/process/counted_as.h"

namespace fabseq {

template <int Dim>
CountedAs<Dim>::CountedAs(DepositionModel model, const ElasticModel<Dim>& elastic, const LayerGroups& groups,
                          const LayerDensities& densities, ProcessResult& result)
    : result_(result), displacements_(result.case_count()) {
  if (model == DepositionModel::nominal)
    groups.run([&] {
      const Deposition<Dim> deposition(elastic);
      for (std::size_t block = 0; block < result.blocks.size(); ++block)
        weights_.push_back(deposition.weights(densities, result.steps_of(block), result.nodes[block]));
    });
  for (auto& displacement : displacements_) displacement.assign(result.displacement.size(), 0.0);
  exchange();
  for (std::size_t number = 0; number < displacements_.size(); ++number) {
    for (std::size_t block = 0; block < result.blocks.size(); ++block)
      result.add_counted(block, result.of_case(number));
    groups.sum(result.of_case(number).displacement);
  }
}

FABSEQ_INSTANTIATE_CLASS(CountedAs);

}  // namespace fabseq
