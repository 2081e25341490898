// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/parallel/layer_groups.h"
#include "fabseq/process/deposition.h"
#include "fabseq/process/process_result.h"

#include <vector>

namespace fabseq {

/// Lets a result count its increments as a deposition model does (docs/formulation.md 4.6) for as long as the
/// object lives; then the result is as before. Weights and displacement change, and need no solve: increments
/// and release are the same in both models.
template <int Dim>
class CountedAs {
 public:
  /// `densities`: those that were simulated. The result must outlive the object, and must not be simulated
  /// anew before its end. Collective on the world of the groups.
  CountedAs(DepositionModel model, const ElasticModel<Dim>& elastic, const LayerGroups& groups,
            const LayerDensities& densities, ProcessResult& result);
  ~CountedAs() { exchange(); }
  CountedAs(const CountedAs&) = delete;
  CountedAs& operator=(const CountedAs&) = delete;

 private:
  /// Exchanges what the result counts with what this object keeps.
  void exchange() {
    result_.weights.swap(weights_);
    for (std::size_t number = 0; number < displacements_.size(); ++number)
      result_.of_case(number).displacement.swap(displacements_[number]);
  }

  ProcessResult& result_;
  std::vector<LaneVector> weights_;
  std::vector<std::vector<double>> displacements_;  ///< [strain case]
};

}  // namespace fabseq
