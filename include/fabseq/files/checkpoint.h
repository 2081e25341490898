// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/checkpoint_state.h"
#include "fabseq/files/design_layout.h"
#include "fabseq/files/output_directory.h"

#include <mpi.h>

#include <string>

namespace fabseq {

/// Writes that one of `checkpoint/slot_0.h5` and `slot_1.h5` of the directory which the file
/// `checkpoint/newest` does not name, reads it back, and makes `newest` name it. At any moment, `newest`
/// names a whole checkpoint or does not exist.
///
/// Fields become datasets on the full grid, [z][y][x], and arrays become datasets with one axis. Both are in
/// double precision and each has a checksum. Scalars become attributes of the file, in binary, with one
/// checksum for all of them. A seal (seal.h) covers the file. The file does not depend on the number of
/// ranks, nor on the number of grids they hold. Collective on the directory's communicator, whose first ranks
/// must be those of the layout's grid. Throws OutputError on all ranks if anything fails; `newest` then names
/// what it named before.
template <int Dim>
void write_checkpoint(const OutputDirectory& directory, const DesignLayout<Dim>& layout,
                      const CheckpointState& state);

/// Reads a slot, compares its seal and all checksums, and returns the number of datasets. Holds a copy of the
/// file and one slab of a dataset in memory. Throws OutputError, which names the file and the dataset, if a
/// checksum differs or something is missing. Not collective.
int verify_checkpoint(const std::string& path);

/// Name of the slot that `checkpoint/newest` of a directory names, as a path within the directory; "" if
/// there is none. Not collective.
std::string newest_checkpoint(const std::string& directory);

/// Path of the checkpoint to continue from; "" if there is none. It is the slot that `checkpoint/newest` of
/// the directory names or, if that is damaged, the other one, with a warning that says why. Without `newest`
/// (a run that ended while it wrote its first checkpoint) an intact slot counts as well. Throws InputError on
/// all ranks if `newest` is there but neither slot is intact. Collective on `comm`.
std::string find_checkpoint(MPI_Comm comm, const std::string& directory);

/// Everything in a checkpoint that find_checkpoint() has found. Scalars and arrays are the same on all ranks.
/// Fields are read in parallel, and each rank gets its own entries. Throws InputError on all ranks if the
/// fields do not have the shape of the grid. Collective on the communicator of the layout's grid.
template <int Dim>
CheckpointState read_checkpoint(const std::string& path, const DesignLayout<Dim>& layout);
/// The scalars and arrays of a checkpoint, without its fields: enough to find out which problem the run
/// solves before a grid or a part exists. Collective on `comm`.
CheckpointState read_checkpoint_scalars(MPI_Comm comm, const std::string& path);

}  // namespace fabseq
