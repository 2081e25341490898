// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/thermal/temperature_simulation.h"
#include "thermal/temperature_steps.h"

#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// The adjoints of a simulation's steps, last to first, for several functionals side by side
/// (docs/developer/derivatives.md 14). Collective on the grid's communicator.
template <int Dim>
class BackwardSteps {
 public:
  /// All arguments must outlive the object. `lanes`: functionals in a block at most.
  BackwardSteps(const ThermalModel<Dim>& model, HeatSolver<Dim>& solver, const SolveTolerance& tolerance,
                const LayerTemperatures& temperatures, const LayerDensities& densities,
                std::span<const TemperatureAdjoint> functionals, int lanes);

  void run();

 private:
  /// Functionals that are solved together. Nodal values are [owned node][lane].
  struct Block {
    std::span<const TemperatureAdjoint> functionals;
    bool active = false;                            ///< whether a later step depends on the temperature
    LaneVector theta, lambda;                       ///< dJ/dtheta, and the step's adjoint
    std::vector<double> capacity, capacity_before;  ///< dJ/dC of this layer and of the one before
    std::vector<double> film;                       ///< dJ/dH of this layer
    std::vector<double> heat;                       ///< dJ/dq, summed over the steps that bring q
    std::vector<double> share;    ///< dJ/da through conduction, [part element][lane], this rank's
    std::vector<double> seconds;  ///< dJ/d(length of a step), summed, [lane], this rank's part

    int lanes() const { return static_cast<int>(functionals.size()); }
  };

  /// The last layer whose end any functional depends on; negative: none.
  int last_layer() const;
  /// Adds dJ/dtheta and dJ/d(weights) at the end of a layer, as far as they come from the next one's B.
  void add_interpass(Block& block, int number);
  /// Adds dJ/dtheta at the end of a layer's deposition, 0, or pause, 1.
  void add_end(int number, int end);
  void back_through(int number, const ThermalLayer& layer, std::span<const double> capacity_before);
  /// Solves for the adjoint of a step that ends at these temperatures.
  void solve(std::span<const double> theta, const std::string& what);
  /// What a step's adjoint amounts to by what the step is made of.
  void add_step(Block& block, const ThermalLayer& layer, const ThermalStep& step,
                std::span<const double> theta_before, std::span<const double> theta_after, bool is_first);
  void add_conduction(Block& block, const ThermalLayer& layer, const ThermalStep& step,
                      std::span<const double> potential);
  /// What has been added up over the steps of a layer, by its densities.
  void add_densities(Block& block, int number, const ThermalLayer& layer);
  void add_to_functional(const Block& block, int lane, int number, std::span<const double> of_stage,
                         std::span<const double> of_heat, double of_mass) const;
  std::vector<double> ghosted(std::span<const double> owned, int lanes) const;

  const ThermalModel<Dim>& model_;
  TemperatureSteps<Dim> steps_;
  const LayerTemperatures& temperatures_;
  const LayerDensities& densities_;
  std::vector<Block> blocks_;
};

}  // namespace fabseq
