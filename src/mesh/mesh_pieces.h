// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Triangles that hang together by shared edges.
struct MeshPiece {
  std::vector<std::int32_t> triangles;  ///< ascending
  bool closed = true;                   ///< every edge has as many triangles in one direction as in the other
};

/// The pieces of a mesh, in the order of their first triangles. At an edge, triangles that run along it in
/// opposite directions hang together by twos, those that follow each other in the mesh first: where bodies
/// touch along edges, each stays a piece of its own. Points at the same position must have been joined.
/// Takes O(n log n).
std::vector<MeshPiece> find_mesh_pieces(const TriangleMesh& mesh);

/// The smallest box around those of the triangles that have an area; infinite with low > high if none has.
Bounds bounds(const TriangleMesh& mesh, std::span<const std::int32_t> triangles);
/// The smallest box around both.
Bounds join(const Bounds& a, const Bounds& b);
/// Whether they have a point in common.
bool overlap(const Bounds& a, const Bounds& b);
/// Product of the edges; 0 for a box around nothing.
double volume(const Bounds& box);

}  // namespace fabseq
