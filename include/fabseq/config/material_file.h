// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"

#include <mpi.h>

#include <string>

namespace fabseq {

/// Puts the keys of the file that `material.file` names into the document's `material`, unless they stand
/// there, and takes `file` out; what the file says of its sources is left out. `directory`: absolute
/// directory that relative paths in the config refer to. Rank 0 reads; collective. Throws InputError on all
/// ranks for a file that cannot be read or holds no JSON object.
void merge_material_file(MPI_Comm comm, Json& document, const std::string& directory);

}  // namespace fabseq
