// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/solve/heat_solver.h"

#include <mpi.h>

#include <functional>
#include <string>
#include <vector>

namespace fabseq {

/// A sequence's own equation. It has a single right-hand side, which cannot be shared out: the first layer
/// group solves it and sends the solution to the others, so that all have the same bits. Warm solves begin
/// with the last solution. All but the constructor and iterations() is collective on the grid's communicator.
template <int Dim>
class SharedSolve {
 public:
  /// `across`: this rank and its copies in other layer groups. The solver must outlive the object.
  SharedSolve(HeatSolver<Dim>& solver, MPI_Comm across) : solver_(solver), across_(across) {}

  void set_tolerance(const SolveTolerance& tolerance);
  void start_cold();
  /// Returns the solution on the owned nodes. `set_up` sets the solver's operator, in each group. Throws
  /// NumericalError if `what` does not converge. Collective on `across`, too.
  const std::vector<double>& solve(const LaneVector& load, const std::function<void()>& set_up,
                                   const std::string& what);
  /// Iterations of the last solve.
  int iterations() const { return iterations_; }

 private:
  HeatSolver<Dim>& solver_;
  MPI_Comm across_;
  bool warm_ = false;
  std::vector<double> last_;  ///< solution; empty: none
  int iterations_ = 0;
};

}  // namespace fabseq
