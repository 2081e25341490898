// SPDX-License-Identifier: MIT
#include "fabseq/process/process_result.h"

namespace fabseq {

void add_scaled(std::vector<double>& to, double factor, const std::vector<double>& from) {
  to.resize(from.size(), 0.0);
  for (std::size_t i = 0; i < from.size(); ++i) to[i] += factor * from[i];
}

void ProcessResult::add_counted(std::size_t block, CaseDisplacements& of) const {
  const LaneVector& own = of.increments[block];
  for (std::size_t i = 0; i < own.unknowns(); ++i) {
    const double* share = weights.empty() ? nullptr : &weights[block].values[i / own.components * own.lanes];
    for (int lane = 0; lane < own.lanes; ++lane)
      of.displacement[in_field(block, i, own.components)] +=
          (share != nullptr ? share[lane] : 1.0) * own(i, lane);
  }
}

}  // namespace fabseq
