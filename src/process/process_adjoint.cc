// SPDX-License-Identifier: MIT
#include "fabseq/process/process_adjoint.h"

namespace fabseq {

LaneVector weight_derivatives(const ProcessAdjoint& functional, const ProcessResult& result,
                              std::size_t block, const LaneVector& increments) {
  LaneVector weights(increments.nodes, 1, increments.lanes);
  for (std::size_t i = 0; i < increments.unknowns(); ++i) {
    const double common = functional.displacement.empty()
                              ? 0.0
                              : functional.displacement[result.in_field(block, i, increments.components)];
    for (int lane = 0; lane < increments.lanes; ++lane) {
      const double own = functional.increments.empty() ? 0.0 : functional.increments[block](i, lane);
      weights(i / increments.components, lane) += (common + own) * increments(i, lane);
    }
  }
  return weights;
}

}  // namespace fabseq
