// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/density_sink.h"
#include "fabseq/parallel/layer_groups.h"
#include "fabseq/process/standing_elements.h"
#include "fabseq/solve/heat_solver.h"
#include "fabseq/thermal/layer_temperatures.h"
#include "fabseq/thermal/thermal_model.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// A functional of the temperatures on its way back.
struct TemperatureAdjoint {
  std::span<const double> interpass;  ///< dJ/dB_j, [layer], the same on all ranks of the grid
  /// dJ/dtheta at the end of deposition and of the pause, [layer][these two][owned node]; empty: zero.
  std::span<const double> ends;
  DensityDerivatives* densities;  ///< to which its derivatives are added
  DensitySink* sink;              ///< takes them after each layer; nullptr: they stay there
};

/// The pauses that an interpass temperature asks for.
struct NeededPauses {
  /// Pauses after each real layer of every simulated layer, s; none: no pause is enough. Of the last layer 0.
  std::vector<std::optional<double>> seconds;
  double welding = 0.0;  ///< of all layers, s
};

/// Heat conduction through the layers as they are built, and its adjoint (docs/formulation.md 14). The first
/// group simulates for all: steps follow each other, and all ranks of its grid work on each.
template <int Dim>
class TemperatureSimulation {
 public:
  /// `lanes`: adjoints solved side by side at most. `solver`: on the model's domain, with lumped masses, to
  /// `tolerance`. Model and groups must outlive the simulation.
  TemperatureSimulation(const ThermalModel<Dim>& model, std::unique_ptr<HeatSolver<Dim>> solver,
                        const SolveTolerance& tolerance, const LayerGroups& groups, int lanes = widest_block);

  /// Temperatures of all layers; the result stays valid until the next call. Collective on the world of the
  /// groups. Throws NumericalError naming the layer if a solve does not converge.
  const LayerTemperatures& simulate(const LayerDensities& densities);
  /// Whether later simulations take only these elements and their neighbours into account
  /// (docs/formulation.md 4.8), which must outlive the simulation; nullptr: all. The solver must leave out
  /// elements without diffusivity then. Pauses are found with all.
  void take_only(const StandingElements<Dim>* standing) { standing_ = standing; }
  /// Adds the derivatives of several functionals with respect to the densities of the last simulation's
  /// layers. Collective on the grid's communicator.
  void pull_back(const LayerDensities& densities, std::span<const TemperatureAdjoint> functionals);
  /// The pauses with which every layer begins at `limit`, degrees Celsius, or below, each found with those
  /// before it. Collective on the world of the groups.
  NeededPauses needed_pauses(const LayerDensities& densities, double limit);

  const ThermalModel<Dim>& model() const { return model_; }
  /// Later simulations and adjoints are solved to this tolerance. Collective on the grid's communicator.
  void set_tolerance(const SolveTolerance& tolerance) {
    solver_->set_tolerance(tolerance);
    tolerance_ = tolerance;
  }
  /// Forgets what earlier solves have left for later ones. Collective on the grid's communicator.
  void start_cold() { solver_->start_cold(); }
  /// Gives back the memory of the last simulation's steps and of the solver; pull_back() needs a further
  /// simulation. Not collective.
  void release_memory();

 private:
  void run(const LayerDensities& densities);
  void share_with_groups();

  const ThermalModel<Dim>& model_;
  const LayerGroups& groups_;
  std::unique_ptr<HeatSolver<Dim>> solver_;
  SolveTolerance tolerance_;
  int lanes_;
  const StandingElements<Dim>* standing_ = nullptr;
  LayerTemperatures result_;
};

}  // namespace fabseq
