// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/element_lattice.h"
#include "fabseq/mesh/triangle_mesh.h"
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

/// Shares of the elements of `box` that lie inside any mesh, whose winding number is `winding`: where it has
/// a modulus of 1/2 or more. So holes are closed smoothly. All elements are asked at their centres; those
/// that a triangle cuts, or whose neighbour across a face gives another answer, are asked at all samples.
/// Neither fractions nor clarity depend on how elements are divided into boxes.
FillFractions open_fractions(const TriangleMesh& mesh, const WindingNumber& winding,
                             const ElementLattice& lattice, const IndexBox<3>& box);

}  // namespace fabseq
