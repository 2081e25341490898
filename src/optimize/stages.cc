// SPDX-License-Identifier: MIT
#include "fabseq/optimize/stages.h"

#include "fabseq/sequence/direct_sequence.h"
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/heat_sequence.h"
#include "fabseq/solve/lane_elasticity.h"
#include "fabseq/solve/lane_heat.h"
#include "fabseq/solve/reference/reference_elasticity.h"
#include "fabseq/solve/reference/reference_heat.h"

#include <utility>

namespace fabseq {

namespace {

LaneCycle lane_cycle(const SolverSettings& settings) {
  return {.kind = settings.cycle, .degree = settings.smoother_degree};
}

/// `prefix`: of the PETSc options.
AssembledSolverSettings assembled(const SolverSettings& settings, const SolveTolerance& tolerance,
                                  const char* prefix) {
  return {settings.method, tolerance.value, 1000, prefix};
}

template <int Dim>
std::unique_ptr<HeatSolver<Dim>> make_heat_solver(const Model<Dim>& model, const HeatModel<Dim>& heat,
                                                  double tolerance) {
  const AssembledSolverSettings settings =
      assembled(model.settings.solver, heat_tolerance({tolerance}), "heat_");
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
  return {assembled(settings, elasticity_tolerance({tolerance}), "release_"), settings.path,
          lane_cycle(settings)};
}

template <int Dim>
std::unique_ptr<ElasticitySolver<Dim>> make_elasticity_solver(const Model<Dim>& model,
                                                              const ElasticModel<Dim>& elastic,
                                                              double tolerance) {
  const SolverSettings& solver = model.settings.solver;
  const AssembledSolverSettings settings =
      assembled(solver, elasticity_tolerance({tolerance}), "elasticity_");
  if (solver.path == SolverPath::lanes)
    return std::make_unique<LaneElasticity<Dim>>(model.grid, elastic.domain, elastic.material.poisson,
                                                 lane_cycle(solver), lane_iterations, settings, model.lanes);
  return std::make_unique<ReferenceElasticity<Dim>>(model.grid, elastic.domain, elastic.element.stiffness(),
                                                    settings);
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

FABSEQ_INSTANTIATE_FUNCTION(make_sequence);
FABSEQ_INSTANTIATE_FUNCTION(make_baseline_sequence);
FABSEQ_INSTANTIATE_FUNCTION(make_elasticity_solver);

}  // namespace fabseq
