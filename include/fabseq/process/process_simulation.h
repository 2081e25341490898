/// \file
/// The layer-by-layer inherent-strain simulation and its adjoint (docs/formulation.md 4.1, 8).
#pragma once

#include "fabseq/layers/curved_layers.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/layer_elements.h"
#include "fabseq/solve/elasticity_solver.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// Displacements of a simulated process on this rank's nodes.
struct ProcessResult {
  std::vector<LaneVector> increments;  ///< increment of each layer, batch by batch: [node][component][lane]
  std::vector<double> displacement;    ///< their sum u, [owned node][component], length unit
  std::vector<int> iterations;         ///< of each layer's solve
};

/// One row of adjoints: derivative of a functional with respect to the displacements in, with respect to the
/// densities out.
struct ProcessAdjoint {
  std::vector<double> displacement;    ///< dJ/du, [owned node][component]; empty: zero
  std::vector<LaneVector> increments;  ///< dJ/d(increment of a layer) on top, like ProcessResult; empty: zero
};

/// For each layer j: K_j du_j = f_j with the plate fixed, u = sum of du_j,
///
///     K_j = sum_e E(rho_j,e) K_0,   f_j = sum_e (drho_j,e)^q int B^T C eps*.
///
/// Adjoint: K_j lambda_j = -dJ/du - dJ/d(du_j), then dJ/drho_j,e = E' lambda^T K_0 du and dJ/d(drho_j,e) = -q
/// drho^(q-1) lambda^T f_0. Collective on the grid's communicator.
template <int Dim>
class ProcessSimulation {
 public:
  /// Layers solved side by side.
  static constexpr int batch_lanes = 8;

  /// The model must outlive the simulation.
  ProcessSimulation(const ElasticModel<Dim>& model, std::unique_ptr<ElasticitySolver<Dim>> solver);

  /// Simulates all layers; the result stays valid until the next call. Throws NumericalError naming the layer
  /// if one does not converge.
  const ProcessResult& simulate(const LayerDensities& densities);
  /// Adds the derivatives of several functionals at the last simulated densities; rows solved together share
  /// the systems.
  void pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> rows,
                 std::span<DensityDerivatives* const> derivatives);
  /// Forgets what earlier solves have left for later ones (ElasticitySolver::start_cold()).
  void start_cold() { solver_->start_cold(); }
  /// Iterations of the adjoint solves of the last pull_back, the largest of its rows for each layer.
  const std::vector<int>& adjoint_iterations() const { return adjoint_iterations_; }
  /// Increment of a layer on the owned nodes, [node][component].
  std::vector<double> increment(int layer) const;
  const ElasticModel<Dim>& model() const { return model_; }
  std::string solver_description() const { return solver_->description(); }

 private:
  void set_operators(const LayerDensities& densities, int first, int lanes, bool changed);

  const ElasticModel<Dim>& model_;
  LayerElements<Dim> elements_;
  std::unique_ptr<ElasticitySolver<Dim>> solver_;
  ProcessResult result_;
  std::vector<int> adjoint_iterations_;
};

extern template class ProcessSimulation<2>;
extern template class ProcessSimulation<3>;

}  // namespace fabseq
