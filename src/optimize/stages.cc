// SPDX-License-Identifier: MIT
#include "fabseq/optimize/stages.h"

#include "fabseq/layers/curved_layers.h"
#include "fabseq/layers/multi_planar_layers.h"
#include "fabseq/sequence/direct_sequence.h"
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/heat_sequence.h"
#include "fabseq/solve/lane_elasticity.h"
#include "fabseq/solve/lane_heat.h"
#include "fabseq/solve/reference/reference_elasticity.h"
#include "fabseq/solve/reference/reference_heat.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

/// Conjugate gradients stop making progress below this.
constexpr double smallest_tolerance = 1e-13;

LaneCycle lane_cycle(const SolverSettings& settings) {
  LaneCycle cycle;
  cycle.kind = settings.cycle;
  cycle.degree = settings.smoother_degree;
  return cycle;
}

template <int Dim>
std::unique_ptr<HeatSolver<Dim>> make_heat_solver(const Setup<Dim>& setup, const HeatModel<Dim>& model,
                                                  double tolerance) {
  const AssembledSolverSettings settings = heat_solver_settings(setup.config, tolerance);
  if (setup.config.solver.path == SolverPath::lanes)
    return std::make_unique<LaneHeat<Dim>>(setup.grid, model.domain, model.lumped, lane_iterations, settings,
                                           setup.lanes);
  return std::make_unique<ReferenceHeat<Dim>>(setup.grid, model.domain, model.lumped, settings);
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_heat_sequence(const Setup<Dim>& setup, double tolerance) {
  const SequenceSettings& settings = setup.config.sequence;
  const auto target = setup.config.target_thickness();
  const double gradient = target ? 1.0 / (setup.layer_count * *target) : 0.0;
  auto model = std::make_unique<const HeatModel<Dim>>(setup.part, settings);
  auto solver = make_heat_solver(setup, *model, tolerance);
  return std::make_unique<HeatSequence<Dim>>(setup.part, settings, gradient, std::move(model),
                                             std::move(solver), setup.groups.across(), setup.lanes);
}

/// T_0 ... T_N, with those that vary.
std::vector<double> time_points_of(std::span<const double> variables, int layers) {
  if (variables.empty()) return uniform_time_points(layers);
  std::vector<double> result = {0.0};
  result.insert(result.end(), variables.begin(), variables.end());
  result.push_back(1.0);
  return result;
}

}  // namespace

AssembledSolverSettings elasticity_solver_settings(const Config& config, double tolerance) {
  return {config.solver.method, std::max(tolerance, smallest_tolerance), 1000, "elasticity_"};
}

ReleaseSolver release_solver(const Config& config, double tolerance) {
  return {{config.solver.method, std::max(tolerance, smallest_tolerance), 1000, "release_"},
          config.solver.path,
          lane_cycle(config.solver)};
}

AssembledSolverSettings heat_solver_settings(const Config& config, double tolerance) {
  return {config.solver.method, std::max(1e-3 * tolerance, smallest_tolerance), 1000, "heat_"};
}

template <int Dim>
std::unique_ptr<ElasticitySolver<Dim>> make_elasticity_solver(const Setup<Dim>& setup,
                                                              const ElasticModel<Dim>& model,
                                                              double tolerance) {
  const SolverSettings& solver = setup.config.solver;
  if (solver.path == SolverPath::lanes)
    return std::make_unique<LaneElasticity<Dim>>(
        setup.grid, model.domain, model.material.poisson, lane_cycle(solver), lane_iterations,
        elasticity_solver_settings(setup.config, tolerance), setup.lanes);
  return std::make_unique<ReferenceElasticity<Dim>>(setup.grid, model.domain, model.element.stiffness(),
                                                    elasticity_solver_settings(setup.config, tolerance));
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_sequence(const Setup<Dim>& setup, double tolerance) {
  const SequenceSettings& settings = setup.config.sequence;
  switch (settings.type) {
    case SequenceType::planar:
      return std::make_unique<GivenSequence<Dim>>(planar_time(setup.part, settings.direction));
    case SequenceType::file:
      return std::make_unique<GivenSequence<Dim>>(
          time_from_file(setup.part, settings.file, settings.dataset));
    case SequenceType::direct:
      return make_direct_sequence(setup.part, setup.design_support, *setup.start, settings.filter_radius);
    default:
      return make_heat_sequence(setup, tolerance);
  }
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_baseline_sequence(const Setup<Dim>& setup) {
  return std::make_unique<GivenSequence<Dim>>(planar_time(setup.part, setup.config.baseline.direction));
}

template <int Dim>
LayerMaker make_uniform_layers(const Setup<Dim>& setup) {
  return [&setup](std::span<const double> variables, int count, double beta, bool binary) {
    return std::make_unique<CurvedLayers>(setup.part.part_density(), time_points_of(variables, count), beta,
                                          binary);
  };
}

template <int Dim>
LayerMaker make_layers(const Setup<Dim>& setup, double tolerance) {
  if (!setup.config.layers.multi_planar) return make_uniform_layers(setup);
  const ProcessSettings& process = setup.config.process;
  const NegligibleLayers negligible{tolerance * process.min_stiffness, process.strain_penalty};
  return [&setup, negligible](std::span<const double> angles, int, double, bool binary) {
    return std::make_unique<MultiPlanarLayers<Dim>>(setup.part, *setup.config.layers.multi_planar, angles,
                                                    binary, negligible);
  };
}

template std::unique_ptr<Sequence<2>> make_sequence<2>(const Setup<2>&, double);
template std::unique_ptr<Sequence<3>> make_sequence<3>(const Setup<3>&, double);
template LayerMaker make_layers<2>(const Setup<2>&, double);
template LayerMaker make_layers<3>(const Setup<3>&, double);
template LayerMaker make_uniform_layers<2>(const Setup<2>&);
template LayerMaker make_uniform_layers<3>(const Setup<3>&);
template std::unique_ptr<Sequence<2>> make_baseline_sequence<2>(const Setup<2>&);
template std::unique_ptr<Sequence<3>> make_baseline_sequence<3>(const Setup<3>&);
template std::unique_ptr<ElasticitySolver<2>> make_elasticity_solver<2>(const Setup<2>&,
                                                                        const ElasticModel<2>&, double);
template std::unique_ptr<ElasticitySolver<3>> make_elasticity_solver<3>(const Setup<3>&,
                                                                        const ElasticModel<3>&, double);

}  // namespace fabseq
