// SPDX-License-Identifier: MIT
#include "chain/step_temperatures.h"

#include "fabseq/thermal/thermal_model.h"

#include <cstddef>

namespace fabseq {

namespace {

/// Means of a nodal field, [owned node], over the nodes of the model's elements, and a number on top.
template <int Dim>
std::vector<double> element_means(const ElasticModel<Dim>& model, const std::vector<double>& field,
                                  double on_top) {
  const Grid<Dim>& grid = model.part.grid();
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()));
  grid.exchange(1).to_ghosted(field, ghosted);
  std::vector<double> result(model.elements.size(), 0.0);
  for (std::size_t e = 0; e < result.size(); ++e) {
    for (const int offset : grid.corner_offsets())
      result[e] += ghosted[model.domain.first_corners[e] + offset];
    result[e] = on_top + result[e] / corner_count<Dim>;
  }
  return result;
}

}  // namespace

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
    result.elements.push_back(
        element_means(model, spread_out(excess, temperatures.nodes, nodes), properties.ambient));
  }
  result.elements.emplace_back(model.elements.size(), properties.ambient);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(step_temperatures);

}  // namespace fabseq
