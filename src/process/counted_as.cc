// SPDX-License-Identifier: MIT
#include "fabseq/process/counted_as.h"

namespace fabseq {

namespace {

/// Adds what counts of the increments of a block; no weights: all of it.
void add_counted(const LaneVector& increments, const LaneVector* weights, std::vector<double>& displacement) {
  for (std::size_t i = 0; i < increments.unknowns(); ++i)
    for (int lane = 0; lane < increments.lanes; ++lane) {
      const double weight = weights == nullptr ? 1.0 : (*weights)(i / increments.components, lane);
      displacement[i] += weight * increments(i, lane);
    }
}

}  // namespace

template <int Dim>
CountedAs<Dim>::CountedAs(DepositionModel model, const ElasticModel<Dim>& elastic, const LayerGroups& groups,
                          const LayerDensities& densities, ProcessResult& result)
    : result_(result), displacement_(result.displacement.size(), 0.0) {
  if (model == DepositionModel::nominal)
    groups.run([&] {
      const Deposition<Dim> deposition(elastic);
      for (const LayerBlock& block : result.blocks)
        weights_.push_back(deposition.weights(densities, block.first, block.lanes));
    });
  for (std::size_t block = 0; block < result.blocks.size(); ++block)
    add_counted(result.increments[block], weights_.empty() ? nullptr : &weights_[block], displacement_);
  groups.sum(displacement_);
  exchange();
}

FABSEQ_INSTANTIATE_CLASS(CountedAs);

}  // namespace fabseq
