// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"
#include "mesh/split_triangle.h"

#include <vector>

namespace fabseq {

/// A polygon of a surface that was divided.
struct SurfacePiece {
  Polygon3 polygon;
  bool divided = true;  ///< a triangle was: its neighbours may have corners on its edges, and it on theirs
};

/// Makes triangles of polygons whose corners may lie within edges of others: such edges get these corners,
/// too, so that neighbours share whole edges. Points within the tolerance of each other become one.
TriangleMesh stitched(const std::vector<SurfacePiece>& pieces, double tolerance);

}  // namespace fabseq
