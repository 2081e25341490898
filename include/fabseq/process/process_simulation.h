// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/lanes/lane_vector.h"
#include "fabseq/layers/layers.h"
#include "fabseq/parallel/layer_dealing.h"
#include "fabseq/parallel/layer_groups.h"
#include "fabseq/process/deposition.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/layer_elements.h"
#include "fabseq/process/release.h"
#include "fabseq/process/support_forces.h"
#include "fabseq/solve/elasticity_solver.h"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// Displacements of a simulated process on this rank's nodes.
struct ProcessResult {
  MPI_Comm all_layers = MPI_COMM_NULL;  ///< the ranks that together have the increments of all layers
  std::vector<LayerBlock> blocks;       ///< the layers of this rank's group
  std::vector<LaneVector> increments;   ///< their increments, block by block: [node][component][lane]
  std::vector<LaneVector> weights;      ///< share of each that counts (Deposition), [node][lane]; empty: all
  std::vector<double> displacement;     ///< u, all layers' sum, [owned node][component], length unit
  std::vector<double> release;          ///< v, what the release adds to u; empty if that is not asked for
  std::vector<int> iterations;          ///< of each layer's solve, all layers

  /// What counts of the increment of an unknown (node * components + component) in a layer of a block.
  double counted(std::size_t block, std::size_t unknown, int lane) const {
    const LaneVector& increment = increments[block];
    if (weights.empty()) return increment(unknown, lane);
    return weights[block](unknown / increment.components, lane) * increment(unknown, lane);
  }
};

/// The derivative of a functional by the displacements: what an adjoint solve starts from.
struct ProcessAdjoint {
  std::vector<double> displacement;    ///< dJ/du, [owned node][component]; empty: zero
  std::vector<LaneVector> increments;  ///< dJ/d(counted increment) on top, like ProcessResult; empty: zero
  std::vector<double> release;         ///< dJ/dv, [owned node][component]; empty: zero
};

/// Where the derivatives of a functional by densities and strains go.
struct ProcessDerivatives {
  DensityDerivatives* densities = nullptr;
  StrainField* strains = nullptr;  ///< like the simulation's, sized at first use; nullptr: not asked for
  std::function<void()> after_block = {};  ///< called after each block of layers, may take the entries out
};

/// The layer-by-layer inherent-strain simulation and its adjoint (docs/formulation.md 4.1, 8). For each layer
/// j: K_j du_j = f_j with the plate fixed, u = sum of du_j,
///
///     K_j = sum_e E(rho_j,e) K_0,   f_j = sum_e (drho_j,e)^q int B^T C eps*.
///
/// Under nominal deposition (4.6), u is the sum of w_j du_j. Adjoint: K_j lambda_j = -w_j (dJ/du + dJ/d(w_j
/// du_j)), then dJ/drho_j,e = E' lambda^T K_0 du and dJ/d(drho_j,e) = -q
/// drho^(q-1) lambda^T f_0. For what is measured after the release (Release), lambda_j on the supports is not
/// 0 but the release's adjoint w.
///
/// Layer groups share the layers; a deal holds from simulate() to the next. All calls are collective on the
/// world of the groups, and errors are thrown on all of its ranks.
template <int Dim>
class ProcessSimulation {
 public:
  /// Layers solved side by side at most, unless memory is to be saved.
  static constexpr int most_lanes = 8;

  /// `lanes`: layers solved side by side at most. `blocks`: how the solver goes through a block of layers.
  /// Model and groups must outlive the simulation.
  ProcessSimulation(const ElasticModel<Dim>& model, std::unique_ptr<ElasticitySolver<Dim>> solver,
                    const LayerGroups& groups, BlockSolver blocks, int lanes = most_lanes);

  /// From now on simulations end with the release from the supports. Throws InputError if there is none
  /// (release_obstacle()).
  void release_with(const ReleaseSolver& solver) {
    release_ = std::make_unique<Release<Dim>>(model_, solver);
  }

  /// Simulates all layers; the result stays valid until the next call. Throws NumericalError naming
  /// the layer if one does not converge.
  const ProcessResult& simulate(const LayerDensities& densities, StrainField strains = {});
  /// Adds the derivatives of several functionals at the last simulated densities and strains, with respect to
  /// the densities of this group's layers and to the strains, as far as they enter its layers. Functionals
  /// solved together share the systems.
  void pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> functionals,
                 std::span<const ProcessDerivatives> derivatives);
  /// Forces of the supports on the last simulation's part, sum_j (K_j du_j - f_j), [owned node][component], 0
  /// elsewhere, for unit Young's modulus. They balance themselves.
  std::vector<double> reactions(const LayerDensities& densities) const;
  /// That of the last simulation, for CountedAs.
  ProcessResult& result() { return result_; }
  /// Strains of the last simulation.
  const StrainField& strains() const { return elements_.strains(); }
  /// Forgets what earlier solves have left in the solvers for later ones (ElasticitySolver::start_cold()).
  void start_cold();
  /// Iterations of the adjoint solves of the last pull_back(), the largest of its functionals for each layer.
  const std::vector<int>& adjoint_iterations() const { return adjoint_iterations_; }
  /// Increment of any layer on the owned nodes, [node][component]; sent by the group that has it. `counted`:
  /// what the displacement has of it.
  std::vector<double> increment(int layer, bool counted = false) const;
  const LayerGroups& groups() const { return groups_; }
  /// Iterations per layer that the next simulation is dealt out by: the last one's, forward and adjoint.
  /// Equal work where there are none, or not for as many layers.
  const std::vector<double>& expected_work() const { return expected_work_; }
  void set_expected_work(std::vector<double> work) { expected_work_ = std::move(work); }
  const ElasticModel<Dim>& model() const { return model_; }
  std::string solver_description() const { return solver_->description(); }

 private:
  /// Functionals to pull back, and how the supports move in the adjoints of each (empty: not at all).
  struct Functionals {
    std::span<const ProcessAdjoint> from;
    std::span<const ProcessDerivatives> to;
    std::span<const std::vector<double>> motions;

    Functionals part(std::size_t first, std::size_t count) const {
      return {from.subspan(first, count), to.subspan(first, count), motions.subspan(first, count)};
    }
  };
  void deal_out(int layers);
  void solve_block(const LayerDensities& densities, std::size_t number, LaneVector& load);
  void pull_back_block(const LayerDensities& densities, std::size_t number, const Functionals& functionals,
                       std::vector<LaneVector>& loads, std::vector<LaneVector>& adjoints);
  void pull_back_together(const LayerDensities& densities, std::size_t number, const Functionals& functionals,
                          std::span<LaneVector> loads, std::span<LaneVector> adjoints);
  void add_deposition_derivatives(const LayerDensities& densities, std::size_t number,
                                  const ProcessAdjoint& functional, DensityDerivatives& derivatives) const;
  std::vector<double> release_motion(std::span<const double> derivative);
  void set_operators(const LayerDensities& densities, const LayerBlock& block, bool changed);

  const ElasticModel<Dim>& model_;
  const LayerGroups& groups_;
  BlockSolver block_solver_;
  int lanes_;
  LayerElements<Dim> elements_;
  SupportForces<Dim> supports_;
  std::unique_ptr<const Deposition<Dim>> deposition_;  ///< nullptr: all of the increments counts
  std::unique_ptr<ElasticitySolver<Dim>> solver_;
  std::unique_ptr<Release<Dim>> release_;  ///< if asked for
  LayerDeal deal_;
  std::vector<double> expected_work_;
  ProcessResult result_;
  std::vector<int> adjoint_iterations_;
};

}  // namespace fabseq
