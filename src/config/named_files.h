// SPDX-License-Identifier: MIT
/// \file
/// Files that a config names and that say what else it holds. `directory`: absolute directory that relative
/// paths refer to. All calls are collective on `comm`; where a file cannot be used, they throw the same
/// InputError on all ranks.
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/part/mesh_part.h"

#include <mpi.h>

#include <memory>
#include <string>

namespace fabseq {

/// Puts the keys of the file that `material.file` names into the document's `material`, unless they stand
/// there, and takes `file` out; what the file says of its sources is left out.
void merge_material_file(MPI_Comm comm, Json& document, const std::string& directory);

/// Puts the keys that follow from the file that `machine` names into the document, unless they stand there,
/// and takes `machine` out. The file lies beside the config or in configs/machines.
void merge_machine_file(MPI_Comm comm, Json& document, const std::string& directory);

/// Reads the mesh that is the part of a config (null if the part is none) and puts it in its place. Where the
/// config has domain.element in place of size and elements, puts these and domain.origin there, as they
/// follow from the mesh; domain.element and domain.margin are gone then.
std::shared_ptr<const PlacedMesh> place_mesh(MPI_Comm comm, Json& document, const std::string& directory);

/// The surface of that mesh in its place. Looks at no other keys than part.mesh, build_plate and domain.unit.
PlacedSurface surface_of_config(MPI_Comm comm, const Json& document, const std::string& directory);

}  // namespace fabseq
