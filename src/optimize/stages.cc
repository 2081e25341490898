// SPDX-License-Identifier: MIT
#include "fabseq/optimize/stages.h"

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

LaneCycle lane_cycle(const SolverSettings& settings) {
  LaneCycle cycle;
  cycle.kind = settings.cycle;
  cycle.degree = settings.smoother_degree;
  return cycle;
}

AssembledSolverSettings elasticity_settings(const SolverSettings& settings, double tolerance) {
  return {settings.method, elasticity_tolerance(tolerance), 1000, "elasticity_"};
}

AssembledSolverSettings heat_settings(const SolverSettings& settings, double tolerance) {
  return {settings.method, heat_tolerance(tolerance), 1000, "heat_"};
}

template <int Dim>
std::unique_ptr<HeatSolver<Dim>> make_heat_solver(const Model<Dim>& model, const HeatModel<Dim>& heat,
                                                  double tolerance) {
  const AssembledSolverSettings settings = heat_settings(model.settings.solver, tolerance);
  if (model.settings.solver.path == SolverPath::lanes)
    return std::make_unique<LaneHeat<Dim>>(model.grid, heat.domain, heat.lumped, lane_iterations, settings,
                                           model.lanes);
  return std::make_unique<ReferenceHeat<Dim>>(model.grid, heat.domain, heat.lumped, settings);
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_heat_sequence(const Model<Dim>& model, double tolerance) {
  const SequenceSettings& settings = model.settings.sequence;
  const auto& target = model.settings.layers.target;
  const double gradient = target ? 1.0 / (model.layers->count() * target->value) : 0.0;
  auto heat = std::make_unique<const HeatModel<Dim>>(model.part, settings);
  auto solver = make_heat_solver(model, *heat, tolerance);
  return std::make_unique<HeatSequence<Dim>>(model.part, settings, gradient, std::move(heat),
                                             std::move(solver), model.groups.across(), model.lanes);
}

}  // namespace

ReleaseSolver release_solver(const SolverSettings& settings, double tolerance) {
  return {{settings.method, elasticity_tolerance(tolerance), 1000, "release_"},
          settings.path,
          lane_cycle(settings)};
}

template <int Dim>
std::unique_ptr<ElasticitySolver<Dim>> make_elasticity_solver(const Model<Dim>& model,
                                                              const ElasticModel<Dim>& elastic,
                                                              double tolerance) {
  const SolverSettings& solver = model.settings.solver;
  if (solver.path == SolverPath::lanes)
    return std::make_unique<LaneElasticity<Dim>>(model.grid, elastic.domain, elastic.material.poisson,
                                                 lane_cycle(solver), lane_iterations,
                                                 elasticity_settings(solver, tolerance), model.lanes);
  return std::make_unique<ReferenceElasticity<Dim>>(model.grid, elastic.domain, elastic.element.stiffness(),
                                                    elasticity_settings(solver, tolerance));
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_sequence(const Model<Dim>& model, double tolerance) {
  const SequenceSettings& settings = model.settings.sequence;
  switch (settings.type) {
    case SequenceType::planar:
      return std::make_unique<GivenSequence<Dim>>(planar_time(model.part, settings.direction));
    case SequenceType::file:
      return std::make_unique<GivenSequence<Dim>>(
          time_from_file(model.part, settings.file, settings.dataset));
    case SequenceType::direct:
      return make_direct_sequence(model.part, model.design_support, *model.start, settings.filter_radius);
    default:
      return make_heat_sequence(model, tolerance);
  }
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_baseline_sequence(const Model<Dim>& model) {
  return std::make_unique<GivenSequence<Dim>>(planar_time(model.part, model.settings.baseline.direction));
}

template std::unique_ptr<Sequence<2>> make_sequence<2>(const Model<2>&, double);
template std::unique_ptr<Sequence<3>> make_sequence<3>(const Model<3>&, double);
template std::unique_ptr<Sequence<2>> make_baseline_sequence<2>(const Model<2>&);
template std::unique_ptr<Sequence<3>> make_baseline_sequence<3>(const Model<3>&);
template std::unique_ptr<ElasticitySolver<2>> make_elasticity_solver<2>(const Model<2>&,
                                                                        const ElasticModel<2>&, double);
template std::unique_ptr<ElasticitySolver<3>> make_elasticity_solver<3>(const Model<3>&,
                                                                        const ElasticModel<3>&, double);

}  // namespace fabseq
