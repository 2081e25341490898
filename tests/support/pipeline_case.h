// SPDX-License-Identifier: MIT
/// \file
/// A small config of everything, its pipeline, and the stages' results on the whole grid.
#pragma once

#include "fabseq/chain/pipeline.h"
#include "fabseq/config/setup.h"
#include "fabseq/optimize/problem.h"
#include "support/process_case.h"
#include "support/small_configs.h"

#include <string>
#include <utility>
#include <vector>

namespace fabseq::test {

/// Every response there is, on the gallows of small_parts.h.
inline constexpr const char* gallows_plane = R"({
  "domain": {"size": [3.5, 1.5], "elements": [7, 5], "thickness": 0.25},
  "part": {"union": [{"box": {"min": [0, 0], "max": [1, 1.5]}}, {"box": {"min": [0, 0.9], "max": [3, 1.5]}}]},
  "node_sets": {"tip": {"box": {"min": [3, 0], "max": [3, 1.5]}}, "top": {"box": {"min": [0, 1.5], "max": [3, 1.5]}}},
  "material": {"inherent_strain": [-0.01, 0.004, 0.007]},
  "sequence": {"type": "heat", "drain": 0.7, "characteristic_length": 1.3, "bounds": [0.02, 1], "void": 0.01},
  "layers": {"count": 4},
  "projection": {"beta": 9},
  "objective": [
    {"type": "distortion", "nodes": "tip", "scaling": "first", "least_squares": false},
    {"type": "distortion", "nodes": "tip", "mean": true, "weight": 0.5, "scaling": "current", "normalize": 10,
     "least_squares": false},
    {"type": "distortion", "measure": "flatness", "nodes": "top", "axis": "x", "scaling": "first",
     "least_squares": false},
    {"type": "distortion", "measure": "layerwise", "weight": 2, "scaling": "first"},
    {"type": "layer_uniformity", "form": "sum_of_squares", "weight": 0.3, "scaling": "first"},
    {"type": "layer_uniformity", "form": "variance", "scaling": "current", "weight": 0.7, "normalize": 20}],
  "constraints": [{"type": "layer_thickness", "target": 0.5, "tolerance": 0.2}, {"type": "deposition_speed", "slack": 0.01}],
  "solver": {"reference_method": "direct", "layer_groups": 1}
})";
inline const Settings to_solid = {
    {"domain", R"({"size": [2, 0.9, 2.5], "elements": [5, 3, 5]})"},
    {"part", R"({"union": [{"box": {"min": [0, 0, 0], "max": [0.8, 0.9, 2.5]}},
                           {"box": {"min": [0, 0, 1.5], "max": [2, 0.6, 2.5]}}]})"},
    {"node_sets.tip.box", R"({"min": [2, 0, 0], "max": [2, 0.9, 2.5]})"},
    {"node_sets.top.box", R"({"min": [0, 0, 2.5], "max": [2, 0.9, 2.5]})"},
    {"material.inherent_strain", "[-0.01, 0.004, 0.003, 0.007, -0.002, 0.005]"}};

/// Distortion after the release, with and without terms before it, and strain that turns with the layers.
inline const Settings released_and_turning = {
    {"material.inherent_strain", R"({"tangential": -0.01, "normal": 0.003})"},
    {"objective", R"([{"type": "distortion", "nodes": "tip", "after_release": true, "mean": true},
                      {"type": "distortion", "nodes": "top", "measure": "flatness", "axis": "x", "after_release": true},
                      {"type": "distortion", "nodes": "tip"},
                      {"type": "distortion", "measure": "layerwise"},
                      {"type": "layer_uniformity"}])"}};
/// A substrate under the gallows, clamped at one end.
template <int Dim>
Settings on_clamped_substrate() {
  const std::string high = Dim == 2 ? "[3.5, 0.4]" : "[2, 0.9, 0.8]",
                    end = Dim == 2 ? "[0, 0.4]" : "[0, 0.9, 0.8]";
  const std::string low = Dim == 2 ? "[0, 0]" : "[0, 0, 0]";
  return {{"substrate", "{\"box\": {\"min\": " + low + ", \"max\": " + high + "}}"},
          {"clamps", "{\"box\": {\"min\": " + low + ", \"max\": " + end + "}}"}};
}

inline Settings operator+(Settings all, const Settings& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

template <int Dim>
Config gallows_config(const Settings& settings) {
  Settings all = Dim == 3 ? to_solid : Settings{};
  all.insert(all.end(), settings.begin(), settings.end());
  return configure(gallows_plane, all);
}

inline Design moved(const Design& design, double step, const Design& direction) {
  return {moved(design.field, step, direction.field),
          moved(design.layer_variables, step, direction.layer_variables)};
}
/// Gradient times direction; the field is distributed, those of the layers are the same on all ranks.
/// Collective.
inline double dot(const Design& gradient, const Design& direction) {
  double product = dot(gradient.field, direction.field);
  for (std::size_t j = 0; j < direction.layer_variables.size(); ++j)
    product += gradient.layer_variables[j] * direction.layer_variables[j];
  return product;
}

template <int Dim>
struct PipelineCase {
  explicit PipelineCase(const Settings& settings = {})
      : config(gallows_config<Dim>(settings)),
        setup(PETSC_COMM_WORLD, config),
        pipeline(setup, 1e-13, timer),
        problem(setup, config.optimizer.constraint_margin) {}

  StageResults<Dim> run(const Design& design) {
    return pipeline.run(design, setup.layers->traits().first_beta, false);
  }
  StageResults<Dim> run(const std::vector<double>& field) { return run(Design{field, {}}); }
  std::vector<double> wavy_design() const {
    std::vector<double> result = noise_of_variables(0.05, 0.9, 0);
    if (!setup.start) return result;
    // Times must not be as rough: islands would make the systems hard to solve to all digits.
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = 0.05 + 0.8 * setup.start->initial_time[i] + 0.1 * result[i];
    return result;
  }
  /// A direction that keeps a design positive.
  std::vector<double> direction(const std::vector<double>& design) const {
    auto result = noise_of_variables(-1.0, 1.0, 9);
    for (std::size_t e = 0; e < design.size(); ++e) result[e] *= design[e];
    return result;
  }
  /// The same of all variables; time points near the uniform ones.
  Design wavy_point() const {
    Design result{wavy_design(), {}};
    const std::size_t count = setup.layers->variables().count();
    for (std::size_t j = 1; j <= count; ++j)
      result.layer_variables.push_back(
          (static_cast<double>(j) + 0.4 * (noise(static_cast<std::int64_t>(j), 3) - 0.5)) /
          static_cast<double>(count + 1));
    return result;
  }
  Design direction_at(const Design& design) const {
    Design result{direction(design.field), {}};
    for (std::size_t j = 0; j < design.layer_variables.size(); ++j)
      result.layer_variables.push_back(noise(static_cast<std::int64_t>(j), 8) - 0.5);
    return result;
  }

  /// Numbers that depend on the places of the variables only.
  std::vector<double> noise_of_variables(double low, double high, int salt) const {
    std::vector<double> result;
    for (std::size_t i = 0; i < setup.design_support.size(); ++i)
      result.push_back(low + (high - low) * noise(setup.design_support.number(i), salt));
    return result;
  }

  Config config;
  PhaseTimer timer;
  Setup<Dim> setup;
  Pipeline<Dim> pipeline;
  Problem<Dim> problem;
};

}  // namespace fabseq::test
