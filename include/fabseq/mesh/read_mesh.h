// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <mpi.h>

#include <string>

namespace fabseq {

/// The surfaces of a file.
struct ReadMesh {
  TriangleMesh mesh;
  double unit_factor = 1.0;  ///< by which the file's coordinates have been multiplied
};

/// Reads all surfaces of an STL, OBJ, PLY or 3MF file as one mesh: rank 0 reads, all ranks of `comm` get it.
/// Axes stay as they are. Objects stand where their transformations put them. Points at the same position
/// become one. Polygons are divided into fans: where one is not convex, triangles overlap, and the winding
/// number, which sees their orientation, is still that of the polygon. Triangles in which all points differ
/// stay even if their area is 0, since a surface may be open without them; others, lines and points do not
/// count.
///
/// 3MF files name their unit of length: coordinates are converted to `unit` if that is the name of one. That
/// is said, as are coordinates that have lost digits, and what a file lacks or has too much.
///
/// Throws InputError on all ranks, with `key` and the file in the message, if there is no such file, if it is
/// damaged or has another format, if it has no triangle or more than 2^31 - 1, or a coordinate beyond
/// largest_mesh_coordinate. Collective on `comm`.
ReadMesh read_mesh(MPI_Comm comm, const std::string& path, const std::string& key,
                   const std::string& unit = "");

/// The same for the surface of a body: stray triangles are left out (remove_stray_triangles()) and closed
/// pieces turned (turn_shells()), with a warning that says so. Collective on `comm`.
ReadMesh read_body(MPI_Comm comm, const std::string& path, const std::string& key,
                   const std::string& unit = "");

}  // namespace fabseq
