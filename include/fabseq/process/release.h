// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/rigid_motions.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/solve/lane_free_body.h"
#include "fabseq/solve/reference/assembled_system.h"
#include "fabseq/solve/solver_settings.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// Why a part on these supports cannot be released; empty if it can. Pieces that nothing but their supports
/// holds together could each move as they like. Collective on the grid's communicator.
template <int Dim>
std::string release_obstacle(const Grid<Dim>& grid, const Supports<Dim>& supports, VoidModel void_model);

/// What a release is solved with.
struct ReleaseSolver {
  AssembledSolverSettings reference;  ///< also where lanes do not converge; its tolerance is that of both
  SolverPath path = SolverPath::reference;
  LaneCycle cycle = {};
};

/// The solver that a run asks for, to `tolerance`.
ReleaseSolver release_solver(const SolverSettings& settings, double tolerance);

/// The finished part cut from the plate, or from its clamps (docs/formulation.md 4.3): solves with its
/// stiffness K_N, its supports free:
///
///     v:  K_N v~ = -r,             v = v~ - R C v~        of reactions r that balance themselves,
///     w:  K_N w = b - C^T R^T b                           its adjoint, b = -dJ/dv.
///
/// K_N is the same whatever the sequence: it is set up at the first solve and kept with its preconditioner.
/// All calls are collective on the grid's communicator.
template <int Dim>
class Release {
 public:
  /// The model must outlive the object. Throws InputError if there is a release_obstacle().
  Release(const ElasticModel<Dim>& model, const ReleaseSolver& solver);

  /// v for reactions r, [owned node][component]; 0 outside the model. Throws NumericalError if the solve does
  /// not converge.
  std::vector<double> displacement(std::span<const double> reactions);
  /// w for a derivative dJ/dv, whose rigid part is that with the smallest motion of the supports.
  std::vector<double> adjoint(std::span<const double> derivative);
  /// Later solves go to this tolerance.
  void set_tolerance(double tolerance);
  /// Forgets the system: from here on everything goes as in a new object, to the last bit.
  void start_cold();

 private:
  std::vector<double> solve(const std::vector<double>& load, const char* what);
  SolveReport solve_by_lanes(const std::vector<double>& load, std::vector<double>& solution);
  SolveReport solve_by_reference(const std::vector<double>& load, std::vector<double>& solution);

  const ElasticModel<Dim>& model_;
  ReleaseSolver settings_;
  RigidMotions<Dim> rigid_motions_;  ///< fitted to the supports of part and substrate
  SystemDomain domain_;              ///< the model's, on supports that hold rigid motions and nothing else
  std::shared_ptr<const UnknownNumbering<Dim>> numbering_;
  std::unique_ptr<LaneFreeBody<Dim>> lanes_;  ///< made at first use, as well as
  std::unique_ptr<AssembledSystem<Dim>> system_;
};

}  // namespace fabseq
