// SPDX-License-Identifier: MIT
/// \file
/// What a run will cost, and the layer groups that make it cost least.
#pragma once

#include "fabseq/config/config.h"
#include "fabseq/parallel/layer_dealing.h"

#include <mpi.h>

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
  int functionals = 0;  ///< residuals of least squares: an elastic adjoint each
};

/// Of a part with this many layers. Collective on the grid's communicator.
template <int Dim>
RunSize run_size(const Config& config, const Part<Dim>& part, int layers, int ranks);

/// The number of layers a config asks for ("auto": from the largest distance to the plate inside the part).
/// Collective; throws InputError if there are too many.
template <int Dim>
int resolved_layer_count(const Config& config, const Part<Dim>& part);
/// `rounded` layers, at least one, for a height; refuses the target thickness that makes too many.
int layers_of_target(const Config& config, double height, double rounded);

/// How a solver path goes through a block of layers.
BlockSolver block_solver(SolverPath path);

/// Measured on one core (docs/performance.md), good to a factor of two.
double memory_estimate(const RunSize& size, SolverPath path, int groups, int lanes);  ///< all ranks, bytes
double iteration_seconds_estimate(const RunSize& size, SolverPath path);  ///< of a design iteration

/// What `solver.lanes` says, or the most, 8, 4, 2 or 1, with which a run fits the memory now available.
/// Collective on `world`.
int resolved_lanes(MPI_Comm world, const Config& config, const RunSize& size, int groups);

/// Layer groups of a run, and why there are so many.
struct GroupChoice {
  int groups = 1;
  std::string explanation;  ///< a line for the log; empty with a single rank
};

/// What `solver.layer_groups` says, or the fastest number of groups by a model of the time that fits the
/// memory now available. Collective on `world`. Throws InputError if ranks cannot be dealt out so.
template <int Dim>
GroupChoice choose_layer_groups(MPI_Comm world, const Config& config);

extern template RunSize run_size<2>(const Config&, const Part<2>&, int, int);
extern template RunSize run_size<3>(const Config&, const Part<3>&, int, int);
extern template int resolved_layer_count<2>(const Config&, const Part<2>&);
extern template int resolved_layer_count<3>(const Config&, const Part<3>&);
extern template GroupChoice choose_layer_groups<2>(MPI_Comm, const Config&);
extern template GroupChoice choose_layer_groups<3>(MPI_Comm, const Config&);

}  // namespace fabseq
