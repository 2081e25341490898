// SPDX-License-Identifier: MIT
#include "fabseq/process/solve_count.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace fabseq {

void SolveCount::add(const std::vector<SolveReport>& reports, int layer, const char* what) {
  for (const SolveReport& report : reports) {
    if (!report.converged || !std::isfinite(report.residual))
      throw NumericalError(
          formatted("layer %d: the elastic %s solve did not converge: %d iterations, relative "
                    "preconditioned residual %g (%s)",
                    layer + 1, what, report.iterations, report.residual, report.reason.c_str()));
    largest[layer] = std::max(largest[layer], report.iterations);
    all[layer] += report.iterations;
    ++layer;
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
