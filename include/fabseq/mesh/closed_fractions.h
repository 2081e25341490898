// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/element_lattice.h"
#include "fabseq/mesh/triangle_mesh.h"

#include <vector>

namespace fabseq {

/// Share of the samples of each element of `box` around which a closed mesh winds, lexicographic. The mesh
/// must be closed (is_closed()); it may be inside out or overlap itself.
///
/// A line along x through samples crosses as many triangles in one direction as in the other, and the winding
/// number at a sample is the sum over those before it. Lines that run through edges and corners are no
/// exception: a triangle's part in a line is a sum over its edges, and at an edge between two triangles these
/// add the same number with opposite signs, rounding included. Takes time in proportion to the number of
/// crossings, whatever the shape of the triangles.
std::vector<double> closed_fractions(const TriangleMesh& mesh, const ElementLattice& lattice,
                                     const IndexBox<3>& box);

}  // namespace fabseq
