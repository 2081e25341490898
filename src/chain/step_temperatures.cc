// SPDX-License-Identifier: MIT
#include "chain/step_temperatures.h"

#include "fabseq/grid/corner_means.h"
#include "fabseq/thermal/thermal_model.h"

#include <cstddef>
#include <utility>

namespace fabseq {

std::vector<BuildStep> steps_of_heated_layers(int layers, const ThermalProperties& properties) {
  std::vector<BuildStep> result;
  for (int layer = 0; layer < layers; ++layer) {
    result.push_back({layer, true});
    if (properties.pause > 0.0) result.push_back({layer, false});
  }
  result.push_back({layers - 1, false});
  return result;
}

template <int Dim>
StepTemperatures step_temperatures(const ElasticModel<Dim>& model, const ThermalProperties& properties,
                                   const LayerTemperatures& temperatures,
                                   const std::vector<BuildStep>& steps) {
  StepTemperatures result;
  result.plate = properties.plate;
  const auto nodes = static_cast<std::size_t>(model.part.grid().owned_nodes().count());
  for (std::size_t number = 0; number + 1 < steps.size(); ++number) {
    const auto& of_layer = temperatures.after_steps[steps[number].layer];
    const std::vector<double>& excess = steps[number].adds
                                            ? of_layer[static_cast<std::size_t>(properties.welding_steps) - 1]
                                            : of_layer.back();
    std::vector<double> mean = corner_means(model.part.grid(), model.domain.first_corners,
                                            spread_out(excess, temperatures.nodes, nodes));
    for (double& temperature : mean) temperature += properties.ambient;
    result.elements.push_back(std::move(mean));
  }
  result.elements.emplace_back(model.elements.size(), properties.ambient);
  return result;
}

template <int Dim>
void add_end_derivatives(const ElasticModel<Dim>& model, const std::vector<BuildStep>& steps,
                         const std::vector<std::vector<double>>& derivative, TemperatureDerivatives& to) {
  const auto nodes = static_cast<std::size_t>(model.part.grid().owned_nodes().count());
  to.ends.resize(2 * static_cast<std::size_t>(steps.back().layer + 1) * nodes, 0.0);
  for (std::size_t number = 0; number + 1 < steps.size(); ++number) {
    const std::vector<double> of_nodes =
        spread_to_corners(model.part.grid(), model.domain.first_corners, derivative[number], 1.0);
    const std::size_t end = 2 * static_cast<std::size_t>(steps[number].layer) + (steps[number].adds ? 0 : 1);
    for (std::size_t node = 0; node < nodes; ++node) to.ends[end * nodes + node] += of_nodes[node];
  }
}

FABSEQ_INSTANTIATE_FUNCTION(step_temperatures);
FABSEQ_INSTANTIATE_FUNCTION(add_end_derivatives);

}  // namespace fabseq
