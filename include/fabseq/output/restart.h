// SPDX-License-Identifier: MIT
/// \file
/// -restart: which checkpoint a run continues from.
#pragma once

#include "fabseq/config/setup.h"
#include "fabseq/files/checkpoint_state.h"
#include "fabseq/output/run_place.h"

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

/// What a run continues from; none for a new one, which -restart auto is where there is no checkpoint yet.
/// Reads only. Throws InputError if there is no intact checkpoint, or one of another part or of a config that
/// differs in what matters (config_difference()), which it names. Collective.
template <int Dim>
std::optional<Restart> find_restart(const Setup<Dim>& setup, const RunPlace& place);

/// Adds to a state what find_restart() compares: the config and a checksum of the part. Collective.
template <int Dim>
void save_problem(const Setup<Dim>& setup, CheckpointState& state);

}  // namespace fabseq
