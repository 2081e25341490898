// SPDX-License-Identifier: MIT
#include "fabseq/solve/solvers.h"

#include "fabseq/solve/reference/reference_elasticity.h"
#include "solve/lane_elasticity.h"
#include "solve/lane_heat.h"
#include "solve/lane_report.h"
#include "solve/reference/reference_heat.h"
#include "solve/region_elasticity.h"
#include "solve/region_heat.h"

namespace fabseq {

AssembledSolverSettings assembled_settings(const SolverSettings& settings, const SolveTolerance& tolerance,
                                           const char* prefix) {
  return {settings.method, tolerance.value, 1000, prefix};
}

LaneCycle lane_cycle(const SolverSettings& settings) {
  return {.kind = settings.cycle, .degree = settings.smoother_degree};
}

namespace {

template <int Dim>
std::unique_ptr<HeatSolver<Dim>> make_conduction_solver(const SolverSettings& settings, const Grid<Dim>& grid,
                                                        const SystemDomain& domain, bool lumped,
                                                        const SolveTolerance& tolerance, int lanes,
                                                        const LaneCycle& cycle) {
  const auto reference = assembled_settings(settings, tolerance, heat_prefix);
  if (settings.path == SolverPath::lanes)
    return std::make_unique<LaneHeat<Dim>>(grid, domain, lumped, lane_iterations, reference, lanes, cycle);
  return std::make_unique<ReferenceHeat<Dim>>(grid, domain, lumped, reference);
}

}  // namespace

template <int Dim>
std::unique_ptr<HeatSolver<Dim>> make_heat_solver(const SolverSettings& settings, const Grid<Dim>& grid,
                                                  const SystemDomain& domain, bool lumped, double tolerance,
                                                  int lanes) {
  return make_conduction_solver(settings, grid, domain, lumped, sequence_tolerance({tolerance}), lanes,
                                LaneHeat<Dim>::cycle());
}

template <int Dim>
std::unique_ptr<HeatSolver<Dim>> make_temperature_solver(const SolverSettings& settings,
                                                         const Grid<Dim>& grid, const SystemDomain& domain,
                                                         double tolerance, int lanes) {
  const auto make = [=, &grid](const SystemDomain& of) {
    return make_conduction_solver(settings, grid, of, /*lumped=*/true, step_tolerance({tolerance}), lanes,
                                  LaneHeat<Dim>::cycle_of_steps());
  };
  if (settings.region != SolverRegion::built) return make(domain);
  return std::make_unique<RegionHeat<Dim>>(RegionPool<Dim, HeatSolver<Dim>>(grid, domain, make));
}

template <int Dim>
std::unique_ptr<ElasticitySolver<Dim>> make_elasticity_solver(const SolverSettings& settings,
                                                              const Grid<Dim>& grid,
                                                              const SystemDomain& domain,
                                                              const ElementMatrices<Dim>& element,
                                                              double poisson, double tolerance, int lanes) {
  const auto reference = assembled_settings(settings, elasticity_tolerance({tolerance}), elasticity_prefix);
  const bool in_lanes = settings.path == SolverPath::lanes;
  const auto make = [=, &grid](const SystemDomain& of) -> std::unique_ptr<ElasticitySolver<Dim>> {
    if (in_lanes)
      return std::make_unique<LaneElasticity<Dim>>(grid, of, poisson, lane_cycle(settings), lane_iterations,
                                                   reference, lanes);
    return std::make_unique<ReferenceElasticity<Dim>>(grid, of, element.stiffness(), reference);
  };
  if (settings.region != SolverRegion::built) return make(domain);
  return std::make_unique<RegionElasticity<Dim>>(RegionPool<Dim, ElasticitySolver<Dim>>(grid, domain, make));
}

FABSEQ_INSTANTIATE_FUNCTION(make_heat_solver);
FABSEQ_INSTANTIATE_FUNCTION(make_temperature_solver);
FABSEQ_INSTANTIATE_FUNCTION(make_elasticity_solver);

}  // namespace fabseq
