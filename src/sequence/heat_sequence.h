// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/part/part.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/solve/heat_solver.h"
#include "fabseq/solve/solver_settings.h"
#include "sequence/averaging_filter.h"
#include "sequence/shared_solve.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// Scale on which the optimizer moves the diffusivity.
enum class VariableScale { log, linear };
/// Mass matrix of the drain; automatic: lumped where the temperature would otherwise leave its range.
enum class MassRule { automatic, consistent, lumped };

/// Settings of a heat sequence (docs/formulation.md 2.1, 2.2).
struct HeatSettings {
  VariableScale scale = VariableScale::log;
  MassRule mass = MassRule::automatic;
  std::optional<double> initial;                ///< uniform diffusivity; none: from the distance to the plate
  double drain = 1.0;                           ///< alpha times the square of the characteristic length
  std::optional<double> characteristic_length;  ///< length unit; none: fix_lengths() of the kind says it
  /// Bounds of the diffusivity in the part, and the diffusivity outside.
  double min_diffusivity = 1e-3, max_diffusivity = 1.0, void_diffusivity = 1e-3;
  double filter_radius = 0.0;  ///< length unit; 0: no filter
};

/// The model that all heat solves of a part share (docs/formulation.md 2.1). The whole box conducts, the void
/// included. The temperature is prescribed at the nodes of the part on the plate and at all nodes of the
/// substrate.
template <int Dim>
struct HeatModel {
  /// Where the settings leave l_c open, it is the part's longest edge. Keeps no reference to the part. Not
  /// collective.
  HeatModel(const Part<Dim>& part, const HeatSettings& settings);

  ElementMatrices<Dim> element;
  double reaction;      ///< alpha, diffusivity / length^2
  bool lumped;          ///< whether the mass matrix is diagonal
  SystemDomain domain;  ///< all elements; fixed where the temperature is prescribed
};

/// Heat-regularized pseudo-time: one minus a virtual temperature (docs/formulation.md 2.1). Solves div(kappa
/// grad T) = alpha T in the whole box, the void included, with T = 1 at the prescribed nodes of HeatModel and
/// insulation elsewhere:
///
///     K_T T = 0 on the free nodes,  K_T = sum_e kappa_e int grad N_i . grad N_j + alpha int N_i N_j,
///     alpha = drain / l_c^2,  t_e = 1 - mean of T over the element's nodes,  grad t = -grad T at its centre.
///
/// The design is the diffusivity kappa of the part elements, before the filter. Each update sets the solver's
/// operator once, for the forward solve and all adjoints.
template <int Dim>
class HeatSequence : public Sequence<Dim> {
 public:
  /// Collective on the grid's communicator. The part and `across` must outlive the sequence.
  ///
  /// \param target_gradient |grad T| that the initial design aims at, 1/length: 1 / (layers * thickness)
  /// for a target thickness of the layers; 0: 0.95 / (largest distance from the plate)
  /// \param model that of this part and these settings
  /// \param solver a solver on the domain of `model`, to which it may refer
  /// \param across this rank and its copies in other layer groups. The group of the first one solves for
  /// the temperature and sends it to the others, so that all have the same bits. update() is collective on
  /// `across`, too; in pull_back() each group acts on its own.
  /// \param lanes most rows that are solved side by side
  HeatSequence(const Part<Dim>& part, const HeatSettings& settings, double target_gradient,
               std::unique_ptr<const HeatModel<Dim>> model, std::unique_ptr<HeatSolver<Dim>> solver,
               MPI_Comm across = MPI_COMM_SELF, int lanes = widest_block);

  bool has_design() const override { return true; }
  std::size_t variables() const override { return part_.elements().size(); }
  DesignSpace space() const override {
    return {{{settings_.min_diffusivity, settings_.max_diffusivity, settings_.scale == VariableScale::log}}};
  }
  std::vector<double> initial_design() const override;
  const PseudoTime<Dim>& update(std::span<const double> design) override;
  std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows) override;
  void set_tolerance(const SolveTolerance& tolerance) override { forward_.set_tolerance(tolerance); }
  void start_cold() override { forward_.start_cold(); }
  void release_memory() override { solver_->release_memory(); }
  std::vector<int> adjoint_iterations() const override { return adjoint_iterations_; }

 private:
  void solve_temperature();
  LaneVector prescribed_load() const;
  void derive_time();

  const Part<Dim>& part_;
  HeatSettings settings_;
  double target_gradient_;
  std::unique_ptr<const HeatModel<Dim>> model_;
  std::unique_ptr<HeatSolver<Dim>> solver_;
  SharedSolve<Dim> forward_;
  int lanes_;
  AveragingFilter<Dim> filter_;
  std::vector<double> diffusivity_;          ///< of all owned elements of the grid, filtered
  std::vector<double> ghosted_temperature_;  ///< on the ghosted node box
  PseudoTime<Dim> time_;
  std::vector<int> adjoint_iterations_;
};

}  // namespace fabseq
