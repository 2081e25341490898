// SPDX-License-Identifier: MIT
#include "fabseq/optimize/stages.h"

#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/sequence_kind.h"
#include "fabseq/solve/lane_elasticity.h"
#include "fabseq/solve/lane_heat.h"
#include "fabseq/solve/reference/reference_elasticity.h"
#include "fabseq/solve/reference/reference_heat.h"

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
std::unique_ptr<HeatSolver<Dim>> make_heat_solver(const Model<Dim>& model, const SystemDomain& domain,
                                                  bool lumped, double tolerance) {
  const AssembledSolverSettings settings =
      assembled(model.settings.solver, heat_tolerance({tolerance}), "heat_");
  if (model.settings.solver.path == SolverPath::lanes)
    return std::make_unique<LaneHeat<Dim>>(model.grid, domain, lumped, lane_iterations, settings,
                                           model.lanes);
  return std::make_unique<ReferenceHeat<Dim>>(model.grid, domain, lumped, settings);
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
  const auto& target = model.settings.layers.target;
  const auto heat_solver = [&model, tolerance](const SystemDomain& domain, bool lumped) {
    return make_heat_solver(model, domain, lumped, tolerance);
  };
  return settings.kind->make(
      settings, SequenceContext<Dim>{model.part, model.design_support, model.start,
                                     target ? 1.0 / (model.layers->count() * target->value) : 0.0,
                                     model.groups.across(), model.lanes, heat_solver});
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_baseline_sequence(const Model<Dim>& model) {
  return std::make_unique<GivenSequence<Dim>>(planar_time(model.part, model.settings.baseline.direction));
}

FABSEQ_INSTANTIATE_FUNCTION(make_sequence);
FABSEQ_INSTANTIATE_FUNCTION(make_baseline_sequence);
FABSEQ_INSTANTIATE_FUNCTION(make_elasticity_solver);

}  // namespace fabseq
