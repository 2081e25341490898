// SPDX-License-Identifier: MIT
#include "fabseq/thermal/temperature_simulation.h"

#include "thermal/pause_search.h"
#include "thermal/temperature_adjoint.h"
#include "thermal/temperature_steps.h"

#include <utility>

namespace fabseq {

template <int Dim>
TemperatureSimulation<Dim>::TemperatureSimulation(const ThermalModel<Dim>& model,
                                                  std::unique_ptr<HeatSolver<Dim>> solver,
                                                  const SolveTolerance& tolerance, const LayerGroups& groups,
                                                  int lanes)
    : model_(model), groups_(groups), solver_(std::move(solver)), tolerance_(tolerance), lanes_(lanes) {
  result_.nodes = model.nodes;
}

template <int Dim>
const LayerTemperatures& TemperatureSimulation<Dim>::simulate(const LayerDensities& densities) {
  const auto layers = static_cast<std::size_t>(densities.count());
  result_.interpass.assign(layers, model_.properties.plate);
  result_.share.resize(layers);
  result_.share_slope.resize(layers);
  result_.iterations.assign(layers, 0);
  result_.after_steps.assign(layers,
                             std::vector<std::vector<double>>(model_.properties.steps(),
                                                              std::vector<double>(model_.nodes.size(), 0.0)));
  result_.start = picked(model_.start(), model_.nodes);
  result_.regions.clear();
  groups_.run([&] {
    for (int layer = 0; standing_ != nullptr && layer < densities.count(); layer += widest_block)
      result_.regions.push_back(standing_->with_neighbors(densities, layer));
    if (groups_.index() == 0) run(densities);
  });
  share_with_groups();
  for (std::size_t layer = 0; layer < layers; ++layer) {
    result_.share[layer] = model_.properties.strain_share(result_.interpass[layer]);
    result_.share_slope[layer] = model_.properties.strain_share_slope(result_.interpass[layer]);
  }
  if (solver_->saves_memory()) solver_->release_memory();
  return result_;
}

template <int Dim>
void TemperatureSimulation<Dim>::run(const LayerDensities& densities) {
  TemperatureSteps<Dim> steps(model_, *solver_, tolerance_);
  std::vector<double> theta = model_.start(), capacity_before = model_.first_capacity();
  for (int number = 0; number < densities.count(); ++number) {
    ThermalLayer layer = model_.layer(densities, number, result_.region(number));
    const std::vector<ThermalStep> schedule = model_.steps(layer.mass);
    for (std::size_t i = 0; i < schedule.size(); ++i) {
      if (i == 0 || schedule[i].seconds != schedule[i - 1].seconds) steps.set(layer, schedule[i].seconds);
      result_.iterations[number] += steps.advance(
          i == 0 ? capacity_before : layer.capacity,
          schedule[i].welding ? 1.0 / model_.properties.welding_steps : 0.0, theta, step_name(number, i));
      result_.after_steps[number][i] = picked(theta, model_.nodes);
    }
    if (number + 1 < densities.count())
      result_.interpass[number + 1] =
          model_.properties.ambient + model_.interpass(densities.layer[number], theta);
    capacity_before = std::move(layer.capacity);
  }
}

template <int Dim>
void TemperatureSimulation<Dim>::share_with_groups() {
  if (groups_.count() == 1) return;
  groups_.broadcast(0, result_.interpass);
  groups_.sum(result_.iterations);
  for (auto& of_layer : result_.after_steps)
    for (std::vector<double>& theta : of_layer) groups_.broadcast(0, theta);
}

template <int Dim>
void TemperatureSimulation<Dim>::pull_back(const LayerDensities& densities,
                                           std::span<const TemperatureAdjoint> functionals) {
  if (functionals.empty()) return;
  BackwardSteps<Dim>(model_, *solver_, tolerance_, result_, densities, functionals, lanes_).run();
  if (solver_->saves_memory()) solver_->release_memory();
}

template <int Dim>
NeededPauses TemperatureSimulation<Dim>::needed_pauses(const LayerDensities& densities, double limit) {
  // A copy that cannot be found is a negative number on its way to the other groups.
  std::vector<double> seconds(densities.count(), 0.0), welding(1, 0.0);
  groups_.run([&] {
    if (groups_.index() == 0)
      welding[0] = find_pauses(model_, *solver_, tolerance_, densities, limit, seconds);
  });
  groups_.broadcast(0, seconds);
  groups_.broadcast(0, welding);
  NeededPauses result{{}, welding[0]};
  for (const double pause : seconds)
    result.seconds.push_back(pause < 0.0 ? std::nullopt : std::optional(pause));
  return result;
}

template <int Dim>
void TemperatureSimulation<Dim>::release_memory() {
  result_.after_steps = {};
  solver_->release_memory();
}

FABSEQ_INSTANTIATE_CLASS(TemperatureSimulation);

}  // namespace fabseq
