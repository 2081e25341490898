// SPDX-License-Identifier: MIT
#include "fabseq/mesh/mesh_interior.h"

#include "fabseq/mesh/closed_fractions.h"

namespace fabseq {

MeshInterior::MeshInterior(const TriangleMesh& mesh) : mesh_(mesh) {
  if (!is_closed(mesh)) winding_.emplace(mesh);
}

FillFractions MeshInterior::fill_fractions(const ElementLattice& lattice, const IndexBox<3>& box) const {
  if (winding_) return open_fractions(mesh_, *winding_, lattice, box);
  return {closed_fractions(mesh_, lattice, box), {}};
}

}  // namespace fabseq
