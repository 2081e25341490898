// SPDX-License-Identifier: MIT
#include "sequence/time_adjoints.h"

#include "fabseq/sequence/element_means.h"

#include <algorithm>
#include <limits>

namespace fabseq {

template <int Dim>
std::vector<int> solve_time_adjoints(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                                     HeatSolver<Dim>& solver, std::span<const TimeDerivatives> rows,
                                     int lanes, const std::function<void(const LaneVector& adjoints)>& use,
                                     const std::string& what) {
  // PETSc's indices must be able to count the values at all nodes of the grid.
  const std::int64_t limit = std::numeric_limits<PetscInt>::max() / part.grid().all_nodes().count();
  const std::size_t together = std::clamp<std::int64_t>(limit, 1, lanes);
  std::vector<int> iterations;
  for (std::size_t first = 0; first < rows.size(); first += together) {
    const LaneVector loads =
        pull_back_means(part, element, rows.subspan(first, std::min(together, rows.size() - first)));
    LaneVector adjoints = loads;
    for (const SolveReport& report : solver.solve({&loads, 1}, {&adjoints, 1})) {
      require_convergence(report, what);
      iterations.push_back(report.iterations);
    }
    use(adjoints);
  }
  return iterations;
}

FABSEQ_INSTANTIATE_FUNCTION(solve_time_adjoints);

}  // namespace fabseq
