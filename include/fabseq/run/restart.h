// SPDX-License-Identifier: MIT
/// \file
/// -restart: which checkpoint a run continues from, and whether it is one of the same problem.
#pragma once

#include "fabseq/config/command_line.h"
#include "fabseq/files/checkpoint_state.h"
#include "fabseq/run/setup.h"

#include <optional>
#include <string>

namespace fabseq {

/// A checkpoint to continue from.
struct Restart {
  std::string directory;  ///< output directory of the run that left it
  bool in_place = false;  ///< whether that is the output directory of this run, too
  std::string slot;       ///< file name of the checkpoint
  CheckpointState state;
};

/// Output directory of a run: -output, the directory of -restart DIR, or output/NAME.
std::string output_path(const Config& config, const CommandLine& command_line);

/// Whether two paths lead to the same directory, which is there. Collective on `comm`.
bool same_directory(MPI_Comm comm, const std::string& a, const std::string& b);

/// What -restart asks for; none for a new run, which -restart auto is where there is no checkpoint yet. Reads
/// only. Throws InputError if there is no intact checkpoint, or one of another part or of a config that
/// differs in what matters (config_difference()), which it names. Collective.
template <int Dim>
std::optional<Restart> find_restart(const Setup<Dim>& setup, const CommandLine& command_line);

/// Adds to a state what find_restart() compares: the config and a checksum of the part. Collective.
template <int Dim>
void save_problem(const Setup<Dim>& setup, CheckpointState& state);

}  // namespace fabseq
