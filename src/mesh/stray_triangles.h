// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <string>
#include <vector>

namespace fabseq {

/// Removes stray triangles: open pieces of up to 8 triangles that have no area, or that would make the box
/// around the rest ten times as large or more. Such a piece encloses nothing. Returns a line for the user for
/// what had an area.
std::vector<std::string> remove_stray_triangles(TriangleMesh& mesh);

}  // namespace fabseq
