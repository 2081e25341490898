// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/optimize/model_settings.h"

#include <mpi.h>

#include <string>

namespace fabseq {

/// The layer groups with which a run takes least time, and why there are so many.
struct GroupChoice {
  int groups = 1;
  std::string explanation;  ///< a line for the log; empty with a single rank
};

/// What `solver.layer_groups` says, or the fastest number of groups by a model of the time that fits the
/// memory now available. Collective on `world`. Throws InputError if ranks cannot be dealt out so.
template <int Dim>
GroupChoice choose_layer_groups(MPI_Comm world, const ModelSettings& settings);

}  // namespace fabseq
