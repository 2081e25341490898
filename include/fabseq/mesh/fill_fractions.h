// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/cut_elements.h"
#include "fabseq/mesh/winding_number.h"

#include <cstdint>
#include <vector>

namespace fabseq {

/// How clearly a mesh answers whether points lie inside it.
struct Clarity {
  std::int64_t asked = 0;    ///< number of points
  std::int64_t unclear = 0;  ///< those whose winding number is more than 0.2 away from every integer
  Point<3> least_clear{};    ///< the point whose winding number has the modulus closest to 1/2
  double least_winding = 0;  ///< its winding number; 0 if no point was asked
};

/// What share of each element lies inside a mesh.
struct FillFractions {
  std::vector<double> of_element;  ///< 0 to 1, lexicographic in the box asked for
  Clarity clarity;
};

/// Shares of the elements of `box` that lie inside `mesh`, which is where its winding number `winding` has a
/// modulus of 1/2 or more: a mesh may be inside out or overlap itself, and holes are closed smoothly. An
/// element that the surface cuts is sampled at 4 x 4 x 4 points, others at one. If `closed`
/// (is_closed(mesh)), uncut elements that follow each other along x are asked together. Otherwise every
/// element is asked at its centre, and those that a neighbour across a face contradicts are sampled, too.
///
/// Each rank may ask for its own elements: fractions do not depend on how the elements are divided into
/// boxes. So does `clarity`, but for the single questions on the runs of a closed mesh. Not collective.
FillFractions fill_fractions(const TriangleMesh& mesh, const WindingNumber& winding, bool closed,
                             const ElementLattice& lattice, const IndexBox<3>& box);

}  // namespace fabseq
