// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "fabseq/process/adjoint_loads.h"
#include "fabseq/process/built_region.h"
#include "fabseq/process/deposition.h"
#include "fabseq/process/layer_elements.h"
#include "fabseq/process/process_adjoint.h"
#include "fabseq/process/process_result.h"
#include "fabseq/process/release.h"
#include "fabseq/process/solve_count.h"
#include "fabseq/process/strain_cases.h"
#include "fabseq/process/strain_source.h"
#include "fabseq/process/support_forces.h"
#include "fabseq/solve/elasticity_solver.h"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// The layer-by-layer inherent-strain simulation and its adjoint (docs/formulation.md 4.1,
/// docs/developer/derivatives.md 8.2). For each layer j: K_j du_j = f_j with the plate fixed, u = sum of
/// du_j,
///
///     K_j = sum_e E(rho_j,e) K_0,   f_j = sum_e (drho_j,e)^q int B^T C eps*.
///
/// Under nominal deposition (4.6), u is the sum of w_j du_j. Adjoint: K_j lambda_j = -w_j (dJ/du + dJ/d(w_j
/// du_j)), then dJ/drho_j,e = E' lambda^T K_0 du and dJ/d(drho_j,e) = -q
/// drho^(q-1) lambda^T f_0. For what is measured after the release (Release), lambda_j on the supports is not
/// 0 but the release's adjoint w.
///
/// With scenarios of the strain, one system has several right-hand sides (StrainCases). Under nominal
/// deposition, adjoints of layers with a negligible load are left out (AdjointLoads).
///
/// Layer groups share the layers; a deal holds from simulate() to the next. All calls are collective on the
/// world of the groups, and errors are thrown on all of its ranks.
template <int Dim>
class ProcessSimulation {
 public:
  /// `lanes`: layers solved side by side at most. `blocks`: how the solver goes through a block of layers.
  /// Model and groups must outlive the simulation.
  ProcessSimulation(const ElasticModel<Dim>& model, std::unique_ptr<ElasticitySolver<Dim>> solver,
                    const LayerGroups& groups, BlockSolver blocks, int lanes = widest_block);

  /// From now on simulations end with the release from the supports. Throws InputError if there is none
  /// (release_obstacle()).
  void release_with(const ReleaseSolver& solver) {
    release_ = std::make_unique<Release<Dim>>(model_, solver);
  }

  /// Whether later solves of a block of layers take only what is built into account (BuiltRegion). The solver
  /// must leave out elements without stiffness then.
  void leave_out_unbuilt(bool built);
  /// Simulates all layers; the result stays valid until the next call. Throws NumericalError naming
  /// the layer if one does not converge. `strains` must stay as it is while the result is used.
  const ProcessResult& simulate(const LayerDensities& densities, const StrainSource<Dim>& strains);
  /// Adds the derivatives of several functionals at the last simulated densities and strains, with respect to
  /// the densities of this group's layers and to the inputs of the strains, as far as they enter its layers.
  /// Functionals solved together share the systems.
  void pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> functionals,
                 std::span<const ProcessDerivatives> derivatives);
  /// Forces of the supports on the last simulation's part, sum_j (K_j du_j - f_j), [owned node][component], 0
  /// elsewhere, for unit Young's modulus. They balance themselves. `number`: of the strain case.
  std::vector<double> reactions(const LayerDensities& densities, std::size_t number = 0) const;
  /// Gives back the memory of the last simulation's increments and of the solver; pull_back(), reactions()
  /// and increment() need a further simulation. Not collective.
  void release_memory();
  /// That of the last simulation, for CountedAs.
  ProcessResult& result() { return result_; }
  /// Strains of the last simulation, as given.
  const StrainSource<Dim>& strains() const { return *strains_; }
  /// Later simulations and adjoints are solved to this tolerance.
  void set_tolerance(const SolveTolerance& tolerance);
  /// Forgets what earlier solves have left in the solvers for later ones (ElasticitySolver::start_cold()).
  void start_cold();
  /// Iterations of the adjoint solves of the last pull_back(), the largest of its functionals for each layer.
  const std::vector<int>& adjoint_iterations() const { return adjoint_iterations_; }
  /// Increment of any layer on the owned nodes, [node][component]; sent by the group that has it. `counted`:
  /// what the displacement has of it.
  std::vector<double> increment(int layer, bool counted = false) const;
  const LayerGroups& groups() const { return groups_; }
  /// The next simulation is dealt out by these iterations, sums over all solves of each layer: first those of
  /// the last simulation, then those of the last pull_back(). Before the first simulation, and after a change
  /// of the number of layers, all layers count alike.
  const std::vector<double>& expected_work() const { return expected_work_; }
  void set_expected_work(std::vector<double> work) { expected_work_ = std::move(work); }
  const ElasticModel<Dim>& model() const { return model_; }
  std::string solver_description() const { return solver_->description(); }

 private:
  /// A functional on its way back.
  struct Functional {
    std::size_t number = 0;
    const ProcessAdjoint* from = nullptr;
    const ProcessDerivatives* to = nullptr;
    std::vector<double> motion;  ///< of the supports in its adjoints, [owned node][component]; empty: none
  };
  /// Scratch vectors reused from block to block.
  struct Workspace {
    explicit Workspace(SolveCount& count_) : count(count_) {}

    std::vector<LaneVector> loads, solutions;
    LaneVector increments;                    ///< on all owned nodes
    const LaneVector* spread_from = nullptr;  ///< the result's increments that these are; nullptr: others
    std::vector<typename Deposition<Dim>::Missing> missing;
    SolveCount& count;
  };
  int owned_nodes() const;
  void solve_block(const LayerDensities& densities, std::size_t number, Workspace& workspace);
  void pull_back_block(const LayerDensities& densities, std::size_t number,
                       std::span<const Functional> functionals, Workspace& workspace);
  void solve_adjoints(const LayerDensities& densities, std::size_t number,
                      std::span<const Functional* const> functionals, Workspace& workspace);
  void add_derivatives(const LayerDensities& densities, std::size_t number, const Functional& functional,
                       const LaneVector* adjoint, Workspace& workspace) const;
  /// A field of a solve that the first group does for all: a single right-hand side cannot be shared out.
  std::vector<double> in_first_group(const std::function<std::vector<double>()>& solve);
  void set_operators(const LayerDensities& densities, const BlockRegion& region, bool changed);
  std::vector<double> work_of(const LayerDensities& densities) const;
  void expect(const std::vector<int>& work, bool adjoint);

  const ElasticModel<Dim>& model_;
  const LayerGroups& groups_;
  BlockSolver block_solver_;
  int lanes_;
  StrainCases<Dim> cases_;
  const StrainSource<Dim>* strains_ = nullptr;  ///< of the last simulation
  LayerElements<Dim> elements_;
  std::unique_ptr<const BuiltRegion<Dim>> built_;  ///< nullptr: all elements count
  std::vector<BlockRegion> regions_;               ///< of this group's blocks
  SupportForces<Dim> supports_;
  std::unique_ptr<const Deposition<Dim>> deposition_;  ///< nullptr: all of the increments counts
  AdjointLoads<Dim> adjoint_loads_;
  std::unique_ptr<ElasticitySolver<Dim>> solver_;
  std::unique_ptr<Release<Dim>> release_;  ///< if asked for
  LayerDeal deal_;
  std::vector<double> expected_work_;  ///< [forward, adjoint][layer]
  ProcessResult result_;
  std::vector<int> adjoint_iterations_;
};

}  // namespace fabseq
