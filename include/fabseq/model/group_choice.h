// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/model/model_settings.h"
#include "fabseq/model/run_size.h"

#include <mpi.h>

#include <string>

namespace fabseq {

/// The layer groups with which a run takes least time, and why there are so many.
struct GroupChoice {
  int groups = 1;
  std::string explanation;  ///< a line for the log; empty with a single rank
};

/// Chooses as many groups as `solver.layer_groups` says. Throws InputError if ranks cannot be dealt out so.
GroupChoice asked_choice(int groups, int ranks);
/// The number of groups that is the fastest by a model of the time and fits the `available` memory, bytes.
template <int Dim>
GroupChoice fastest_choice(const ModelSettings& settings, const RunSize& size, double available);
/// The same as far as it can be told without a part, without an explanation: only those groups count whose
/// boxes fit the memory.
template <int Dim>
GroupChoice likely_choice(const ModelSettings& settings, int ranks, double cores_per_rank, double available);

}  // namespace fabseq
