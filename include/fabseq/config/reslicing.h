// SPDX-License-Identifier: MIT
/// \file
/// Cutting the pseudo-time of a file, such as the result of a run, into layers again.
#pragma once

#include "fabseq/config/command_line.h"

#include <mpi.h>

namespace fabseq {

/// Number and sharpness of the layers that a result was made with; 0 if the file does not say. `passes`: real
/// layers that each of them stood for, likewise.
struct Slicing {
  double layers = 0.0, beta = 0.0;
  int passes = 0;
};

/// Reads the slicing of a file, and does not report one that cannot be read: its later reader does.
/// Collective on `comm`.
Slicing slicing_of(MPI_Comm comm, const std::string& name);

/// Turns settings whose sequence has become that of -sequence FILE into those of its layers, before they are
/// complete:
///   - layers.count, unless the command line gives it: the number of layers that FILE states, or that make as
///     many real layers where the command line gives layers.passes;
///   - layers.passes, unless the command line gives it: what makes as many real layers as FILE has, where the
///     number of layers divides them, else 1. Where FILE does not say what its layers stand for, the config
///     does;
///   - projection.beta, unless the command line gives it: the sharpness relative to a layer that FILE states,
///     so that the same number of layers gives the same layers;
///   - layers.target: the target thickness of the config, relative to a layer that FILE states likewise;
///   - terms that need the gradient of the pseudo-time, which a file has for checks only, and those for
///     layers of another kind are left out, each with a warning.
///
/// Not collective. Throws InputError for layers.passes that do not divide the real layers of FILE.
void reslice(const CommandLine& command_line, const Slicing& of_file, Config& config);

}  // namespace fabseq
