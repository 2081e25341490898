// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/element_lattice.h"
#include "fabseq/mesh/triangle_mesh.h"

#include <vector>

namespace fabseq {

/// 1 for the elements of `box` that a triangle touches, 0 for others, lexicographic in `box`. Elements that
/// only touch a triangle with a face, an edge or a corner count, too, up to a millionth of an element.
std::vector<char> cut_elements(const TriangleMesh& mesh, const ElementLattice& lattice,
                               const IndexBox<3>& box);

}  // namespace fabseq
