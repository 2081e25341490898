// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "fabseq/process/adjoint_loads.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/deposition.h"
#include "fabseq/process/process_adjoint.h"
#include "fabseq/process/process_result.h"
#include "fabseq/process/release.h"
#include "fabseq/process/step_systems.h"
#include "fabseq/process/strain_cases.h"
#include "fabseq/process/strain_source.h"
#include "fabseq/process/superposition.h"
#include "fabseq/process/support_forces.h"
#include "fabseq/solve/elasticity_solver.h"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// The layer-by-layer inherent-strain simulation and its adjoint (docs/formulation.md 4.1,
/// docs/developer/derivatives.md 8.2). Each step adds its increment to the displacement, u = sum of du_s,
/// where K_s du_s = f_s (StepSystems, BuildStep).
///
/// Under nominal deposition (4.6), u is the sum of w_j du_s, j the step's layer. Adjoint: K_s lambda_s =
/// -w_j (dJ/du + dJ/d(w_j du_s)), then dJ/drho_j,e = E' lambda^T K_0 du, and dJ/d(drho_j,e) = -q
/// drho^(q-1) lambda^T f_0 where the layer is added. For what is measured after the release (Release),
/// lambda_s on the supports is not 0 but the release's adjoint w.
///
/// With scenarios of the strain, one system has several right-hand sides (StrainCases). Under nominal
/// deposition, adjoints of steps with a negligible load are left out (AdjointLoads).
///
/// Layer groups share the steps; a deal holds from simulate() to the next. All calls are collective on the
/// world of the groups, and errors are thrown on all of its ranks.
template <int Dim>
class ElasticProcess {
 public:
  /// `lanes`: steps solved side by side at most. `blocks`: how the solver goes through a block of them. Model
  /// and groups must outlive the process.
  ElasticProcess(const ElasticModel<Dim>& model, std::unique_ptr<ElasticitySolver<Dim>> solver,
                 const LayerGroups& groups, BlockSolver blocks, int lanes = widest_block);
  ElasticProcess(const ElasticProcess&) = delete;  // the result refers to its members
  ElasticProcess& operator=(const ElasticProcess&) = delete;

  /// Lets later simulations end with the release from the supports. Throws InputError if there is none
  /// (release_obstacle()).
  void release_with(const ReleaseSolver& solver) {
    release_ = std::make_unique<Release<Dim>>(model(), solver);
  }
  /// Simulates all steps; the result stays valid until the next call. Throws NumericalError naming the layer
  /// if one does not converge. `strains` must stay as it is while the result is used.
  const ProcessResult& simulate(const LayerDensities& densities, const StrainSource<Dim>& strains,
                                std::vector<BuildStep> steps);
  /// The same with a step for each layer.
  const ProcessResult& simulate(const LayerDensities& densities, const StrainSource<Dim>& strains) {
    return simulate(densities, strains, steps_of_layers(densities.count()));
  }
  /// Adds the derivatives of several functionals at the last simulated densities and strains, with respect to
  /// the densities of this group's steps and to the inputs of the strains, as far as they enter its steps.
  /// Functionals solved together share the systems.
  void pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> functionals,
                 std::span<const ProcessDerivatives> derivatives);
  /// Forces of the supports on the last simulation's part, sum_s (K_s du_s - f_s), [owned node][component], 0
  /// elsewhere, for unit Young's modulus. They balance themselves. `number`: of the strain case.
  std::vector<double> reactions(const LayerDensities& densities, std::size_t number = 0) const;
  /// Increments of any step, or of any layer in all its steps, on the owned nodes, [node][component]; sent by
  /// the group that has them. `counted`: what the displacement has of them.
  std::vector<double> step_increment(int step, bool counted = false) const;
  std::vector<double> layer_increment(int layer, bool counted = false) const;
  /// Gives back the memory of the last simulation's increments and of the solver; what needs increments needs
  /// a further simulation. Not collective.
  void release_memory();
  /// Returns the result of the last simulation, for CountedAs.
  ProcessResult& result() { return result_; }
  /// Strains of the last simulation, as given.
  const StrainSource<Dim>& strains() const { return *strains_; }
  /// Later simulations and adjoints are solved to this tolerance.
  void set_tolerance(const SolveTolerance& tolerance);
  /// Forgets what earlier solves have left in the solvers for later ones.
  void start_cold();
  /// Iterations of the adjoint solves of the last pull_back(), the largest of its functionals for each step.
  const std::vector<int>& adjoint_iterations() const { return adjoint_iterations_; }
  /// The systems, for what is to be said of their solves.
  StepSystems<Dim>& systems() { return systems_; }
  const StepSystems<Dim>& systems() const { return systems_; }
  const LayerGroups& groups() const { return systems_.groups(); }
  const ElasticModel<Dim>& model() const { return systems_.model(); }

 private:
  class Forward;
  /// A field of a solve that the first group does for all: a single right-hand side cannot be shared out.
  std::vector<double> in_first_group(const std::function<std::vector<double>()>& solve);

  StrainCases<Dim> cases_;
  Superposition superposition_;
  StepSystems<Dim> systems_;
  SupportForces<Dim> supports_;
  std::unique_ptr<const Deposition<Dim>> deposition_;  ///< nullptr: all of the increments counts
  AdjointLoads<Dim> adjoint_loads_;
  std::unique_ptr<Release<Dim>> release_;       ///< if asked for
  const StrainSource<Dim>* strains_ = nullptr;  ///< of the last simulation
  ProcessResult result_;
  std::vector<int> adjoint_iterations_;
};

}  // namespace fabseq
