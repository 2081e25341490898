// SPDX-License-Identifier: MIT
/// \file
/// The tasks beside the optimization itself (docs/reference.md). All are collective on the world.
#pragma once

#include "fabseq/base/phase_timer.h"
#include "fabseq/config/command_line.h"
#include "fabseq/config/setup.h"

#include <mpi.h>

#include <vector>

namespace fabseq {

/// -task evaluate: values and gradients at one design; evaluation.json, gradients.h5.
template <int Dim>
void run_evaluate(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer);

/// -task simulate: the process simulation of a sequence; result.h5, summary.json. If only the release fails,
/// both are written without it before the NumericalError.
template <int Dim>
void run_simulate(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer);

/// -task sensitivity: what a sequence would do under stated changes; sensitivity.json and .csv.
template <int Dim>
void run_sensitivity(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer);

/// -task check_gradients: adjoints against central differences; gradient_check.csv and .json.
template <int Dim>
void run_check_gradients(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer);

/// -task check: prints the part, the node sets and what a run will cost; writes nothing.
template <int Dim>
void run_check(const Setup<Dim>& setup);
/// -task check -picture: writes DIR/check.h5, the layers of the start design, the substrate, the plate and
/// the node sets, and has fabseq-tools draw DIR/check.svg from it; says so where it cannot. Collective.
/// Throws OutputError.
template <int Dim>
void write_check_picture(const Setup<Dim>& setup, const CommandLine& command_line);

/// -task surface: writes DIR/surface.ply, the part's mesh as it is read, in the config's coordinates. Needs
/// of the config what says where the mesh stands. Collective. Throws OutputError.
void write_surface(MPI_Comm world, const CommandLine& command_line);

}  // namespace fabseq
