// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/mesh/triangle_mesh.h"

#include <vector>

namespace fabseq {

/// 1 for the nodes of `box`, lexicographic, that lie at most `distance` (length unit) from the mesh, 0 for
/// others. Not collective.
std::vector<char> nodes_near(const TriangleMesh& mesh, double distance, const Domain<3>& domain,
                             const IndexBox<3>& box);

}  // namespace fabseq
