// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/checkpoint_state.h"
#include "fabseq/files/design_layout.h"
#include "fabseq/files/output_directory.h"

#include <mpi.h>

#include <string>

namespace fabseq {

/// Writes `checkpoint/slot_0.h5` or `slot_1.h5` of the directory, whichever the file `checkpoint/newest` does
/// not name, reads it back, and makes `newest` name it. At any moment, `newest` names a whole checkpoint or
/// is not there.
///
/// Fields become datasets on the full grid, [z][y][x], arrays datasets with one axis, all in double
/// precision, each with a checksum; scalars become attributes of the file, in binary, with one checksum for
/// all of them; a seal (seal.h) covers the file. The file does not depend on the number of ranks, nor on how
/// they are spread over grids. Throws OutputError on all ranks if anything fails; `newest` then names what it
/// named before. Collective on the directory's communicator, whose first ranks must be those of the layout's
/// grid.
template <int Dim>
void write_checkpoint(const OutputDirectory& directory, const DesignLayout<Dim>& layout,
                      const CheckpointState& state);

/// Reads a slot and compares its seal and all checksums; returns the number of datasets. Memory: one slab of
/// a dataset. Throws OutputError that names file and dataset where they differ or something is missing. Not
/// collective.
int verify_checkpoint(const std::string& path);

/// Name of the slot that `checkpoint/newest` of a directory points to, as a path within the directory; "" if
/// there is none. Not collective.
std::string newest_checkpoint(const std::string& directory);

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
