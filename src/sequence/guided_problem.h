// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/part/part.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/solve/heat_solver.h"
#include "sequence/shared_solve.h"

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// The nodal times whose gradient follows given vectors v_e as far as a gradient can (docs/formulation.md
/// 2.4):
///
///     K t = f on the free nodes, t = 0 on those of start_domain(),
///     K = sum_e kappa_e int grad N_i . grad N_j,  f = sum over the part of int grad N_i . v_e,
///
/// kappa = 1 in the part and less in the void. K never changes: it is set up once, and again only where the
/// solver is told to forget it.
template <int Dim>
class GuidedProblem {
 public:
  /// Makes a solver on a domain, to which it may refer; `lumped`: whether the mass matrix is diagonal.
  using MakeSolver = std::function<std::unique_ptr<HeatSolver<Dim>>(const SystemDomain& domain, bool lumped)>;

  /// Collective on the grid's communicator. `part` and `across` must outlive the problem.
  /// \param across  this rank and its copies in other layer groups. The group of the first one solves for the
  ///                times and sends them to the others, so that all have the same bits.
  /// \param lanes   most rows that are solved side by side
  GuidedProblem(const Part<Dim>& part, double void_diffusivity, const MakeSolver& make_solver,
                MPI_Comm across, int lanes);

  /// Element matrices, whose mean and gradient those of nodal times are.
  const ElementMatrices<Dim>& element() const { return element_; }

  /// Times on the owned nodes. `vectors`: v, [part element][axis], 1/length. Collective on the grid's
  /// communicator and on `across`.
  std::vector<double> times(std::span<const double> vectors);
  /// Iterations of the last times().
  int iterations() const { return forward_.iterations(); }

  /// Derivatives with respect to v, [part element][axis], one list per row. Collective on the grid's
  /// communicator; each group acts on its own.
  std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows);
  /// Iterations of the last pull_back(), one entry per row.
  const std::vector<int>& adjoint_iterations() const { return adjoint_iterations_; }

  void set_tolerance(const SolveTolerance& tolerance) { forward_.set_tolerance(tolerance); }
  void start_cold();
  void release_memory() { solver_->release_memory(); }

 private:
  void set_up();

  const Part<Dim>& part_;
  ElementMatrices<Dim> element_;
  SystemDomain domain_;
  std::vector<double> diffusivity_;  ///< of all owned elements of the grid
  std::unique_ptr<HeatSolver<Dim>> solver_;
  SharedSolve<Dim> forward_;
  int lanes_;
  bool is_set_up_ = false;
  std::vector<int> adjoint_iterations_;
};

}  // namespace fabseq
