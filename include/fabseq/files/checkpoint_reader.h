// SPDX-License-Identifier: MIT
/// \file
/// Checkpoints read again: the newest that is intact, on any number of ranks.
#pragma once

#include "fabseq/files/checkpoint_state.h"
#include "fabseq/files/design_layout.h"

#include <mpi.h>

#include <string>

namespace fabseq {

/// Path of the checkpoint to continue from: the slot that `checkpoint/newest` of a directory names; if that
/// is damaged, the other one, with a warning that says why. Without that file (a run that ended while it
/// wrote its first checkpoint) an intact slot counts as well. "" if there is none. Throws InputError if
/// `newest` is there but neither slot is intact. Collective.
std::string find_checkpoint(MPI_Comm comm, const std::string& directory);

/// Everything in a checkpoint that find_checkpoint() has found. Scalars and arrays are the same on all ranks;
/// fields are read in parallel, each rank its entries. Throws InputError on all ranks if the fields do not
/// have the shape of the grid. Collective on the layout's grid.
template <int Dim>
CheckpointState read_checkpoint(const std::string& path, const DesignLayout<Dim>& layout);
/// Its scalars alone, of which what the problem was can be told before anything is made of it. Collective.
CheckpointState read_checkpoint_scalars(MPI_Comm comm, const std::string& path);

}  // namespace fabseq
