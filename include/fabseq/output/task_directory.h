// SPDX-License-Identifier: MIT
/// \file
/// The directory that a task writes to.
#pragma once

#include "fabseq/config/command_line.h"
#include "fabseq/config/setup.h"
#include "fabseq/files/output_directory.h"
#include "fabseq/output/run_place.h"

#include <string>

namespace fabseq {

/// Whether two paths lead to the same directory, which is there. Collective.
bool same_directory(MPI_Comm comm, const std::string& a, const std::string& b);

/// Makes the directory of a run and writes config.json: the effective config with the key `run` (command
/// line, versions, ranks). `continues`: a run that is there goes on. Throws InputError if the run takes its
/// design or its sequence from one that it would replace. Collective.
template <int Dim>
OutputDirectory make_run_directory(const Setup<Dim>& setup, const CommandLine& command_line,
                                   const RunPlace& place, bool continues);
/// The same for a new run at the place that the command line names.
template <int Dim>
OutputDirectory make_output_directory(const Setup<Dim>& setup, const CommandLine& command_line);

}  // namespace fabseq
