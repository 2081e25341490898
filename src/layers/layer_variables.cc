// SPDX-License-Identifier: MIT
#include "fabseq/layers/layer_variables.h"

#include "fabseq/layers/curved_layers.h"

namespace fabseq {

namespace {

/// The optimizer's range of an angle, in layers by which it turns the far end of the part.
constexpr double layers_in_reach = 10.0;

}  // namespace

Json LayerVariables::record(std::span<const double> values) const {
  if (columns == 0) return std::vector<double>(values.begin(), values.end());
  Json table = Json::array();
  for (std::size_t first = 0; first < values.size(); first += columns) {
    const auto of_sub_part = values.subspan(first, columns);
    table.push_back(std::vector<double>(of_sub_part.begin(), of_sub_part.end()));
  }
  return table;
}

LayerVariables time_point_variables(int layers) {
  LayerVariables result;
  result.name = "time_points";
  result.label = "time points";
  const std::vector<double> all = uniform_time_points(layers);
  result.start.assign(all.begin() + 1, all.end() - 1);
  result.lower.assign(result.start.size(), 0.0);
  result.upper.assign(result.start.size(), 1.0);
  // Time points shall not overtake each other.
  if (layers > 1) result.reach = 1.0 / layers;
  return result;
}

LayerVariables angle_variables(const MultiPlanarSettings& settings, int dimension, double longest_edge) {
  LayerVariables result;
  result.name = "angles";
  result.label = "angles";
  result.start = settings.angles;
  result.lower = settings.lowest_angles;
  result.upper = settings.highest_angles;
  result.columns = dimension - 1;
  result.reach = layers_in_reach * settings.thickness / longest_edge;
  result.fixed = settings.fixed_angles;
  return result;
}

}  // namespace fabseq
