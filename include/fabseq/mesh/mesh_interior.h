// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/open_fractions.h"

#include <optional>

namespace fabseq {

/// What lies inside a mesh: the points around which it winds, once or more, in either sense of rotation. Of
/// an open mesh, these are the points with a winding number of 1/2 or more in modulus.
class MeshInterior {
 public:
  /// Finds out whether the mesh is closed. Keeps a reference to it.
  explicit MeshInterior(const TriangleMesh& mesh);

  bool closed() const { return !winding_; }

  /// Shares of the elements of `box` that lie inside, from 4 x 4 x 4 samples of each element that the surface
  /// cuts. Each rank may ask for its own elements: nothing depends on how they are divided into boxes. A
  /// closed mesh answers clearly everywhere: nothing is asked then. Not collective.
  FillFractions fill_fractions(const ElementLattice& lattice, const IndexBox<3>& box) const;

 private:
  const TriangleMesh& mesh_;
  std::optional<WindingNumber> winding_;  ///< of an open mesh
};

}  // namespace fabseq
