// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"

#include <mpi.h>

#include <string>

namespace fabseq {

/// The JSON object in a file of at most 1 MB. Collective on `comm`. Throws the same InputError on all ranks,
/// which names the key at `pointer`, where it cannot be read or holds something else.
Json read_named_json(MPI_Comm comm, const std::string& pointer, const std::string& path);

}  // namespace fabseq
