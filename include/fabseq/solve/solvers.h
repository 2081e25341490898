// SPDX-License-Identifier: MIT
/// \file
/// The solvers of the path that a run asks for (`solver.path`), and their settings.
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/grid/grid.h"
#include "fabseq/multigrid/lane_cycle.h"
#include "fabseq/solve/elasticity_solver.h"
#include "fabseq/solve/heat_solver.h"
#include "fabseq/solve/reference/assembled_system.h"
#include "fabseq/solve/solver_settings.h"

#include <array>
#include <memory>

namespace fabseq {

/// Prefixes of the PETSc options of the reference solvers: "-elasticity_ksp_view".
inline constexpr const char* elasticity_prefix = "elasticity_";
inline constexpr const char* heat_prefix = "heat_";
inline constexpr const char* release_prefix = "release_";
inline constexpr std::array solver_prefixes{elasticity_prefix, heat_prefix, release_prefix};

/// Settings of a reference solver, or of the one that the lane solvers fall back to.
AssembledSolverSettings assembled_settings(const SolverSettings& settings, const SolveTolerance& tolerance,
                                           const char* prefix);
/// The multigrid cycle of the lane solvers for elasticity.
LaneCycle lane_cycle(const SolverSettings& settings);

/// A solver for a sequence's heat equation, a thousand times closer than `tolerance` of the run. `lanes`:
/// right-hand sides side by side at most. Grid and domain must outlive it. Collective.
template <int Dim>
std::unique_ptr<HeatSolver<Dim>> make_heat_solver(const SolverSettings& settings, const Grid<Dim>& grid,
                                                  const SystemDomain& domain, bool lumped, double tolerance,
                                                  int lanes);
/// A solver for the steps of heat conduction in time, without elements that have no diffusivity where
/// `settings.region` is `built`. Ten times closer than `tolerance` of the run, with a lumped capacity and a
/// V-cycle. Else as make_heat_solver().
template <int Dim>
std::unique_ptr<HeatSolver<Dim>> make_temperature_solver(const SolverSettings& settings,
                                                         const Grid<Dim>& grid, const SystemDomain& domain,
                                                         double tolerance, int lanes);
/// A solver for elasticity to `tolerance` of the run. `lanes`: layers side by side at most. Grid and domain
/// must outlive it. Leaves out elements without stiffness in all layers of a block where `settings.region` is
/// `built`. Collective.
template <int Dim>
std::unique_ptr<ElasticitySolver<Dim>> make_elasticity_solver(const SolverSettings& settings,
                                                              const Grid<Dim>& grid,
                                                              const SystemDomain& domain,
                                                              const ElementMatrices<Dim>& element,
                                                              double poisson, double tolerance, int lanes);

}  // namespace fabseq
