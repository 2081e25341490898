// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <vector>

namespace fabseq {

/// Holes for cut_out(), one after the other, that remove what lies in any of some meshes, which may cut each
/// other: their closed pieces, those together whose boxes are apart. A mesh with a cavity or an open piece
/// stays whole. Closed pieces must be turned (turn_shells()).
std::vector<TriangleMesh> hole_groups(const std::vector<TriangleMesh>& meshes);

}  // namespace fabseq
