// SPDX-License-Identifier: MIT
#include "thermal/temperature_steps.h"

#include "fabseq/base/formatted.h"

namespace fabseq {

std::string step_name(int layer, std::size_t step) {
  return formatted("temperature: layer %d, step %zu", layer + 1, step + 1);
}

template <int Dim>
void TemperatureSteps<Dim>::set(const ThermalLayer& layer, double seconds) {
  layer_ = &layer;
  seconds_ = seconds;
  const ThermalProperties& properties = model_.properties;
  std::vector<double> diffusivity = layer.share, reaction = layer.share, diagonal = layer.film;
  for (double& value : diffusivity) value *= seconds * properties.conductivity;
  for (double& value : reaction) value *= properties.capacity;
  for (double& value : diagonal) value *= seconds;
  // Without a film there is nothing to add.
  if (properties.film == 0.0) diagonal.clear();
  solver_.set_operator(HeatOperator{diffusivity, reaction, diagonal});
}

/// Held nodes are lifted: the unknowns of the system are the others.
template <int Dim>
int TemperatureSteps<Dim>::advance(std::span<const double> capacity_before, double share,
                                   std::vector<double>& theta, const std::string& what) {
  LaneVector load(model_.owned_nodes(), 1, 1), solution(model_.owned_nodes(), 1, 1);
  for (const int node : model_.nodes)
    load.values[node] =
        capacity_before[node] * theta[node] + share * layer_->heat[node] - seconds_ * layer_->to_plate[node];
  const SolveReport report = solver_.solve({&load, 1}, {&solution, 1}).front();
  require_convergence(report, what);
  theta = std::move(solution.values);
  model_.hold(theta);
  return report.iterations;
}

template <int Dim>
void TemperatureSteps<Dim>::solve_adjoint(std::span<const LaneVector> loads, std::span<LaneVector> lambdas,
                                          const std::string& what) {
  for (const SolveReport& report : solver_.solve(loads, lambdas)) require_convergence(report, what);
}

FABSEQ_INSTANTIATE_CLASS(TemperatureSteps);

}  // namespace fabseq
