// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/solve/heat_solver.h"
#include "fabseq/thermal/thermal_model.h"

#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// Names a step for messages: "temperature: layer 3, step 2". Both are numbers from 0.
std::string step_name(int layer, std::size_t step);

/// Implicit steps in time and their adjoints: (C + dt (K + H)) theta' = C* theta + q (docs/formulation.md
/// 14.1). Collective on the grid's communicator.
template <int Dim>
class TemperatureSteps {
 public:
  /// Both must outlive the object.
  TemperatureSteps(const ThermalModel<Dim>& model, HeatSolver<Dim>& solver)
      : model_(model), solver_(solver) {}

  /// Steps that follow are of this length in this layer, which must outlive them.
  void set(const ThermalLayer& layer, double seconds);
  /// Takes theta on by a step. `capacity_before`: C*. `share`: of the layer's heat. Throws NumericalError
  /// about `what` if the solve does not converge. Returns its iterations.
  int advance(std::span<const double> capacity_before, double share, std::vector<double>& theta,
              const std::string& what);
  /// lambda = (C + dt (K + H))^-1 loads, 0 at held nodes, [owned node][lane] in blocks of lanes.
  void solve_adjoint(std::span<const LaneVector> loads, std::span<LaneVector> lambdas,
                     const std::string& what);

 private:
  const ThermalModel<Dim>& model_;
  HeatSolver<Dim>& solver_;
  const ThermalLayer* layer_ = nullptr;
  double seconds_ = 0.0;
};

}  // namespace fabseq
