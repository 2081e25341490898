// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <string>
#include <vector>

namespace fabseq {

/// Turns the closed pieces of a body's surface so that winding numbers say what is solid. One that lies in no
/// other, or in a cavity, is a body and faces outward afterwards. One in a body is a cavity, and faces inward
/// afterwards, if it was turned the other way than the body around it; otherwise it is filled. Open pieces
/// stay as they are. Returns lines for the user. Takes O(n log n).
std::vector<std::string> turn_shells(TriangleMesh& mesh);

}  // namespace fabseq
