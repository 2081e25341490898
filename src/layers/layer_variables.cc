// SPDX-License-Identifier: MIT
#include "fabseq/layers/layer_variables.h"

#include "fabseq/layers/curved_layers.h"

namespace fabseq {

namespace {

LayerVariables time_points(int layers) {
  LayerVariables result;
  result.name = "time_points";
  const std::vector<double> all = uniform_time_points(layers);
  result.start.assign(all.begin() + 1, all.end() - 1);
  result.lower.assign(result.start.size(), 0.0);
  result.upper.assign(result.start.size(), 1.0);
  // Time points shall not overtake each other.
  result.reach = 1.0 / layers;
  return result;
}

/// The optimizer's range of an angle, in layers by which it turns the far end of the part.
constexpr double layers_in_reach = 10.0;

LayerVariables angles(const MultiPlanarSettings& settings, int dimension, double longest_edge) {
  LayerVariables result;
  result.name = "angles";
  result.start = settings.angles;
  result.lower = settings.lowest_angles;
  result.upper = settings.highest_angles;
  result.columns = dimension - 1;
  result.reach = layers_in_reach * settings.thickness / longest_edge;
  result.fixed = settings.fixed_angles;
  return result;
}

}  // namespace

Json LayerVariables::record(std::span<const double> values) const {
  if (columns == 0) return std::vector<double>(values.begin(), values.end());
  Json rows = Json::array();
  for (std::size_t first = 0; first < values.size(); first += columns) {
    const auto row = values.subspan(first, columns);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

LayerVariables make_layer_variables(const LayerSettings& settings, int layers, int dimension,
                                    double longest_edge) {
  if (settings.multi_planar) return angles(*settings.multi_planar, dimension, longest_edge);
  if (settings.variable_time_points && layers > 1) return time_points(layers);
  LayerVariables none;
  none.name = "time_points";
  return none;
}

}  // namespace fabseq
