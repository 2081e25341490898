// SPDX-License-Identifier: MIT
#include "process/solve_count.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace fabseq {

void SolveCount::add(const std::vector<SolveReport>& reports, const BlockRegion& block, const char* what) {
  for (int lane = 0; const SolveReport& report : reports) {
    if (!report.converged || !std::isfinite(report.residual))
      throw NumericalError(
          formatted("layer %d: the elastic %s solve did not converge: %d iterations, relative "
                    "preconditioned residual %g (%s)",
                    block.layer(lane) + 1, what, report.iterations, report.residual, report.reason.c_str()));
    const int step = block.block.first + lane++;
    largest[step] = std::max(largest[step], report.iterations);
    all[step] += report.iterations;
  }
}

void SolveCount::gather(const LayerGroups& groups) {
  std::vector<int> both = largest;
  both.insert(both.end(), all.begin(), all.end());
  groups.sum(both);
  const auto middle = both.begin() + std::ssize(largest);
  largest.assign(both.begin(), middle);
  all.assign(middle, both.end());
}

}  // namespace fabseq
