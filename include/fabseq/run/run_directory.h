// SPDX-License-Identifier: MIT
/// \file
/// The output directory of a task.
#pragma once

#include "fabseq/config/command_line.h"
#include "fabseq/files/output_directory.h"
#include "fabseq/run/setup.h"

namespace fabseq {

/// Makes the directory of output_path(), writes config.json: the effective config with the key `run` (command
/// line, versions, ranks). `continues`: a run that is there goes on. Collective.
template <int Dim>
OutputDirectory make_output_directory(const Setup<Dim>& setup, const CommandLine& command_line,
                                      bool continues = false);

}  // namespace fabseq
