// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/multigrid/lane_cycle.h"
#include "fabseq/solve/solve_report.h"

#include <memory>
#include <span>

namespace fabseq {

/// An elastic body that nothing holds: solves K u = f for loads that balance themselves, u without a mean
/// rigid motion: lane conjugate gradients in the space without rigid motions. No level is held anywhere; the
/// last one is a little stiffer on its diagonal, for its factorization. The operator is set up once.
/// Collective on the grid's communicator.
template <int Dim>
class LaneFreeBody {
 public:
  /// `domain`: its elements count, its supports do not; one piece by nodes that hold each other. `stiffness`:
  /// factor of each element. The grid must outlive the solver.
  LaneFreeBody(const Grid<Dim>& grid, const SystemDomain& domain, double poisson, const LaneCycle& cycle,
               std::span<const double> stiffness);
  ~LaneFreeBody();

  /// Loads and displacements are [owned node][component]; 0 at nodes of no element. Does not throw if it does
  /// not converge. Throws Stopped, on all ranks in the same iteration, if one was asked to stop.
  SolveReport solve(std::span<const double> load, std::span<double> displacement, double tolerance);

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;  ///< as wide as the registers of this processor
};

}  // namespace fabseq
