// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/part/mesh_part.h"

#include <mpi.h>

#include <memory>
#include <string>

namespace fabseq {

/// Reads the mesh that is the part of a config (null if the part is none) and puts it in its place. Where the
/// config has domain.element in place of size and elements, puts these and domain.origin there, as they
/// follow from the mesh; domain.element and domain.margin are gone then. `directory`: of relative paths.
/// Collective on `comm`. Throws the same InputError on all ranks.
std::shared_ptr<const PlacedMesh> place_mesh(MPI_Comm comm, Json& document, const std::string& directory);

}  // namespace fabseq
