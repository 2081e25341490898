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

/// Implicit steps in time and their adjoints: C psi(theta') + dt (K phi(theta') + H theta') = C* psi(theta) +
/// q (docs/formulation.md 14.1, 14.3), solved for the potentials phi. Collective on the grid's communicator.
template <int Dim>
class TemperatureSteps {
 public:
  /// Both must outlive the object. `tolerance`: the solver's; where a step is not linear, what is left of its
  /// imbalance, too.
  TemperatureSteps(const ThermalModel<Dim>& model, HeatSolver<Dim>& solver, const SolveTolerance& tolerance)
      : model_(model), solver_(solver), tolerance_(tolerance) {}

  /// Steps that follow are of this length in this layer, which must outlive them.
  void set(const ThermalLayer& layer, double seconds);
  /// Takes theta on by a step. `capacity_before`: C*. `share`: of the layer's heat. Throws NumericalError
  /// about `what` if the solve does not converge. Returns its iterations.
  int advance(std::span<const double> capacity_before, double share, std::vector<double>& theta,
              const std::string& what);
  /// Solves for lambda of a step that has ended at theta, 0 at held nodes, [owned node][lane] in blocks of
  /// lanes. Uses up the loads.
  void solve_adjoint(std::span<const double> theta, std::span<LaneVector> loads,
                     std::span<LaneVector> lambdas, const std::string& what);

 private:
  /// Sets the solver's operator to the step's matrix at these temperatures.
  void linearize(std::span<const double> theta);
  /// What elements store, by the least ratio of storage to conduction at their nodes.
  std::vector<double> reaction_of_elements(std::span<const double> ratio) const;
  /// What the step's heat, `load`, still has to do, J; 0 at held nodes.
  std::vector<double> imbalance(std::span<const double> load, std::span<const double> theta,
                                std::span<const double> potential) const;
  /// Root mean square of an imbalance as temperatures, up to a factor. `diagonal`: of an operator.
  double size_of(std::span<const double> imbalance, std::span<const double> diagonal) const;
  /// Whether a change is so small that rounding may have made it.
  bool is_rounding(std::span<const double> change, std::span<const double> potential) const;
  double product(std::span<const double> a, std::span<const double> b) const;
  /// Solves for the change of the potentials that an imbalance asks for. Returns the iterations.
  int solve(const LaneVector& rest, LaneVector& change, const std::string& what);
  /// Adds as much of a change to the potentials as brings the step further, and sets what follows from them.
  void move(std::span<const double> load, std::span<const double> change, std::vector<double>& rest,
            std::vector<double>& theta, std::vector<double>& potential) const;
  /// theta of the potentials.
  void set_theta(std::span<const double> potential, std::span<double> theta) const;

  const ThermalModel<Dim>& model_;
  HeatSolver<Dim>& solver_;
  SolveTolerance tolerance_;
  const ThermalLayer* layer_ = nullptr;
  double seconds_ = 0.0;
  bool is_set_ = false;              ///< whether the solver has this step's operator, for all temperatures
  std::vector<double> diffusivity_;  ///< of the elements, times the step
  std::vector<double> diagonal_;     ///< of the operator without K
};

}  // namespace fabseq
