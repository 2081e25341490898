// SPDX-License-Identifier: MIT
/// \file
/// What a run will cost in memory and time.
#pragma once

#include "fabseq/model/run_size.h"
#include "fabseq/parallel/step_dealing.h"

#include <mpi.h>

namespace fabseq {

/// How a solver path goes through a block of layers.
BlockSolver block_solver(SolverPath path);

/// Whether solvers with so many lanes give their memory back between solves (docs/developer/lane-engine.md).
bool saves_memory(int lanes);

/// Sums over what the stages cost (StageCost). Measured on one core (docs/developer/measuring.md), good to a
/// factor of two.
double memory_estimate(const RunSize& size, SolverPath path, int groups, int lanes);  ///< all ranks, bytes
double iteration_seconds_estimate(const RunSize& size, SolverPath path);  ///< per design iteration
/// Time of a design iteration, in units of a full block of layers on one rank. Ranks beyond the
/// cores gain nothing.
double relative_time_estimate(const RunSize& size, SolverPath path, int groups);

/// Share of the available memory that a choice may fill.
constexpr double usable_memory = 0.8;
/// What `solver.lanes` says, or else the most there can be.
int wanted_lanes(const SolverSettings& settings);
/// What `solver.lanes` says, or the most, 8, 4, 2 or 1, with which a run fits the memory now available.
/// Collective on `world`.
int resolved_lanes(MPI_Comm world, const SolverSettings& settings, const RunSize& size, int groups);

}  // namespace fabseq
