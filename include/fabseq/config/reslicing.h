// SPDX-License-Identifier: MIT
/// \file
/// Cutting the pseudo-time of a file, such as the result of a run, into layers again.
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/config/command_line.h"

#include <mpi.h>

namespace fabseq {

/// Makes of a config, as read and with the overrides applied, one whose sequence is that of -sequence FILE:
///   - sequence: the dataset `time` of FILE;
///   - layers.count, unless given on the command line: as many as FILE says that it has;
///   - projection.beta, unless given there: as sharp as FILE says that it is, relative to a layer, which
///   gives the same
///     layers for the same number of them;
///   - without the terms that need the gradient of the pseudo-time, which a file does not have, with a
///   warning each.
/// Collective on `comm`; does nothing without -sequence. A file that cannot be read is left to those who read
/// it.
void reslice(MPI_Comm comm, const CommandLine& command_line, Json& document);

}  // namespace fabseq
