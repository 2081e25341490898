// SPDX-License-Identifier: MIT
/// \file
/// What a run will cost in memory and time.
#pragma once

#include "fabseq/optimize/model_settings.h"
#include "fabseq/parallel/layer_dealing.h"

#include <mpi.h>

#include <map>
#include <string>

namespace fabseq {

/// What memory and time of a run follow from.
struct RunSize {
  double unknowns = 0.0;       ///< of one layer's system
  double nodes = 0.0;          ///< of the box
  double part_elements = 0.0;  ///< all ranks
  int dimension = 3;
  int layers = 0;
  int ranks = 1;
  int cases = 1;        ///< strains that each layer is solved for
  int functionals = 0;  ///< residuals of least squares, scenarios of the worst: each costs an elastic adjoint
};

/// Size of a run with this part, its node sets and so many layers. Collective on the grid's communicator.
template <int Dim>
RunSize run_size(const ModelSettings& settings, const Part<Dim>& part,
                 const std::map<std::string, NodeSet>& node_sets, int layers, int ranks);

/// How a solver path goes through a block of layers.
BlockSolver block_solver(SolverPath path);

/// Measured on one core (docs/performance.md), good to a factor of two.
double memory_estimate(const RunSize& size, SolverPath path, int groups, int lanes);  ///< all ranks, bytes
double iteration_seconds_estimate(const RunSize& size, SolverPath path);  ///< per design iteration
/// Time of a design iteration, in units of a full block of layers on one rank.
double relative_time_estimate(const RunSize& size, SolverPath path, int groups);

/// Share of the available memory that a choice may fill.
constexpr double usable_memory = 0.8;
/// What `solver.lanes` says, or else the most there can be.
int wanted_lanes(const SolverSettings& settings);
/// What `solver.lanes` says, or the most, 8, 4, 2 or 1, with which a run fits the memory now available.
/// Collective on `world`.
int resolved_lanes(MPI_Comm world, const SolverSettings& settings, const RunSize& size, int groups);

}  // namespace fabseq
