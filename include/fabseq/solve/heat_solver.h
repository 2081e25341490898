// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/solve/solve_report.h"
#include "fabseq/solve/solve_tolerance.h"

#include <span>
#include <vector>

namespace fabseq {

/// An operator of a HeatSolver.
struct HeatOperator {
  std::span<const double> diffusivity;    ///< kappa of each element of the domain, in its order
  std::span<const double> reaction;       ///< alpha of each element, in units of kappa / length^2
  std::span<const double> diagonal = {};  ///< d of each owned node, not negative; empty: 0
};

/// What the heat sequence and steps of heat conduction in time ask of a solver: conduction with a reaction
/// term on the elements of a domain, for many right-hand sides (docs/formulation.md 2.1, 14.1),
///
///     K = sum_e kappa_e int grad N_i . grad N_j + alpha_e int N_i N_j + d,
///
/// the values at fixed nodes being zero: a lifted solution is the caller's.
template <int Dim>
class HeatSolver {
 public:
  virtual ~HeatSolver() = default;

  /// Makes K the operator of the solves that follow. Collective.
  virtual void set_operator(const HeatOperator& of) = 0;
  /// Makes K an operator with the same reaction in all elements and no diagonal.
  void set_operator(std::span<const double> diffusivity, double reaction) {
    const std::vector<double> reactions(diffusivity.size(), reaction);
    set_operator(HeatOperator{diffusivity, reactions});
  }

  /// Solves K x = b for every lane of each of `loads`, at most `widest_block` lanes a block, on the owned
  /// nodes; values at fixed nodes are ignored and come back 0. `solutions` have the sizes of `loads`. Returns
  /// one report per right-hand side, block by block. Collective; does not throw if one does not converge.
  virtual std::vector<SolveReport> solve(std::span<const LaneVector> loads,
                                         std::span<LaneVector> solutions) = 0;
  /// The same from first guesses, which `solutions` hold; 0 in a lane: none. A solver may do without.
  virtual std::vector<SolveReport> improve(std::span<const LaneVector> loads,
                                           std::span<LaneVector> solutions) {
    return solve(loads, solutions);
  }

  /// Later solves go to this tolerance; on the reference path collective.
  virtual void set_tolerance(const SolveTolerance& tolerance) = 0;

  /// Forgets what earlier solves have left for later ones, the operator too: from here on everything goes as
  /// in a new solver, to the last bit. Collective.
  virtual void start_cold() = 0;

  /// Gives back what it can take again, its operator included. Changes no result. Not collective.
  virtual void release_memory() {}
  /// Whether it is to give back memory whenever other phases come before the next solve.
  virtual bool saves_memory() const { return false; }
};

}  // namespace fabseq
