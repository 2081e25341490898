/// \file
/// Checkpoints a run can trust: written, synced, read back, and only then pointed to.
#pragma once

#include "fabseq/io/field_set.h"
#include "fabseq/io/json.h"
#include "fabseq/io/output_directory.h"

#include <string>

namespace fabseq {

/// Writes `checkpoint/slot_0.h5` or `slot_1.h5` of the directory, whichever the file `checkpoint/newest` does
/// not name, reads it back, and makes `newest` name it. At any moment, `newest` names a whole checkpoint or
/// is not there.
///
/// `fields`: each a dataset on the full grid, [z][y][x], in double precision, with a checksum. `scalars`: an
/// object of booleans, integers, numbers and strings, each an attribute of the file, in binary; one checksum
/// for all of them. The file does not depend on the number of ranks. Throws OutputError on all ranks if
/// anything fails; `newest` then names what it named before. Collective on the directory's communicator,
/// whose first ranks must be those of the grid.
template <int Dim>
void write_checkpoint(const OutputDirectory& directory, const FieldSet<Dim>& fields, const Json& scalars);

/// Reads a slot and compares all checksums; returns the number of datasets. Memory: one slab of a dataset.
/// Throws OutputError that names file and dataset where they differ or something is missing. Not collective.
int verify_checkpoint(const std::string& path);

/// Name of the slot that `checkpoint/newest` of a directory points to; "" if there is none. Not collective.
std::string newest_checkpoint(const std::string& directory);

extern template void write_checkpoint<2>(const OutputDirectory&, const FieldSet<2>&, const Json&);
extern template void write_checkpoint<3>(const OutputDirectory&, const FieldSet<3>&, const Json&);

}  // namespace fabseq
